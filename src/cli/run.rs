//! `stickslip run`: computes a study and writes its tables.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{SystemTime, UNIX_EPOCH};

use clap::Args;
use serde_json::{Value, json};

use super::arguments::{FarmArguments, StudyArgument};
use super::exit::{CliError, End};
use super::output::print;
use super::points_table::PointsTable;
use crate::analysis::PointDetail;
use crate::ending::Label;
use crate::farm::{Progress, Sink, Tally, farm_in_lockstep, say, stop_on_signals};
use crate::study::Study;
use crate::table::{
    Circumstances, Destination, PointRow, Results, ResultsError, RunRecord, inspect,
};

const EXAMPLES: &str = "\
Examples:
  stickslip run studies/preferred-equilibria.yaml
  stickslip run study.yaml --out results/night --threads 8
  stickslip run study.yaml --shard 2/4 --out results/part-2

The directory holds runs.parquet (a row per run), points.parquet (a row per point of the sweep),
rest.parquet (the probability of being at rest over time, per point), equilibria.parquet (where runs
came to rest), density.parquet (how often in which part of the ring), cycles.parquet (the limit cycles
by class, per point), study.yaml (with all defaults filled in) and manifest.json. A table of more than
524,288 rows is a directory of that name, with files of as many rows each: part-00000.parquet and so
on. Ctrl-C finishes the runs in progress, keeps everything and exits with 130; a second Ctrl-C stops at
once.";

/// Run a study: thousands of simulations, their endings as Parquet tables
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct RunArguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Directory for the results; never overwritten [default: results/<name of the study>]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    farm: FarmArguments,
}

/// Runs the study.
///
/// # Errors
/// Where the study or the output directory cannot be used, or a table not be written.
pub fn run(arguments: &RunArguments) -> Result<End, CliError> {
    let study = Study::load(&arguments.study.study)?;
    let directory =
        arguments.out.clone().unwrap_or_else(|| Path::new("results").join(study.name()));
    let shard = arguments.farm.shard.to_string();
    if let Destination::Complete(manifest) = inspect(&directory, &study, &shard)? {
        if !arguments.farm.quiet {
            say(&format!(
                "{} already holds all {} runs of this study: nothing to do",
                directory.display(),
                manifest.runs_finished,
            ));
        }
        if arguments.farm.json {
            let report = json!({
                "study": study.name(),
                "out": directory.display().to_string(),
                "runs_planned": manifest.runs_planned,
                "runs_finished": manifest.runs_finished,
                "interrupted": false,
                "already_complete": true,
            });
            print(&format!("{report:#}\n"))?;
        }
        return Ok(end(&manifest.labels, false));
    }
    let mut results = Results::create(&directory, &study)?;
    let ran = farm_study(&study, &arguments.farm, |record, point| match (record, point) {
        (Some(record), _) => results.push_run(record),
        (_, Some((point, detail))) => results.push_point(point.clone(), detail),
        (None, None) => Ok(()),
    })?;
    let manifest = results.finish(&study, ran.circumstances.clone())?;
    let end = end(&manifest.labels, ran.tally.interrupted);
    ran.report(&study, &arguments.farm, Some(&directory), None)?;
    Ok(end)
}

fn end(labels: &std::collections::BTreeMap<String, u64>, interrupted: bool) -> End {
    if interrupted {
        End::Interrupted
    } else if labels.get(Label::Failed.name()).is_some_and(|&failed| failed > 0) {
        End::RunsFailed
    } else {
        End::Well
    }
}

/// A study that has been farmed.
pub struct Ran {
    /// What has been done.
    pub tally: Tally,
    /// For the manifest.
    pub circumstances: Circumstances,
    table: PointsTable,
}

