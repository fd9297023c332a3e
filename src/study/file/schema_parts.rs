//! Parts of the JSON Schema of a study file that depend on the parameters and coordinates of the models.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use super::friction_file::capital;
use super::kind_parameters::{all_models, all_swept, numeric};
use super::model_parts::Balls;
use super::parameters_file::{BALLS, ParametersFile, is_before_balls, parameter_keys};
use super::schema_units::QUANTITY;
use super::system_file::SystemFile;
use super::table_folders::MAX_VALUES;
use super::values::Range;
use crate::model::{Ball, MAX_BALLS, Machine, Model, ModelKind, NormalForce};
use crate::study::kinds::model_kinds;
use crate::study::plan::parameter::Parameter;
use crate::study::plan::units::QUANTITIES;
use crate::study::sampling::initial_box::axes_in_words;

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

/// Returns the schema of maps with values of a type by numeric parameter.
pub(in crate::study) fn by_parameter<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    let value = generator.subschema_for::<T>();
    per_parameter(|_| value.clone().to_value(), &numeric())
}

/// Returns the schema of maps with values of a type by numeric parameter, `balls` or another name.
pub(in crate::study) fn by_name<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    let mut schema = by_parameter::<T>(generator);
    let other = generator.subschema_for::<T>();
    schema.insert("additionalProperties".to_owned(), other.to_value());
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
pub(super) fn value(parameter: Parameter, models: &[Model]) -> Value {
    if !parameter.is_number() {
        let names: Vec<_> = NormalForce::ALL.iter().map(|force| force.name()).collect();
        return json!({ "enum": names });
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

/// Returns a schema with a description.
pub(super) fn described(mut schema: Value, description: String) -> Value {
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

impl JsonSchema for ParametersFile {
    fn schema_name() -> Cow<'static, str> {
        "ParametersFile".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
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
}

/// Returns the schema of a whole number; `None` if no kind of model has this one.
fn count(name: &str) -> Option<Value> {
    let mut all = model_kinds().iter().flat_map(|kind| kind.parameters);
    let [least, most] = all.find(|parameter| parameter.name == name)?.counts()?;
    Some(json!({ "type": "integer", "minimum": least, "maximum": most }))
}

/// Returns the description of a parameter: its meanings with their defaults, unit and lowest value.
fn parameter_in_words(name: &str, schema: &Value) -> String {
    let mut meanings: Vec<(String, String)> = Vec::new();
    let mut unit = "";
    for kind in model_kinds() {
        let model = kind.default_model();
        let Some(entry) = kind.parameters.iter().find(|entry| entry.name == name) else { continue };
        let each = if entry.is_of_each_ball() { " of each ball without its own value" } else { "" };
        let number = || Some(entry.numbers(&mut model.clone(), None).first()?.to_string());
        let default = Parameter::find(name, &model)
            .map(|parameter| parameter.get(&model, &Ball::default()).to_string());
        let Some(default) = default.or_else(number) else { continue };
        let default = if entry.determines().is_some() { "none".to_owned() } else { default };
        let meaning = (format!("{}{each}", entry.meaning), default);
        if !meanings.contains(&meaning) {
            meanings.push(meaning);
        }
        unit = entry.unit;
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
        (Some(least), _) if schema["type"] == "integer" => {
            &format!("; {least} to {}", schema["maximum"])
        }
        (Some(_), _) => "; at least 0",
        (None, Some(_)) => "; above 0",
        (None, None) => "",
    };
    format!("{}, {unit}{lowest}{default}.", capital(&meaning))
}
