//! Parts of the JSON Schema of a study file that depend on the parameters and coordinates of the models.

use std::collections::HashSet;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use super::balls::Balls;
use super::distribution_file::DistributionFile;
use super::identify_file::PriorFile;
use super::parameters_file::{BALLS, is_before_balls, parameter_keys};
use super::schema_units::QUANTITY;
use super::system_file::SystemFile;
use super::table_folders::MAX_VALUES;
use super::values::Range;
use crate::model::{
    Ball, BallContact, FRICTION_LAWS, FrictionLaw, Kick, MAX_BALLS, Machine, Model, ModelKind,
    NormalForce, ProfilePart, Ramp, RampShape, SpeedProfile,
};
use crate::study::kinds::model_kinds;
use crate::study::plan::parameter::{MOST_MEMBERS, Parameter};
use crate::study::plan::units::QUANTITIES;
use crate::study::plan::variable::VariableFile;
use crate::study::sampling::initial_box::{axes_in_words, axis_names, general_axes};

/// Returns the schema of lists or ranges of values by parameter.
pub(in crate::study) fn swept(generator: &mut SchemaGenerator) -> Schema {
    let definitions = generator.definitions_mut();
    definitions.entry("NumberRange").or_insert_with(number_range);
    let models = all_models();
    let values = |parameter: &Parameter| {
        let list = json!({ "type": "array", "items": value(*parameter, &models), "minItems": 1 });
        match parameter.is_number() {
            true => json!({ "anyOf": [list, { "$ref": "#/$defs/NumberRange" }] }),
            false => list,
        }
    };
    let mut schema = per_parameter(values, &all_swept());
    schema.insert("minProperties".to_owned(), 1.into());
    schema
}

/// Returns the schema of one value by parameter.
pub(in crate::study) fn selector(_: &mut SchemaGenerator) -> Schema {
    let models = all_models();
    per_parameter(|parameter| value(*parameter, &models), &all_swept())
}

/// Returns the schema of one number by numeric parameter, for each name of a choice.
pub(in crate::study) fn choices(_: &mut SchemaGenerator) -> Schema {
    let models = all_models();
    let mut each = per_parameter(|parameter| value(*parameter, &models), &numeric());
    each.insert("minProperties".to_owned(), 1.into());
    json_schema!({ "type": "object", "additionalProperties": each, "minProperties": 1 })
}

/// Returns the schema of variables of a design by name: numeric parameters, `balls`, or other names.
pub(in crate::study) fn variables(generator: &mut SchemaGenerator) -> Schema {
    let variable = generator.subschema_for::<VariableFile>();
    let mut schema = per_parameter(|_| variable.clone().to_value(), &numeric());
    schema.insert("additionalProperties".to_owned(), variable.to_value());
    schema
}

/// Returns the schema of ranges of priors by numeric parameter.
pub(in crate::study) fn priors(generator: &mut SchemaGenerator) -> Schema {
    let prior = generator.subschema_for::<PriorFile>().to_value();
    let mut schema = per_parameter(|_| prior.clone(), &numeric());
    schema.insert("minProperties".to_owned(), 1.into());
    schema.insert("maxProperties".to_owned(), 8.into());
    schema
}

/// Returns the schema of units by quantity, or by parameter without its unit.
pub(in crate::study) fn units(_: &mut SchemaGenerator) -> Schema {
    let unit = |(name, si): &(&str, &str)| {
        let description = match *name {
            "vibration" => "Unit in which people read amplitudes; the default is µm.".to_owned(),
            "imbalance" => {
                "Unit in which people read each imbalance; the default is g mm.".to_owned()
            }
            _ => format!(
                "Unit in which people read each {name}; the default is the unit that the study writes, otherwise {si}."
            ),
        };
        ((*name).to_owned(), json!({ "type": "string", "description": description }))
    };
    let properties: Map<String, Value> = QUANTITIES.iter().map(unit).collect();
    json_schema!({
        "type": "object", "properties": properties, "additionalProperties": { "type": "string" }
    })
}

