//! How a study is run: in memory, or into a directory, like the command line.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use arrow_schema::ArrowError;
use stickslip::analysis::{FailureCounts, PointDetail};
use stickslip::cli::{MOST_LINES, PointsTable};
use stickslip::engine::{
    EngineOptions, OutputDir, Parts, Planned, PreparedDirectory, Progress, ProgressDisplay,
    ReadableResults, Sink, run_study,
};
use stickslip::study::Study;
use stickslip::table::{Circumstances, Manifest, MemoryRows, PointRow, RunRecord, StudyTables};

use crate::error::Trouble;
use crate::results::Results;

/// How a study is to be run.
pub struct Run {
    /// The file of the study.
    pub file: PathBuf,
    /// Number of worker threads.
    pub threads: usize,
    /// How progress is shown.
    pub show: ProgressDisplay,
    /// Whether a study may replace results without a reusable run.
    pub recompute: bool,
}

impl Run {
    /// Runs a study and keeps its tables in memory.
    ///
    /// # Errors
    /// Returns an error if the threads cannot be started.
    pub fn in_memory(self, study: &Arc<Study>, stop: &AtomicBool) -> Result<Results, Trouble> {
        let mut tables = StudyTables::in_memory(study);
        let shard = self.options().shard;
        let begun = Circumstances::begin(shard.to_string(), shard.most_runs(study));
        let mut summary = PointsTable::new(study, MOST_LINES);
        summary.is_saved = false;
        let progress = Progress::begin(self.planned(study), self.show.clone());
        let mut failures = FailureCounts::default();
        let mut sink = InMemory(&mut tables, &mut summary, &mut failures);
        let ended = run_study(study, self.options(), stop, &progress, None, &mut sink);
        progress.close();
        let totals = ended?;
        let tables = tables.finish()?;
        let begun = Circumstances { complete: true, threads: self.threads, ..begun };
        let manifest = Manifest::new(study, begun, totals.counts, &failures, BTreeMap::new());
        let study = (Arc::clone(study), self.file);
        Ok(Results::in_memory(study, manifest, tables, summary.markdown()))
    }

    /// Runs a study into a directory, like the command line.
    ///
    /// # Errors
    /// Returns an error if the directory contains something else, or cannot be used.
    pub fn into_directory(
        self,
        study: &Study,
        directory: PathBuf,
        stop: &AtomicBool,
    ) -> Result<Results, Trouble> {
        let options = self.options();
        let output_dir = OutputDir {
            directory: &directory,
            shard: options.shard,
            retry_failed: options.retry_failed,
            recompute: self.recompute,
            shards: &[],
            quiet: matches!(self.show, ProgressDisplay::Nothing),
        };
        let manifest = match output_dir.prepare(study)? {
            PreparedDirectory::Complete(manifest) => *manifest,
            PreparedDirectory::Open(mut store, mut results) => {
                let begun =
                    Circumstances::begin(options.shard.to_string(), options.shard.most_runs(study));
                let progress = Progress::begin(self.planned(study), self.show.clone());
                let ended =
                    run_study(study, options, stop, &progress, Some(&mut *store), &mut *results);
                let wall_s = progress.close().as_secs_f64();
                let totals = ended?;
                store.check()?;
                let (runs_kept, threads) = (totals.reused, options.threads);
                let complete = !totals.interrupted();
                results.finish(
                    study,
                    Circumstances { runs_kept, complete, wall_s, threads, ..begun },
                )?
            }
        };
        let readable = ReadableResults::finished(study.clone(), manifest, &directory);
        Ok(Results::of_directory(directory, readable))
    }

    fn options(&self) -> EngineOptions {
        EngineOptions { threads: self.threads, ..EngineOptions::default() }
    }

    fn planned<'a>(&self, study: &'a Study) -> Planned<'a> {
        Planned {
            study: study.name(),
            runs: self.options().shard.most_runs(study),
            at_most: study.precision().is_some(),
            parts: Parts::Points(study.point_count()),
        }
    }
}

/// Collects runs and points in memory, the points as people read them, and the kinds of failures.
struct InMemory<'a, 's>(
    &'a mut StudyTables<MemoryRows>,
    &'a mut PointsTable<'s>,
    &'a mut FailureCounts,
);

impl Sink for InMemory<'_, '_> {
    type Error = ArrowError;

    fn run(&mut self, record: RunRecord) -> Result<(), ArrowError> {
        self.2.add(&record.outcome.evidence);
        self.0.run(record)
    }

    fn point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), ArrowError> {
        self.1.push(&point);
        self.0.point(point, detail)
    }
}
