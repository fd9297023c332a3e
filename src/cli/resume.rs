//! `stickslip resume`: continues an interrupted study.

use std::path::{Path, PathBuf};

use clap::Args;

use super::arguments::EngineArguments;
use super::output::{CliError, End};
use super::run::carry_out;
use crate::engine::{OutputDir, Shard, begun_study};
use crate::table::{Manifest, ResultsError};

const EXAMPLES: &str = "\
Examples:
  stickslip resume results/night
  stickslip resume results/night --threads 8 --max-seconds 3600

Computes the missing runs of the study in DIR and writes its tables there; no other file is needed. Finished \
runs are not computed again, and the tables are byte for byte those of an uninterrupted run. Damaged chunks of \
finished runs are reported and set aside, and their runs are computed again. Afterwards `stickslip summary` and \
`stickslip report` show the result.";

/// Continue an interrupted study
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Directory with the interrupted results
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    #[command(flatten)]
    engine: EngineArguments,
}

/// Continues a study.
pub fn resume(arguments: &Arguments) -> Result<End, CliError> {
    let directory = &arguments.directory;
    let (study, manifest) = begun_study(directory)?;
    refuse_merge(directory, &manifest)?;
    let shard: Shard = manifest.shard.parse().map_err(|error| {
        CliError::Usage(format!("{}: `shard` in manifest.json: {error}", directory.display()))
    })?;
    let options = arguments.engine.options(shard);
    let output_dir = OutputDir::new(directory, &options, arguments.engine.quiet);
    carry_out(&study, &output_dir, options, &arguments.engine)
}

/// The number of directories of a merge that an error message names.
const MOST_NAMED: usize = 20;

/// Returns an error for an interrupted merge, whose missing runs lie in other directories.
fn refuse_merge(directory: &Path, manifest: &Manifest) -> Result<(), ResultsError> {
    let parts = &manifest.merging;
    if parts.is_empty() {
        return Ok(());
    }
    let out = directory.display();
    let named: Vec<String> =
        parts.iter().take(MOST_NAMED).map(|part| part.escape_debug().to_string()).collect();
    let more = if parts.len() > MOST_NAMED { " ..." } else { "" };
    let found = format!("a merge of {} directories", parts.len());
    let allowed = format!(
        "`stickslip merge {}{more} --out {out}`, which continues it; or `stickslip run {out}/study.yaml \
         --out {out}`, which computes the missing runs",
        named.join(" ")
    );
    Err(ResultsError::occupied(
        directory,
        "this directory holds an unfinished merge",
        found,
        allowed,
    ))
}