/// Returns the schema of a system: the name of a file, or the keys of one.
pub(in crate::study) fn system(generator: &mut SchemaGenerator) -> Schema {
    let keys = generator.subschema_for::<SystemFile>().to_value();
    json_schema!({ "anyOf": [{ "type": "string" }, keys] })
}

/// Returns the schema of a limit of an amplitude.
pub(in crate::study) fn length_limit(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "anyOf": [{ "type": "number", "minimum": 0 }, { "type": "string", "pattern": QUANTITY }] })
}

/// Returns the schema of a range of values.
fn number_range() -> Value {
    json!({
        "description": "Values from `from` to `to`: `count` of them, or one every `step`.",
        "type": "object",
        "properties": {
            "from": { "type": "number", "description": "First value." },
            "to": { "type": "number", "description": "Last value." },
            "count": {
                "type": "integer", "minimum": 2, "maximum": MAX_VALUES,
                "description": "Number of values, with both ends.",
            },
            "step": {
                "type": "number",
                "description": "Difference of two values; `to` is a value if a step arrives there.",
            },
            "spacing": {
                "enum": ["linear", "logarithmic"],
                "description": "Whether the differences or the ratios are equal; default linear.",
            },
        },
        "required": ["from", "to"],
        "oneOf": [
            { "required": ["count"] },
            { "required": ["step"], "properties": { "spacing": { "const": "linear" } } },
        ],
        "additionalProperties": false,
    })
}

/// Returns the schema of a parameter's value: a number with its bound, or a word.
fn value(parameter: Parameter, models: &[Model]) -> Value {
    if !parameter.is_number() {
        return json!({ "enum": NormalForce::ALL.map(|(name, _)| name) });
    }
    if parameter == Parameter::BALLS {
        return json!({ "type": "integer", "minimum": 1, "maximum": MAX_BALLS });
    }
    let model = models.iter().find(|model| Parameter::all(model).contains(&parameter));
    let allows = |number| model.is_none_or(|model| parameter.check(number, model).is_ok());
    match (allows(0.0), allows(-1.0)) {
        (_, true) => json!({ "type": "number" }),
        (true, false) => json!({ "type": "number", "minimum": 0 }),
        (false, false) => json!({ "type": "number", "exclusiveMinimum": 0 }),
    }
}

/// Returns the schema of the parameters of a model of any kind.
pub(in crate::study) fn parameters_schema(generator: &mut SchemaGenerator) -> Schema {
    let models = all_models();
    let balls = generator.subschema_for::<Balls>().to_value();
    let words = format!(
        "Number of balls, 1 to {MAX_BALLS}, or a list with one entry per ball; default {}.",
        Machine::default().balls.len()
    );
    let mut properties = Map::new();
    for &name in parameter_keys().iter().filter(|name| **name != BALLS) {
        if !is_before_balls(name) {
            properties.entry(BALLS).or_insert_with(|| described(balls.clone(), words.clone()));
        }
        let find = |kind: &&'static ModelKind| Parameter::find(name, &kind.default_model());
        let found = model_kinds().iter().find_map(find);
        if let Some(schema) = found.map(|found| value(found, &models)).or_else(|| count(name)) {
            let words = parameter_in_words(name, &schema);
            properties.insert(name.to_owned(), described(schema, words));
        }
    }
    json_schema!({
        "description": "Parameters in SI units; each kind of model has its own.",
        "type": "object",
        "properties": properties,
    })
}

/// Returns the schema of a whole number; `None` if no kind of model has this one.
fn count(name: &str) -> Option<Value> {
    let mut all = model_kinds().iter().flat_map(|kind| kind.parameters);
    let [least, most] = all.find(|own| own.name == name)?.counts()?;
    Some(json!({ "type": "integer", "minimum": least, "maximum": most }))
}

