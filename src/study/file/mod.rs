//! The study file as it is written: YAML with places, its types, the tables it names, and its text with all defaults.

pub mod balls;
pub mod contact_file;
pub(in crate::study) mod decode;
pub mod distribution_file;
pub(in crate::study) mod friction_file;
pub(in crate::study) mod key_path;
pub(in crate::study) mod name;
pub mod optimize_file;
pub(in crate::study) mod parameters_file;
pub mod protocol_file;
pub(in crate::study) mod quantity;
pub(in crate::study) mod ranges;
pub(in crate::study) mod read_file;
pub(in crate::study) mod resolved_yaml;
pub mod response_file;
pub(in crate::study) mod schema_parts;
pub(in crate::study) mod schema_rules;
pub(in crate::study) mod schema_units;
pub(in crate::study) mod source_path;
pub mod stages_file;
pub mod study_file;
pub(in crate::study) mod table_folders;
pub(in crate::study) mod table_input;
pub(in crate::study) mod unit_keys;
pub mod values;
pub(in crate::study) mod yaml_fault;
pub(in crate::study) mod yaml_tree;
