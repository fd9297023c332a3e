//! Parts of the JSON Schema of a study file that depend on the parameters and coordinates of the models.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use super::distribution_file::DistributionFile;
use super::response_file::VariableFile;
use super::table_folders::MAX_VALUES;
use super::values::Range;
use crate::model::{Ball, Block, FrictionLaw, MAX_BALLS, Machine, Model};
use crate::study::plan::parameter::{NORMAL_FORCES, Parameter};
use crate::study::sampling::initial_box::{GENERAL_AXES, axes_in_words, axis_names};

/// The labels of runs that can be continued.
pub(crate) const EXTENDED_LABELS: [&str; 2] = ["undecided", "irregular"];

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
    let mut schema = per_parameter(values, &all_parameters());
    schema.insert("minProperties".to_owned(), 1.into());
    schema
}

/// Returns the schema of one value by parameter.
pub(in crate::study) fn selector(_: &mut SchemaGenerator) -> Schema {
    let models = all_models();
    per_parameter(|parameter| value(*parameter, &models), &all_parameters())
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
        return json!({ "enum": NORMAL_FORCES.map(|(name, _)| name) });
    }
    let model = models.iter().find(|model| Parameter::all(model).contains(&parameter));
    let allows = |number| model.is_none_or(|model| parameter.check(number, model).is_ok());
    match (allows(0.0), allows(-1.0)) {
        (_, true) => json!({ "type": "number" }),
        (true, false) => json!({ "type": "number", "minimum": 0 }),
        (false, false) => json!({ "type": "number", "exclusiveMinimum": 0 }),
    }
}

/// Returns the schema of distributions by numeric parameter.
pub(in crate::study) fn uncertain(generator: &mut SchemaGenerator) -> Schema {
    let distribution = generator.subschema_for::<DistributionFile>().to_value();
    per_parameter(|_| distribution.clone(), &numeric())
}

/// Returns the coordinates of the box of start states of this kind of model, for any number of balls.
pub(in crate::study) fn axes_of(kind: &str) -> Vec<String> {
    let mut models = all_models();
    models.retain(|model| model.kind() == kind);
    let general = GENERAL_AXES.iter().filter(|_| models.iter().any(|model| model.balls() > 0));
    let own = models.iter().take(1).flat_map(axis_names);
    general.map(|&name| name.to_owned()).chain(own).collect()
}

/// Returns the schema of ranges by start coordinate.
pub(in crate::study) fn start_box(generator: &mut SchemaGenerator) -> Schema {
    let range = <Range as JsonSchema>::json_schema(generator);
    let models = all_models();
    let axes = models.iter().flat_map(axes_in_words);
    let properties: Map<String, Value> =
        axes.map(|(name, meaning)| (name, described(range.clone().to_value(), meaning))).collect();
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// Returns the schema of the labels of runs that can be continued.
pub(in crate::study) fn extended_labels(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "array", "items": { "enum": EXTENDED_LABELS }, "minItems": 1, "uniqueItems": true
    })
}

/// Returns one model of every kind and every friction law, with the largest number of balls.
fn all_models() -> Vec<Model> {
    let laws = [
        FrictionLaw::Coulomb,
        FrictionLaw::Stribeck { static_friction_coefficient: 1.0, stribeck_speed: 0.0 },
        FrictionLaw::Smooth { smoothing_speed: 1.0 },
        FrictionLaw::Viscous { viscous_coefficient_n_s_m: 0.0 },
    ];
    let kinds = [
        Model::BallBalancer(Machine {
            balls: vec![Ball::default(); MAX_BALLS],
            ..Machine::default()
        }),
        Model::Block(Block::on_spring()),
        Model::Block(Block::on_belt()),
    ];
    let with = |model: &Model, law: FrictionLaw| {
        let mut model = model.clone();
        *model.friction_mut() = law;
        model
    };
    kinds.iter().flat_map(|model| laws.map(|law| with(model, law))).collect()
}

/// Returns the names of the parameters of this kind of model with any friction law. For an unknown kind, these are the
/// parameters of all kinds, except for a force whose name without its unit is also the name of a choice.
pub(in crate::study) fn parameters_of(kind: &str) -> Vec<String> {
    let mut models = all_models();
    models.retain(|model| model.kind() == kind);
    if models.is_empty() {
        let names = all_parameters().into_iter().map(Parameter::name);
        return names.filter(|name| name != "normal_force_n").collect();
    }
    distinct(&models).into_iter().map(Parameter::name).collect()
}

/// Returns the names of the numeric parameters of this kind of model with any friction law.
pub(in crate::study) fn numeric_parameters_of(kind: &str) -> Vec<String> {
    let mut models = all_models();
    models.retain(|model| model.kind() == kind);
    let numeric = distinct(&models).into_iter().filter(|parameter| parameter.is_number());
    numeric.map(Parameter::name).collect()
}

/// Returns every numeric parameter of any model, without repeated names.
fn numeric() -> Vec<Parameter> {
    all_parameters().into_iter().filter(|parameter| parameter.is_number()).collect()
}

/// Returns every parameter of any model, without repeated names.
fn all_parameters() -> Vec<Parameter> {
    distinct(&all_models())
}

fn distinct(models: &[Model]) -> Vec<Parameter> {
    let mut parameters: Vec<Parameter> = Vec::new();
    for parameter in models.iter().flat_map(Parameter::all) {
        if !parameters.iter().any(|known| known.name() == parameter.name()) {
            parameters.push(parameter);
        }
    }
    parameters
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
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}
