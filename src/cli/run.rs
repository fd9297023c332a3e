//! `stickslip run`: computes a study and writes its tables.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::arguments::{EngineArguments, ShardArgument, StudyArgument};
use super::exit::{CliError, End};
use super::output::{print, print_json};
use super::points_table::{MOST_LINES, PointsTable};
use super::run_on_engine::run_on_engine;
use crate::classification::Label;
use crate::engine::{EngineOptions, OutputDir, Ready, say};
use crate::study::Study;
use crate::table::{Circumstances, Manifest, Table};

const EXAMPLES: &str = "\
Examples:
  stickslip run studies/preferred-equilibria.yaml
  stickslip run study.yaml --out results/night --threads 8
  stickslip run study.yaml --shard 2/4 --out results/part-2     (see merge)

The directory holds runs.parquet (a row per run), points.parquet (a row per point of the sweep),
time_to_rest.parquet (the probability of being at rest over time, per point), equilibria.parquet (where runs
came to rest), equilibrium_histogram.parquet (how often in which part of the ring), cycles.parquet (the limit cycles
by class, per point), study.yaml (with all defaults filled in), manifest.json, and in chunks/ the
finished runs, which are written as they come. A table of more than 524,288 rows is a directory of that
name, with files of as many rows each: part-00000.parquet and so on.

Whatever ends it (Ctrl-C, a kill, a power cut, a full disk), the same command goes on where it was and
ends in the same bytes. Ctrl-C waits a second for the runs in progress, gives up those that take longer,
keeps what is finished and exits with 130; a second Ctrl-C stops at once. A study that has been edited may be run into the directory of its
results: only runs that are new are computed; the tables before go to earlier/.";

/// Run a study: thousands of simulations, their endings as Parquet tables
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct RunArguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Directory for the results; nothing in it is ever deleted [default: results/<name of the study>]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    shard: ShardArgument,

    /// Run into a directory with the results of another study of which no run can be used again
    ///
    /// What is there is moved to earlier/. Without this the difference is shown and nothing is done.
    #[arg(long)]
    recompute: bool,

    #[command(flatten)]
    engine: EngineArguments,
}

/// Runs the study.
///
/// # Errors
/// Where the study or the output directory cannot be used, or a table not be written.
pub fn run(arguments: &RunArguments) -> Result<End, CliError> {
    let study = arguments.study.load()?;
    let directory =
        arguments.out.clone().unwrap_or_else(|| Path::new("results").join(study.name()));
    let options = arguments.engine.options(arguments.shard.shard);
    let output_dir = OutputDir {
        directory: &directory,
        shard: options.shard,
        retry_failed: options.retry_failed,
        recompute: arguments.recompute,
        shards: &[],
        quiet: arguments.engine.quiet,
    };
    carry_out(&study, &output_dir, options, &arguments.engine)
}

/// Runs a study in its place.
///
/// # Errors
/// Where the output directory cannot be used, or a table or finished runs not be written.
pub fn carry_out(
    study: &Study,
    output_dir: &OutputDir<'_>,
    options: EngineOptions,
    arguments: &EngineArguments,
) -> Result<End, CliError> {
    let (mut store, mut results) = match output_dir.prepare(study)? {
        Ready::Complete(manifest) => {
            return complete(study, output_dir.directory, &manifest, arguments);
        }
        Ready::Open(store, results) => (store, results),
    };
    let ran =
        run_on_engine(study, options, arguments, Some(&mut *store), |record, point| {
            match (record, point) {
                (Some(record), _) => results.push_run(record),
                (_, Some((point, detail))) => results.push_point(point.clone(), detail),
                (None, None) => Ok(()),
            }
        })?;
    store.check()?;
    let circumstances =
        Circumstances { merging: output_dir.merging(), ..ran.circumstances.clone() };
    results.finish(study, circumstances)?;
    ran.report(study, arguments, Some(output_dir.directory), None)?;
    Ok(ran.end())
}

/// Says that there is nothing to do, and shows what there is.
fn complete(
    study: &Study,
    path: &Path,
    manifest: &Manifest,
    arguments: &EngineArguments,
) -> Result<End, CliError> {
    let directory = path.display();
    if !arguments.quiet {
        let runs = manifest.runs_finished;
        say(&format!("{directory} already holds all {runs} runs of this study: nothing to do"));
    }
    if arguments.json || !arguments.quiet {
        let most = if arguments.json { usize::MAX } else { MOST_LINES };
        let table = PointsTable::read(study, &Table::open(path, manifest, "points")?, most)?;
        if arguments.json {
            let mut report = json!({
                "study": study.name(),
                "out": directory.to_string(),
                "runs_planned": manifest.runs_planned,
                "runs_finished": manifest.runs_finished,
                "interrupted": false,
                "already_complete": true,
                "points": table.json(),
            });
            if study.precision().is_some() {
                report["points_not_precise"] = table.not_precise().into();
            }
            print_json(&format!("{report:#}\n"))?;
        } else {
            print(&table.text())?;
        }
        if !arguments.quiet {
            table.precision_line().iter().for_each(|line| say(line));
        }
    }
    let failed = manifest.labels.get(Label::Failed.name()).is_some_and(|&failed| failed > 0);
    Ok(if failed { End::RunsFailed } else { End::Well })
}
