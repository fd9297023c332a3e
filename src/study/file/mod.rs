//! The study file as it is written: YAML with places, its types, the tables it names, and its text with all defaults.
//!
//! Read first `yaml_tree` and `source` (the text and its places), then `unit_keys` and `decode` (how a type is read from
//! them), and then `study_file` with the files of its parts. `table_folders` and `table_input` read tables, `resolved_yaml`
//! writes a study with all defaults, and the files `schema_…` make the JSON Schema.
//! The other files are helpers of these; read them where they are imported.

pub(in crate::study) mod decode;
pub(in crate::study) mod friction_file;
pub(in crate::study) mod key_path;
pub(in crate::study) mod key_units;
pub(in crate::study) mod kind_parameters;
pub mod model_parts;
pub(in crate::study) mod parameters_file;
pub(in crate::study) mod quantity;
pub(in crate::study) mod ranges;
pub(in crate::study) mod resolved_yaml;
pub(in crate::study) mod schema_parts;
pub(in crate::study) mod schema_place;
pub(in crate::study) mod schema_rules;
pub(in crate::study) mod schema_units;
pub mod searches_file;
pub(in crate::study) mod source;
pub mod study_file;
pub(in crate::study) mod system_file;
pub(in crate::study) mod table_folders;
pub(in crate::study) mod table_input;
pub mod uncertain_file;
pub(in crate::study) mod unit_keys;
pub mod values;
pub(in crate::study) mod yaml_fault;
pub(in crate::study) mod yaml_tree;
