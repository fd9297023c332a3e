//! The JSON Schema of a study file, generated from its types, for editors.

use serde_json::Value;

use super::defaults::insert_defaults;
use super::file::schema_place::declared_schema;
use super::file::schema_rules::add_rules;
use super::file::schema_units::add_units;

/// Returns the JSON Schema (draft 2020-12) of a study file, with units in the descriptions and with defaults.
pub fn json_schema() -> Value {
    let mut schema = declared_schema();
    insert_defaults(&mut schema);
    add_units(&mut schema);
    add_rules(&mut schema);
    schema
}
