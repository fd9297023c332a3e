//! `stickslip schema`: prints the JSON Schema of study files.

use clap::Args;

use super::output::{CliError, End, print_json};
use crate::study::json_schema;

const EXAMPLES: &str = "\
Examples:
  stickslip schema > study.schema.json

With the YAML language server, put this line at the top of a study and the editor completes and \
checks it:
  # yaml-language-server: $schema=study.schema.json";

/// Print the JSON Schema of study files, for editors
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {}

/// Prints the schema.
pub fn schema(_: &Arguments) -> Result<End, CliError> {
    print_json(&format!("{:#}\n", json_schema()))?;
    Ok(End::Well)
}
