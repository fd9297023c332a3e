//! The JSON Schema of a study file, generated from its types, for editors.

use std::sync::LazyLock;

use schemars::generate::SchemaSettings;
use serde_json::Value;

use super::defaults::insert_defaults;
use super::file::schema_rules::add_rules;
use super::file::schema_units::{add_units, remove_nulls};
use super::file::study_file::StudyFile;

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