impl Ran {
    /// Says on the terminal what came out; `expectations` is added to the JSON.
    ///
    /// # Errors
    /// Where standard output cannot be written to.
    pub fn report(
        &self,
        study: &Study,
        arguments: &FarmArguments,
        directory: Option<&Path>,
        expectations: Option<Value>,
    ) -> Result<(), CliError> {
        let runs = self.tally.counts.total();
        if arguments.json {
            let mut report = json!({
                "study": study.name(),
                "out": directory.map(|directory| directory.display().to_string()),
                "runs_planned": self.circumstances.runs_planned,
                "runs_finished": runs,
                "interrupted": self.tally.interrupted,
                "already_complete": false,
                "wall_s": self.circumstances.wall_s,
                "points": self.table.json(),
            });
            if study.precision().is_some() {
                report["points_not_precise"] = self.table.not_precise().into();
            }
            if let Some(expectations) = expectations {
                report["expectations"] = expectations;
            }
            print(&format!("{report:#}\n"))?;
        } else if !arguments.quiet {
            print(&self.table.text())?;
        }
        if !arguments.quiet {
            let seconds = self.circumstances.wall_s;
            let rate = runs as f64 / seconds.max(1e-9);
            let threads = self.circumstances.threads;
            say(&format!("{runs} runs in {seconds:.1} s on {threads} threads: {rate:.0} runs/s"));
            let failed = self.tally.counts.of(Label::Failed);
            if failed > 0 {
                say(&format!(
                    "{failed} runs failed: see the columns evidence and error of runs.parquet"
                ));
            }
            self.table.precision_line().iter().for_each(|line| say(line));
            if let Some(directory) = directory {
                say(&format!("tables in {}", directory.display()));
            }
            if self.tally.interrupted {
                let planned = self.circumstances.runs_planned;
                let bound = if study.precision().is_some() { "at most " } else { "" };
                say(&format!(
                    "interrupted after {runs} of {bound}{planned} runs; what is finished is kept"
                ));
            }
        }
        Ok(())
    }
}

/// A point and what goes into its own tables.
pub type PointWithDetail<'a> = (&'a PointRow, PointDetail);

/// Hands runs and points to a function and collects the points for the terminal.
struct Collector<F> {
    take: F,
    table: PointsTable,
}

impl<F> Sink for Collector<F>
where
    F: FnMut(Option<RunRecord>, Option<PointWithDetail<'_>>) -> Result<(), ResultsError> + Send,
{
    type Error = ResultsError;

    fn run(&mut self, record: RunRecord) -> Result<(), ResultsError> {
        (self.take)(Some(record), None)
    }

    fn point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), ResultsError> {
        self.table.push(&point);
        (self.take)(None, Some((&point, detail)))
    }
}

/// Farms a study with progress; `take` gets each run and each point.
///
/// # Errors
/// Where threads cannot be started or `take` refuses.
pub fn farm_study(
    study: &Study,
    arguments: &FarmArguments,
    take: impl FnMut(Option<RunRecord>, Option<PointWithDetail<'_>>) -> Result<(), ResultsError> + Send,
) -> Result<Ran, CliError> {
    let options = arguments.options();
    let runs_planned = options.shard.most_runs(study);
    let stop = stop_on_signals().unwrap_or_else(|error| {
        say(&format!("warning: Ctrl-C will not be clean: {error}"));
        Arc::new(AtomicBool::new(false))
    });
    // A clock before 1970 is a clock that is wrong: the manifest then says 0.
    let started = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let progress = match study.precision() {
        None => Progress::new(runs_planned, arguments.quiet),
        Some(_) => Progress::at_most(runs_planned, arguments.quiet),
    };
    let mut collector = Collector { take, table: PointsTable::new(study, arguments.json) };
    let farmed = farm_in_lockstep(study, options, &stop, &progress, &mut collector);
    let wall = progress.close();
    let tally = farmed?;
    Ok(Ran {
        tally,
        circumstances: Circumstances {
            shard: options.shard.to_string(),
            runs_planned,
            started_unix_s: started.as_secs_f64(),
            wall_s: wall.as_secs_f64(),
            threads: options.threads,
            complete: !tally.interrupted,
        },
        table: collector.table,
    })
}