/// Returns the description of a parameter: its meanings with their defaults, unit and lowest value.
fn parameter_in_words(name: &str, schema: &Value) -> String {
    let mut meanings: Vec<(String, String)> = Vec::new();
    let mut unit = "";
    for kind in model_kinds() {
        let model = kind.default_model();
        let Some(own) = kind.parameters.iter().find(|own| own.name == name) else { continue };
        let each = if own.is_of_each_ball() { " of each ball without its own value" } else { "" };
        let number = || Some(own.numbers(&mut model.clone(), None).first()?.to_string());
        let default = Parameter::find(name, &model)
            .map(|parameter| parameter.get(&model, &Ball::default()).to_string());
        let Some(default) = default.or_else(number) else { continue };
        let default = if own.determines().is_some() { "none".to_owned() } else { default };
        let meaning = (format!("{}{each}", own.meaning), default);
        if !meanings.contains(&meaning) {
            meanings.push(meaning);
        }
        unit = own.unit;
    }
    let (meaning, default) = match &meanings[..] {
        [(meaning, default)] => (meaning.clone(), format!("; default {default}")),
        all => {
            let each =
                all.iter().map(|(meaning, default)| format!("{meaning} (default {default})"));
            (each.collect::<Vec<_>>().join(", or "), String::new())
        }
    };
    let unit = if unit == "1" { "dimensionless" } else { unit };
    let lowest = match (schema.get("minimum"), schema.get("exclusiveMinimum")) {
        (Some(_), _) if schema["type"] == "integer" => &format!("; 1 to {}", schema["maximum"]),
        (Some(_), _) => "; at least 0",
        (None, Some(_)) => "; above 0",
        (None, None) => "",
    };
    format!("{}, {unit}{lowest}{default}.", capital(&meaning))
}

/// Returns the text with a capital letter.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Returns the schema of distributions by numeric parameter.
pub(in crate::study) fn uncertain(generator: &mut SchemaGenerator) -> Schema {
    let distribution = generator.subschema_for::<DistributionFile>().to_value();
    per_parameter(|_| distribution.clone(), &numeric())
}

/// Returns the coordinates of the box of start states of this kind of model, for any number of balls.
pub(in crate::study) fn axes_of(kind: &'static ModelKind) -> Vec<String> {
    let models = models_of(kind);
    let general = models.first().map(general_axes).unwrap_or_default().into_iter();
    let own = models.iter().take(1).flat_map(axis_names);
    general.map(str::to_owned).chain(own).collect()
}

/// Returns the schema of ranges by start coordinate.
pub(in crate::study) fn start_box(generator: &mut SchemaGenerator) -> Schema {
    let range = <Range as JsonSchema>::json_schema(generator);
    let mut models = all_models();
    // The default ranges are those at constant speed; the description of `box` says what a profile changes.
    for machine in models.iter_mut().filter_map(Model::ball_balancer_mut) {
        machine.speed_profile = None;
    }
    let axes = models.iter().flat_map(axes_in_words);
    let properties: Map<String, Value> =
        axes.map(|(name, meaning)| (name, described(range.clone().to_value(), meaning))).collect();
    // A system file has names of its own; the rules of each kind of model exclude other names.
    json_schema!({ "type": "object", "properties": properties })
}

/// A kick of a model that has all parameters.
const KICK: Kick = Kick { at_s: 1.0, speed_m_s: 0.0, direction_rad: 0.0 };

/// Returns a profile with as many ramps and plateaus as possible.
fn longest_profile(speed_rad_s: f64) -> SpeedProfile {
    let pair = |number: usize| {
        let to_rad_s = (number < MOST_MEMBERS).then_some(speed_rad_s);
        let ramp = Ramp { shape: RampShape::Linear, to_rad_s, over_s: 1.0 };
        [ProfilePart::Ramp(ramp), ProfilePart::Hold(Some(1.0))]
    };
    let parts = (1..=MOST_MEMBERS).flat_map(pair).collect();
    SpeedProfile { start_speed_rad_s: speed_rad_s, parts }
}

