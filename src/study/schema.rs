//! The JSON Schema of a study file with its default values, generated from its types, for editors.
//!
//! A default is what the resolved study of a kind of model contains without any optional key, so
//! that the defaults stated here are those that the program uses.

use std::path::Path;
use std::sync::LazyLock;

use schemars::generate::SchemaSettings;
use serde_json::Value;

use super::file::schema_rules::add_rules;
use super::file::schema_units::{add_units, remove_nulls};
use super::file::study_file::StudyFile;
use crate::study::kinds::model_kinds;
use crate::study::plan::planned_study::Study;

/// The schema that the types of the study file declare, without defaults, units and rules between keys.
pub(in crate::study) static DECLARED: LazyLock<Value> = LazyLock::new(|| {
    let generator = SchemaSettings::draft2020_12().into_generator();
    let mut schema = generator.into_root_schema_for::<StudyFile>().to_value();
    remove_nulls(&mut schema);
    schema
});

/// Returns the JSON Schema (draft 2020-12) of a study file, with units in the descriptions and with defaults.
pub fn json_schema() -> Value {
    let mut schema = DECLARED.clone();
    insert_defaults(&mut schema);
    add_units(&mut schema);
    add_rules(&mut schema);
    schema
}

/// Returns the resolved study of a kind of model without any optional key.
pub(in crate::study) fn defaults_of(kind: &str) -> Value {
    let text = format!(
        "schema: 1\nname: defaults\nseed: 0\nmodel: {{kind: {kind}}}\n\
         initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}}}\n"
    );
    let study = Study::parse(Path::new("defaults.yaml"), text);
    study.map_or(Value::Null, |study| study.resolved_file())
}

/// Adds `default` to every optional key that has the same default in all models that have the key.
fn insert_defaults(schema: &mut Value) {
    let studies: Vec<Value> = model_kinds().iter().map(|kind| defaults_of(kind.name)).collect();
    insert(schema, "", &studies.iter().collect::<Vec<_>>());
}

/// Adds the defaults of a map: `values` holds the maps of the models that have it.
fn insert(schema: &mut Value, pointer: &str, values: &[&Value]) {
    let Some(map) = schema.pointer(pointer) else { return };
    let required: Vec<&str> = map
        .get("required")
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    let properties = map.get("properties").and_then(Value::as_object).into_iter().flatten();
    let names: Vec<(String, bool)> =
        properties.map(|(name, _)| (name.clone(), required.contains(&name.as_str()))).collect();
    for (name, is_required) in names {
        let inner: Vec<&Value> = values.iter().filter_map(|value| value.get(&name)).collect();
        let Some((first, others)) = inner.split_first() else { continue };
        let property = format!("{pointer}/properties/{name}");
        if first.is_object() {
            if let Some(below) = map_at(schema, &property) {
                insert(schema, &below, &inner);
            }
        } else if !is_required && !first.is_array() && others.iter().all(|other| other == first) {
            let fields = schema.pointer_mut(&property).and_then(Value::as_object_mut);
            if let Some(fields) = fields {
                fields.insert("default".to_owned(), (*first).clone());
            }
        }
    }
}

/// Returns the pointer to the map that a property is or refers to.
fn map_at(schema: &Value, pointer: &str) -> Option<String> {
    let node = schema.pointer(pointer)?;
    if node.get("properties").is_some() {
        return Some(pointer.to_owned());
    }
    let alternatives = node.get("anyOf").and_then(Value::as_array).into_iter().flatten();
    let mut nodes = std::iter::once(node).chain(alternatives);
    let target = nodes.find_map(|node| node.get("$ref")?.as_str()?.strip_prefix('#'))?;
    schema.pointer(target)?.get("properties").map(|_| target.to_owned())
}
