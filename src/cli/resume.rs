//! `stickslip resume`: goes on with a study that was interrupted.

use std::path::PathBuf;

use clap::Args;

use super::arguments::FarmArguments;
use super::exit::{CliError, End};
use super::results_study::begun_study;
use super::run::carry_out;
use crate::farm::{Place, Shard};

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
    farm: FarmArguments,
}

/// Goes on with a study.
///
/// # Errors
/// Where the directory holds no study or cannot be used, or a table cannot be written.
pub fn resume(arguments: &ResumeArguments) -> Result<End, CliError> {
    let directory = &arguments.directory;
    let (study, manifest) = begun_study(directory)?;
    let shard: Shard = manifest.shard.parse().map_err(|error| {
        CliError::Usage(format!("{}: `shard` in manifest.json: {error}", directory.display()))
    })?;
    let options = arguments.farm.options(shard);
    let place = Place {
        directory,
        shard,
        retry_failed: options.retry_failed,
        recompute: false,
        shards: &[],
        quiet: arguments.farm.quiet,
    };
    carry_out(&study, &place, options, &arguments.farm)
}
