//! The JSON Schema of the parameters of a model.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use super::balls::Balls;
use super::friction_file::capital;
use super::kind_parameters::all_models;
use super::parameters_file::{BALLS, ParametersFile, is_before_balls, parameter_keys};
use super::schema_parts::{described, value};
use crate::model::{Ball, MAX_BALLS, Machine, ModelKind};
use crate::study::kinds::model_kinds;
use crate::study::plan::parameter::Parameter;

impl JsonSchema for ParametersFile {
    fn schema_name() -> Cow<'static, str> {
        "ParametersFile".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        parameters_schema(generator)
    }
}

/// Returns the schema of the parameters of a model of any kind.
fn parameters_schema(generator: &mut SchemaGenerator) -> Schema {
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
