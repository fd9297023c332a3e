//! The JSON Schema of a study file, generated from its types, for editors that complete and check.

use schemars::{JsonSchema, Schema, SchemaGenerator, generate::SchemaSettings, json_schema};
use serde_json::{Map, Value};

use super::file::{DistributionFile, StudyFile};
use super::file_values::{Entry, Listed, Range};
use super::parameter::Parameter;
use super::start_box::axis_names;
use crate::model::MAX_BALLS;

/// The JSON Schema (draft 2020-12) of a study file, with units in the descriptions.
pub fn json_schema() -> Value {
    SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<StudyFile>().to_value()
}

/// Lists of values per parameter.
pub(super) fn swept(generator: &mut SchemaGenerator) -> Schema {
    per_parameter(generator.subschema_for::<Listed>(), &Parameter::all(MAX_BALLS))
}

/// One value per parameter.
pub(super) fn selector(generator: &mut SchemaGenerator) -> Schema {
    per_parameter(generator.subschema_for::<Entry>(), &Parameter::all(MAX_BALLS))
}

/// A distribution per numeric parameter.
pub(super) fn uncertain(generator: &mut SchemaGenerator) -> Schema {
    let mut parameters = Parameter::all(MAX_BALLS);
    parameters.retain(|parameter| parameter.is_number());
    per_parameter(generator.subschema_for::<DistributionFile>(), &parameters)
}

/// A range per start coordinate.
pub(super) fn start_box(generator: &mut SchemaGenerator) -> Schema {
    let range = <Range as JsonSchema>::json_schema(generator);
    let names = ["beta".to_owned(), "beta_dot".to_owned()].into_iter().chain(axis_names(MAX_BALLS));
    let properties: Map<String, Value> =
        names.map(|name| (name, range.clone().to_value())).collect();
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}

fn per_parameter(value: Schema, parameters: &[Parameter]) -> Schema {
    let properties: Map<String, Value> = parameters
        .iter()
        .map(|parameter| {
            let mut property = value.clone().to_value();
            if let Value::Object(fields) = &mut property {
                let meaning = format!("{}, {}.", parameter.meaning(), parameter.unit());
                fields.insert("description".to_owned(), Value::String(meaning));
            }
            (parameter.name(), property)
        })
        .collect();
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}
