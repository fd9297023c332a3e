//! Computes a study with progress and prints its result.

use std::path::Path;

use serde_json::{Value, json};

use super::arguments::EngineArguments;
use super::output::{CliError, End, print_result};
use super::points_table::{MOST_LINES, PointsTable};
use super::result_lines::failure_line;
use crate::analysis::PointDetail;
use crate::classification::Label;
use crate::engine::{
    EngineOptions, Parts, Planned, Progress, RunTotals, Sink, StopReason, Store, run_study, say,
    stop_on_signals,
};
use crate::numbers::counted;
use crate::report::PointFacts;
use crate::responses::add_known;
use crate::study::Study;
use crate::table::{Manifest, PointRow, RunRecord, WriteError};

/// A study that has been computed.
pub struct ComputedStudy<'a> {
    /// The counts of runs, and why the computation stopped.
    pub totals: RunTotals,
    /// The manifest of its tables, without their files.
    pub manifest: Manifest,
    table: PointsTable<'a>,
}

impl ComputedStudy<'_> {
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
        let json = || {
            let facts = json!({
                "runs_kept": self.totals.reused,
                "interrupted": self.totals.interrupted(),
                "already_complete": false,
                "failures": self.manifest.failures,
                "wall_s": self.manifest.wall_s,
            });
            let counts = [self.manifest.runs_planned, runs];
            let mut report = self.table.result_json(directory, counts, facts);
            add_known(&mut report, "expectations", expectations);
            report
        };
        if arguments.json || !arguments.quiet {
            print_result(arguments.json, json, || self.table.text())?;
        }
        if !arguments.quiet {
            say(&self.speed_line());
            let failed = self.totals.counts.of(Label::Failed);
            failure_line(&self.manifest.failures, failed, runs).iter().for_each(|line| say(line));
            self.table.precision_line().iter().for_each(|line| say(line));
            if let Some(directory) = directory {
                say(&format!("tables in {}", directory.display()));
            }
            self.stopped_line(study).iter().for_each(|line| say(line));
        }
        Ok(())
    }

    fn speed_line(&self) -> String {
        let Manifest { wall_s, threads, .. } = self.manifest;
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
        let planned = self.manifest.runs_planned;
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
struct Collector<'a, 's> {
    study: &'s Study,
    sink: &'a mut dyn Sink,
    table: PointsTable<'s>,
    progress: &'a Progress,
}

impl Sink for Collector<'_, '_> {
    fn run(&mut self, record: RunRecord) -> Result<(), WriteError> {
        self.sink.run(record)
    }

    fn point(&mut self, row: PointRow, detail: PointDetail) -> Result<(), WriteError> {
        let point = PointFacts::of(self.study, &row);
        let table = &self.table;
        self.progress.point(|| table.sentence(&point), || table.point_json(&row));
        self.table.push(&row);
        self.sink.point(row, detail)
    }
}

/// Computes a study with progress; `sink` receives each run and each point.
pub fn run_on_engine<'a>(
    study: &'a Study,
    options: EngineOptions,
    arguments: &EngineArguments,
    store: Option<&mut Store>,
    sink: &mut dyn Sink,
) -> Result<ComputedStudy<'a>, CliError> {
    let begun = Manifest::begin(study, options.shard);
    let stop = stop_on_signals();
    let planned = Planned {
        study: study.name(),
        runs: begun.runs_planned,
        at_most: study.precision().is_some(),
        parts: Parts::Points(study.point_count()),
    };
    let progress = Progress::begin(planned, arguments.show());
    let most = if arguments.json { usize::MAX } else { MOST_LINES };
    let table = PointsTable::new(study, most);
    let mut collector = Collector { study, sink, table, progress: &progress };
    let ended = run_study(study, options, &stop, &progress, store, &mut collector);
    let wall = progress.close();
    let totals = ended?;
    progress.ended(totals.interrupted());
    let manifest = totals.manifest(begun, wall, options.threads);
    Ok(ComputedStudy { totals, manifest, table: collector.table })
}
