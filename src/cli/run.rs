//! `stickslip run`: computes a study and writes its tables.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::arguments::{EngineArguments, StudyArgument, results_directory};
use super::output::{CliError, End, print_result};
use super::points_table::{MOST_LINES, PointsTable};
use super::result_lines::{failed_runs, failure_line};
use super::run_on_engine::run_on_engine;
use crate::engine::{EngineOptions, OutputDir, PreparedDirectory, Shard, say};
use crate::numbers::counted;
use crate::study::Study;
use crate::table::{Manifest, Table};

const EXAMPLES: &str = "\
Examples:
  stickslip run studies/preferred-equilibria.yaml
  stickslip run study.yaml --out results/night --threads 8
  stickslip run study.yaml --shard 2/4 --out results/part-2     (see merge)

Computes all runs of the study. DIR holds runs.parquet (a row per run), points.parquet (a row per point of the \
sweep), time_to_rest.parquet (per point, the probability of rest over time), equilibria.parquet (where the runs \
came to rest), equilibrium_histogram.parquet (how often in which part of the ring), cycles.parquet (per point, \
the limit cycles by class), study.yaml (with all defaults), manifest.json, and chunks/ with the finished runs, \
which are written during the computation. A table of more than 524,288 rows is a directory of that name, with \
files of 524,288 rows each: part-00000.parquet and so on.

After any interruption (Ctrl-C, a kill, a power cut, a full disk) the same command continues and writes the same \
bytes as an uninterrupted run. Ctrl-C waits one second for runs in progress, abandons those that take longer, \
saves all finished runs and exits with 130; a second Ctrl-C stops immediately. An edited study may be run into \
the directory of its results: only new runs are computed, and the old tables move to earlier/. Afterwards \
`stickslip summary` and `stickslip report` show the results.";

/// Compute a study and write its results as Parquet tables
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Directory for the results; no file in it is deleted [default: results/<name of the study>]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Compute only part K of N
    ///
    /// A part has one run out of every N consecutive runs, so that all parts cost about the same. In a study
    /// with `precision`, it has one point out of every N consecutive points, with all runs of the point, because
    /// the number of runs of a point depends on all its runs.
    #[arg(long, value_name = "K/N", default_value = "1/1")]
    shard: Shard,

    /// Run into a directory with results of another study even if none of its runs can be used
    ///
    /// The old results move to earlier/. Without this option the command prints the difference and does nothing.
    #[arg(long)]
    recompute: bool,

    #[command(flatten)]
    engine: EngineArguments,
}

/// Computes the study.
pub fn run(arguments: &Arguments) -> Result<End, CliError> {
    let study = arguments.study.load_and_warn(arguments.engine.quiet)?;
    let directory = results_directory(arguments.out.as_ref(), &study, "");
    let options = arguments.engine.options(arguments.shard);
    let output_dir = OutputDir {
        recompute: arguments.recompute,
        ..OutputDir::new(&directory, &options, arguments.engine.quiet)
    };
    carry_out(&study, &output_dir, options, &arguments.engine)
}

/// Computes a study in its output directory.
pub fn carry_out(
    study: &Study,
    output_dir: &OutputDir<'_>,
    options: EngineOptions,
    arguments: &EngineArguments,
) -> Result<End, CliError> {
    let (mut store, mut results) = match output_dir.prepare(study)? {
        PreparedDirectory::Complete(manifest) => {
            return complete(study, output_dir.directory, &manifest, arguments);
        }
        PreparedDirectory::Open(store, results) => (store, results),
    };
    let ran = run_on_engine(study, options, arguments, Some(&mut *store), &mut results.tables)?;
    store.check()?;
    results.finish(Manifest { merging: output_dir.merging(), ..ran.manifest.clone() })?;
    ran.report(study, arguments, Some(output_dir.directory), None)?;
    Ok(ran.end())
}

/// Reports that all runs are finished, and prints their table.
fn complete(
    study: &Study,
    path: &Path,
    manifest: &Manifest,
    arguments: &EngineArguments,
) -> Result<End, CliError> {
    let failed = failed_runs(manifest);
    if !arguments.quiet {
        let (directory, runs) = (path.display(), counted(manifest.runs_finished, "run"));
        say(&format!("{directory} already holds all {runs} of this study: nothing to do"));
    }
    if arguments.json || !arguments.quiet {
        let most = if arguments.json { usize::MAX } else { MOST_LINES };
        let table = PointsTable::read(study, &Table::open(path, manifest, "points")?, most)?;
        let json = || {
            let counts = [manifest.runs_planned, manifest.runs_finished];
            let facts = json!({
                "interrupted": false,
                "already_complete": true,
                "failures": manifest.failures,
            });
            table.result_json(Some(path), counts, facts)
        };
        print_result(arguments.json, json, || table.text())?;
        if !arguments.quiet {
            let line = failure_line(&manifest.failures, failed, manifest.runs_finished);
            line.iter().for_each(|line| say(line));
            table.precision_line().iter().for_each(|line| say(line));
        }
    }
    Ok(if failed > 0 { End::RunsFailed } else { End::Well })
}
