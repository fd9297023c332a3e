//! `stickslip resume`: goes on with a study that was interrupted.

use std::path::{Path, PathBuf};

use clap::Args;

use super::arguments::EngineArguments;
use super::exit::{CliError, End};
use super::results_study::begun_study;
use super::run::carry_out;
use crate::engine::{OutputDir, Shard};
use crate::table::{Manifest, ResultsError};

const EXAMPLES: &str = "\
Examples:
  stickslip resume results/night
  stickslip resume results/night --threads 8 --max-seconds 3600

The directory holds the study and the finished runs: no other file is needed. Runs that are finished are
not computed again, and the tables end in the same bytes as if nothing had come in between. Chunks of
finished runs that are damaged are named, put aside, and their runs computed again.";

/// Go on with an interrupted study where it was
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ResumeArguments {
    /// Directory with the interrupted results
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    #[command(flatten)]
    engine: EngineArguments,
}

/// Goes on with a study.
///
/// # Errors
/// Where the directory holds no study or cannot be used, or a table cannot be written.
pub fn resume(arguments: &ResumeArguments) -> Result<End, CliError> {
    let directory = &arguments.directory;
    let (study, manifest) = begun_study(directory)?;
    refuse_merge(directory, &manifest)?;
    let shard: Shard = manifest.shard.parse().map_err(|error| {
        CliError::Usage(format!("{}: `shard` in manifest.json: {error}", directory.display()))
    })?;
    let options = arguments.engine.options(shard);
    let output_dir = OutputDir {
        directory,
        shard,
        retry_failed: options.retry_failed,
        recompute: false,
        shards: &[],
        quiet: arguments.engine.quiet,
    };
    carry_out(&study, &output_dir, options, &arguments.engine)
}

/// The most directories of a merge that are named.
const MOST_NAMED: usize = 20;

/// Refuses a merge that was interrupted: the runs that it has not come to are finished, elsewhere.
fn refuse_merge(directory: &Path, manifest: &Manifest) -> Result<(), ResultsError> {
    let parts = &manifest.merging;
    if parts.is_empty() {
        return Ok(());
    }
    let out = directory.display();
    let named: Vec<String> =
        parts.iter().take(MOST_NAMED).map(|part| part.escape_debug().to_string()).collect();
    let more = if parts.len() > MOST_NAMED { " ..." } else { "" };
    Err(ResultsError::Occupied {
        path: directory.to_owned(),
        reason: "these results were being merged, not computed".to_owned(),
        found: format!("an unfinished merge of {} directories", parts.len()),
        allowed: format!(
            "`stickslip merge {}{more} --out {out}`, which goes on; or `stickslip run {out}/study.yaml \
             --out {out}`, which computes the runs that are missing",
            named.join(" ")
        ),
    })
}
