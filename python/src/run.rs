//! How a study is run: in memory, or into a directory, like the command line.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use stickslip::CommandError;
use stickslip::analysis::PointDetail;
use stickslip::cli::{MOST_LINES, PointsTable};
use stickslip::engine::{
    EngineOptions, OutputDir, Parts, Planned, PreparedDirectory, Progress, ProgressDisplay,
    ReadableResults, Sink, run_study,
};
use stickslip::study::Study;
use stickslip::table::{Manifest, MemoryRows, PointRow, RunRecord, StudyTables, WriteError};

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
        let begun = Manifest::begin(study, self.options().shard);
        let mut summary = PointsTable::new(study, MOST_LINES);
        summary.is_saved = false;
        let progress = Progress::begin(self.planned(study), self.show.clone());
        let mut sink = InMemory(&mut tables, &mut summary);
        let ended = run_study(study, self.options(), stop, &progress, None, &mut sink);
        progress.close();
        let totals = ended.map_err(|error| match error {
            CommandError::Write(error) => Trouble::from(error),
            error => error.into(),
        })?;
        let tables = tables.finish()?;
        let counted = begun.with_runs(totals.counts, &totals.failures);
        let manifest = Manifest { complete: true, threads: self.threads, ..counted };
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
                let begun = Manifest::begin(study, options.shard);
                let progress = Progress::begin(self.planned(study), self.show.clone());
                let tables = &mut results.tables;
                let ended = run_study(study, options, stop, &progress, Some(&mut *store), tables);
                let wall = progress.close();
                let totals = ended?;
                store.check()?;
                results.finish(totals.manifest(begun, wall, options.threads))?
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

/// Collects runs and points in memory, the points also as people read them.
struct InMemory<'a, 's>(&'a mut StudyTables<MemoryRows>, &'a mut PointsTable<'s>);

impl Sink for InMemory<'_, '_> {
    fn run(&mut self, record: RunRecord) -> Result<(), WriteError> {
        self.0.run(record)
    }

    fn point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), WriteError> {
        self.1.push(&point);
        self.0.point(point, detail)
    }
}
