//! Computes a study with progress and prints its result.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Value, json};

use super::arguments::EngineArguments;
use super::exit::{CliError, End};
use super::failures::failure_line;
use super::output::{print, print_json};
use super::points_table::{MOST_LINES, PointsTable};
use crate::analysis::{FailureCounts, PointDetail};
use crate::classification::Label;
use crate::counted::counted;
use crate::engine::{
    EngineOptions, Parts, Planned, Progress, RunTotals, Sink, StopReason, Store, run_study, say,
    stop_on_signals,
};
use crate::report::PointFacts;
use crate::study::Study;
use crate::table::{Circumstances, PointRow, ResultsError, RunRecord};

/// A study that has been computed.
pub struct Ran {
    /// The counts of runs, and why the computation stopped.
    pub totals: RunTotals,
    /// The facts for the manifest.
    pub circumstances: Circumstances,
    failures: FailureCounts,
    table: PointsTable,
}

impl Ran {
    /// Returns how the command ends.
    pub fn end(&self) -> End {
        match self.totals.stopped {
            Some(StopReason::Interrupted | StopReason::Time) => End::Interrupted,
            Some(StopReason::Failures) => End::TooManyFailed,
            None if self.totals.counts.of(Label::Failed) > 0 => End::RunsFailed,
            None => End::Well,
        }
    }

    /// Prints the result; `expectations` is added to the JSON.
    pub fn report(
        &self,
        study: &Study,
        arguments: &EngineArguments,
        directory: Option<&Path>,
        expectations: Option<Value>,
    ) -> Result<(), CliError> {
        let runs = self.totals.counts.total();
        if arguments.json {
            let facts = json!({
                "runs_kept": self.totals.reused,
                "interrupted": self.totals.interrupted(),
                "already_complete": false,
                "failures": self.failures.by_name(),
                "wall_s": self.circumstances.wall_s,
            });
            let planned = self.circumstances.runs_planned;
            let mut report = self.table.result_json(study, directory, [planned, runs], facts);
            if let Some(expectations) = expectations {
                report["expectations"] = expectations;
            }
            print_json(&format!("{report:#}\n"))?;
        } else if !arguments.quiet {
            print(&self.table.text())?;
        }
        if !arguments.quiet {
            say(&self.speed_line());
            let failed = self.totals.counts.of(Label::Failed);
            let failures = self.failures.by_name();
            failure_line(&failures, failed, runs).iter().for_each(|line| say(line));
            self.table.precision_line().iter().for_each(|line| say(line));
            if let Some(directory) = directory {
                say(&format!("tables in {}", directory.display()));
            }
            self.stopped_line(study).iter().for_each(|line| say(line));
        }
        Ok(())
    }

    fn speed_line(&self) -> String {
        let Circumstances { wall_s, threads, .. } = self.circumstances;
        let (runs, reused) = (self.totals.counts.total(), self.totals.reused);
        let computed = runs.saturating_sub(reused);
        let rate = match computed {
            0 => String::new(),
            _ => format!(": {:.0} runs/s", computed as f64 / wall_s.max(1e-9)),
        };
        let speed = format!("in {wall_s:.1} s on {}{rate}", counted(threads, "thread"));
        if reused == 0 {
            format!("{} {speed}", counted(runs, "run"))
        } else {
            let runs = counted(runs, "run");
            format!("{runs}: {reused} finished earlier, {computed} computed {speed}")
        }
    }

    fn stopped_line(&self, study: &Study) -> Option<String> {
        let failed = self.totals.counts.of(Label::Failed);
        let too_many =
            format!("stopped: {failed} runs have failed, more than --on-failure allows,");
        let (cause, continuation) = match self.totals.stopped? {
            StopReason::Interrupted => ("interrupted", "the same command continues"),
            StopReason::Time => ("out of time (--max-seconds)", "the same command continues"),
            StopReason::Failures => {
                (too_many.as_str(), "--on-failure continue computes the others")
            }
        };
        let runs = self.totals.counts.total();
        let planned = self.circumstances.runs_planned;
        let bound = if study.precision().is_some() { "at most " } else { "" };
        let abandoned = match self.totals.abandoned {
            0 => String::new(),
            1 => "; 1 run in progress was abandoned".to_owned(),
            more => format!("; {more} runs in progress were abandoned"),
        };
        Some(format!(
            "{cause} after {runs} of {bound}{planned} runs{abandoned}; finished runs are saved; {continuation}"
        ))
    }
}

/// Passes runs and points to another sink, reports each point, and collects the points that are printed.
struct Collector<'a, S> {
    study: &'a Study,
    sink: &'a mut S,
    failures: FailureCounts,
    table: PointsTable,
    progress: &'a Progress,
}

impl<S: Sink> Sink for Collector<'_, S> {
    type Error = S::Error;

    fn run(&mut self, record: RunRecord) -> Result<(), S::Error> {
        self.failures.add(record.outcome.evidence);
        self.sink.run(record)
    }

    fn point(&mut self, row: PointRow, detail: PointDetail) -> Result<(), S::Error> {
        let point = PointFacts::of(self.study, &row);
        let (study, table, progress) = (self.study, &self.table, self.progress);
        progress.point(|| table.sentence(study, &point), || table.point_json(study, &row));
        self.table.push(self.study, &row);
        self.sink.point(row, detail)
    }
}

/// Computes a study with progress; `sink` receives each run and each point.
pub fn run_on_engine(
    study: &Study,
    options: EngineOptions,
    arguments: &EngineArguments,
    store: Option<&mut Store>,
    sink: &mut impl Sink<Error = ResultsError>,
) -> Result<Ran, CliError> {
    let runs_planned = options.shard.most_runs(study);
    let stop = stop_on_signals();
    // A clock before 1970 is wrong; the manifest then holds 0.
    let started = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let planned = Planned {
        study: study.name(),
        runs: runs_planned,
        at_most: study.precision().is_some(),
        parts: Parts::Points(study.point_count()),
    };
    let progress = Progress::begin(planned, arguments.show());
    let most = if arguments.json { usize::MAX } else { MOST_LINES };
    let table = PointsTable::new(study, most);
    let failures = FailureCounts::default();
    let mut collector = Collector { study, sink, failures, table, progress: &progress };
    let ended = run_study(study, options, &stop, &progress, store, &mut collector);
    let wall = progress.close();
    let totals = ended?;
    progress.ended(totals.interrupted());
    Ok(Ran {
        totals,
        circumstances: Circumstances {
            shard: options.shard.to_string(),
            runs_planned,
            runs_kept: totals.reused,
            started_unix_s: started.as_secs_f64(),
            wall_s: wall.as_secs_f64(),
            threads: options.threads,
            complete: !totals.interrupted(),
            merging: Vec::new(),
        },
        failures: collector.failures,
        table: collector.table,
    })
}
