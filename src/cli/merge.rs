//! `stickslip merge`: merges the results of all shards of a study into the tables of the whole study.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::arguments::{EngineArguments, results_directory};
use super::output::{CliError, End};
use super::run::carry_out;
use crate::engine::{OutputDir, Shard, results_study};
use crate::sanitize::shell_word;
use crate::study::Study;

const EXAMPLES: &str = "\
Examples:
  stickslip run study.yaml --shard 1/2 --out results/part-1
  stickslip run study.yaml --shard 2/2 --out results/part-2
  stickslip merge results/part-1 results/part-2 --out results/whole

Reads the finished runs of all shards and writes the tables of the whole study, byte for byte those of a single \
run. Each shard must be given exactly once and be finished, and all shards must be of the same study and program \
version. Only runs of a damaged chunk are computed again; a warning names the chunk. Afterwards `stickslip \
summary` and `stickslip report` show the result.";

/// The largest number of runs per batch; larger batches take more memory without faster reading.
const MOST_AT_A_TIME: usize = 1 << 17;
/// Runs per batch and shard: the size of a chunk.
const AT_A_TIME: usize = 1024;

/// Merge the results of all shards of a study
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Directories of all shards, in any order
    #[arg(value_name = "PART", required = true)]
    parts: Vec<PathBuf>,

    /// Directory for the merged results [default: results/<name of the study>]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    engine: EngineArguments,
}

/// Merges the shards.
///
/// # Errors
/// Returns an error if a shard is missing, given twice, unfinished or of another study, or if a directory cannot
/// be used.
pub fn merge(arguments: &Arguments) -> Result<End, CliError> {
    let study = whole(&arguments.parts)?;
    let directory = results_directory(arguments.out.as_ref(), &study, "");
    let mut options = arguments.engine.options(Shard::WHOLE);
    options.chunk = AT_A_TIME.saturating_mul(arguments.parts.len()).min(MOST_AT_A_TIME);
    let output_dir = OutputDir {
        shards: &arguments.parts,
        ..OutputDir::new(&directory, &options, arguments.engine.quiet)
    };
    carry_out(&study, &output_dir, options, &arguments.engine)
}

/// Returns the study of the shards if each of them is given exactly once and is finished.
fn whole(parts: &[PathBuf]) -> Result<Study, CliError> {
    let refuse = |part: &Path, reason: String, allowed: &str| {
        Err(CliError::Usage(format!("{}: {reason}\n  allowed: {allowed}", part.display())))
    };
    let text = |part: &Path| {
        fs::read_to_string(part.join("study.yaml"))
            .map_err(|cause| CliError::Usage(format!("{}: study.yaml: {cause}", part.display())))
    };
    let mut first: Option<(Study, Shard, String, &Path)> = None;
    let mut places: Vec<(u64, &Path)> = Vec::new();
    for part in parts {
        let (study, manifest) = results_study(part)?;
        let shard: Shard = match manifest.shard.parse() {
            Ok(shard) => shard,
            Err(error) => return refuse(part, format!("`shard`: {error}"), "a shard's results"),
        };
        let text = text(part)?;
        if let Some((other, whole, other_text, place)) = &first {
            let place = place.display();
            if study.hash() != other.hash() || text != *other_text {
                let differs = crate::study::changed_keys(other, &study).join("\n    ");
                let reason =
                    format!("a different study than in {place}; it differs in\n    {differs}");
                return refuse(part, reason, "shards of one study");
            }
            if shard.parts() != whole.parts() {
                let reason = format!("shard {shard}, but {place} is shard {whole}");
                return refuse(part, reason, "shards of the same division");
            }
        }
        if let Some((_, twice)) = places.iter().find(|(number, _)| *number == shard.part()) {
            let reason = format!("shard {shard} is also in {}", twice.display());
            return refuse(part, reason, "each shard once");
        }
        if !manifest.complete {
            let reason = format!(
                "shard {shard} is not finished: {} of {} runs",
                manifest.runs_finished, manifest.runs_planned
            );
            let allowed = format!("finished shards; `stickslip resume {}`", shell_word(part));
            return refuse(part, reason, &allowed);
        }
        places.push((shard.part(), part));
        first.get_or_insert((study, shard, text, part));
    }
    let Some((study, shard, ..)) = first else {
        return Err(CliError::Usage("no shard given".to_owned()));
    };
    let missing: Vec<String> = (1..=shard.parts())
        .filter(|number| !places.iter().any(|(part, _)| part == number))
        .take(20)
        .map(|number| format!("{number}/{}", shard.parts()))
        .collect();
    if !missing.is_empty() {
        let what = format!("shards are missing: {} of {} given", places.len(), shard.parts());
        let found = format!("no directory of {}", missing.join(", "));
        return Err(CliError::refusal(what, found, "the directories of all shards"));
    }
    Ok(study)
}