/// Returns one model of every kind and every friction law, with the largest number of balls or other bodies.
fn all_models() -> Vec<Model> {
    model_kinds().iter().copied().flat_map(models_of).collect()
}

/// Returns one model of a kind with every friction law that a study can give it, with the largest number of balls or other
/// bodies.
fn models_of(kind: &'static ModelKind) -> Vec<Model> {
    let model = || {
        let mut model = kind.default_model();
        if let Some(machine) = model.ball_balancer_mut() {
            machine.balls = vec![Ball::default(); MAX_BALLS];
            machine.contact = Some(BallContact::default());
            machine.kicks = vec![KICK; MOST_MEMBERS];
        }
        let speed = model.speed_parameter();
        let last = speed.and_then(|speed| speed.numbers(&mut model, None).pop().copied());
        *model.speed_profile_mut() = last.map(longest_profile);
        for count in kind.parameters {
            if let Some(most) = count.largest_count() {
                count.numbers(&mut model, None).into_iter().for_each(|one| *one = most as f64);
            }
        }
        model
    };
    if !kind.has_law_of_study() {
        return vec![model()];
    }
    let laws = FRICTION_LAWS.map(|law| {
        let examples: Vec<f64> = law.parameters().iter().map(|one| one.examples[1]).collect();
        FrictionLaw::new(law, &examples)
    });
    let with = |model: &Model, law: FrictionLaw| {
        let mut model = model.clone();
        *model.friction_mut() = law;
        model
    };
    laws.map(|law| with(&model(), law)).into()
}

/// Returns the names of the parameters of this kind of model with any friction law, and those of its whole numbers.
pub(in crate::study) fn parameters_of(kind: &'static ModelKind) -> Vec<String> {
    distinct(&models_of(kind)).into_iter().map(Parameter::name).collect()
}

/// Returns the names of the parameters of all kinds, except for a force whose name without its unit is also the name of a
/// choice.
pub(in crate::study) fn parameters_of_any() -> Vec<String> {
    let names = all_parameters().into_iter().map(Parameter::name);
    names.filter(|name| name != "normal_force_n").collect()
}

/// Returns the names of the numeric parameters of this kind of model with any friction law.
pub(in crate::study) fn numeric_parameters_of(kind: &'static ModelKind) -> Vec<String> {
    let numeric = distinct(&models_of(kind)).into_iter().filter(|parameter| parameter.is_number());
    numeric.map(Parameter::name).collect()
}

/// Returns every numeric parameter of any model, without repeated names.
fn numeric() -> Vec<Parameter> {
    all_parameters().into_iter().filter(|parameter| parameter.is_number()).collect()
}

/// Returns everything that a sweep may set.
fn all_swept() -> Vec<Parameter> {
    all_parameters().into_iter().chain([Parameter::BALLS]).collect()
}

/// Returns every parameter of any model, without repeated names.
fn all_parameters() -> Vec<Parameter> {
    distinct(&all_models())
}

fn distinct(models: &[Model]) -> Vec<Parameter> {
    let mut names = HashSet::new();
    let all = models.iter().flat_map(Parameter::all);
    all.filter(|parameter| names.insert(parameter.name())).collect()
}

/// Returns a schema with a description.
fn described(mut schema: Value, description: String) -> Value {
    if let Value::Object(fields) = &mut schema {
        fields.insert("description".to_owned(), Value::String(description));
    }
    schema
}

fn per_parameter(value: impl Fn(&Parameter) -> Value, parameters: &[Parameter]) -> Schema {
    let properties: Map<String, Value> = parameters
        .iter()
        .map(|parameter| {
            let unit = match parameter.unit() {
                "" => String::new(),
                "1" => ", dimensionless".to_owned(),
                unit => format!(", {unit}"),
            };
            let meaning = format!("{}{unit}.", parameter.meaning());
            (parameter.name(), described(value(parameter), meaning))
        })
        .collect();
    json_schema!({ "type": "object", "properties": properties })
}
