//! Computes a study: workers compute batches of runs, and the sink receives finished runs in order.
//!
//! A batch is a set of runs that are all computed before it is decided whether more runs are needed; a study without
//! a precision has one batch. Batches are computed in parts, which bound the memory: the sink receives one part
//! while the next one is computed.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU64};
use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::Duration;

use super::batches::Batches;
use super::chunk_writer::{new_results, write_chunks};
use super::command_error::CommandError;
use super::compute::{Engine, in_lockstep, one_by_one};
use super::stop::{StopCondition, StopReason, with_grace_period};
use super::store::{ChunkIndex, NewResult, ResultCache, Store};
use super::worker_pool::{RunQueue, Storage};
use super::{EngineOptions, Progress, WorkerPool};
use crate::analysis::{FailureCounts, LabelCounts, PointAccumulator};
use crate::classification::{Outcome, Runs};
use crate::model::{Case, Model, Simulation};
use crate::motion::Cancellation;
use crate::study::{Plan, Study};
use crate::table::{Manifest, PointRow, ResponseSamples, RunRecord, Sink, WriteError};

/// The result of a computation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunTotals {
    /// Finished runs per label.
    pub counts: LabelCounts,
    /// Failed runs per kind of failure.
    pub failures: FailureCounts,
    /// Why the computation stopped early, if it did.
    pub stopped: Option<StopReason>,
    /// Number of finished runs that did not have to be computed.
    pub reused: u64,
    /// Number of runs that had begun and were abandoned without a result.
    pub abandoned: u64,
}

impl RunTotals {
    /// Whether the computation stopped early.
    pub fn interrupted(&self) -> bool {
        self.stopped.is_some()
    }

    /// Returns the manifest of the computation, which took this time on this number of threads.
    pub fn manifest(&self, begun: Manifest, wall: Duration, threads: usize) -> Manifest {
        let (runs_kept, wall_s, complete) = (self.reused, wall.as_secs_f64(), !self.interrupted());
        let counted = begun.with_runs(self.counts, &self.failures);
        Manifest { runs_kept, wall_s, threads, complete, ..counted }
    }
}

/// Computes the runs of a study's shard in lockstep and passes runs and points to `sink`. Runs that `store` holds
/// are not computed; all others are stored there.
///
/// When `stop` becomes true, runs in progress are finished or, after a second, abandoned; the sink receives all
/// finished runs, and the function returns. A panic in a run makes that run fail and leaves all others unchanged.
///
/// # Errors
/// Returns an error if the worker threads cannot be started, if the sink returns one, or if a chunk cannot be written.
pub fn run_study(
    study: &Study,
    options: EngineOptions,
    stop: &AtomicBool,
    progress: &Progress,
    store: Option<&mut Store>,
    sink: &mut dyn Sink,
) -> Result<RunTotals, CommandError> {
    let stop_condition = StopCondition::new(stop, &options);
    StudyRun { study, options, stop_condition, progress, engine: &in_lockstep }.run(store, sink)
}

/// Computes a study like [`run_study`], but simulates each case with the given function.
///
/// # Errors
/// Returns the errors of [`run_study`].
pub fn run_study_with(
    study: &Study,
    options: EngineOptions,
    simulate: impl Fn(&Case) -> Outcome + Sync,
    stop: &AtomicBool,
    progress: &Progress,
    store: Option<&mut Store>,
    sink: &mut dyn Sink,
) -> Result<RunTotals, CommandError> {
    let stop_condition = StopCondition::new(stop, &options);
    let engine = &|runs: &mut dyn Runs| one_by_one(runs, &simulate);
    StudyRun { study, options, stop_condition, progress, engine }.run(store, sink)
}

/// The computation of a study.
struct StudyRun<'a> {
    study: &'a Study,
    options: EngineOptions,
    stop_condition: StopCondition<'a>,
    progress: &'a Progress,
    engine: &'a Engine<'a>,
}

/// The parts of a store that the computation uses.
struct StoreReader<'a> {
    chunk_index: &'a mut ChunkIndex,
    result_cache: &'a ResultCache,
    new_results: SyncSender<NewResult>,
}

impl StudyRun<'_> {
    fn run(
        &self,
        store: Option<&mut Store>,
        sink: &mut dyn Sink,
    ) -> Result<RunTotals, CommandError> {
        let (stop_condition, chunk) = (&self.stop_condition, self.options.chunk);
        let mut stopped = None;
        let is_over = || stop_condition.abandons_runs(&mut stopped);
        with_grace_period(is_over, |cancellation| {
            let Some(Store { output, chunk_index, result_cache, .. }) = store else {
                return self.compute_all(cancellation, None, sink);
            };
            let (new_results, finished) = new_results();
            thread::scope(|scope| {
                let writer =
                    scope.spawn(move || write_chunks(output, &finished, chunk, stop_condition));
                let reading = Some(StoreReader { chunk_index, result_cache, new_results });
                let totals = self.compute_all(cancellation, reading, sink);
                // The writer is not expected to panic; a panic is a fault of the program.
                writer.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
                totals
            })
        })
    }

    fn compute_all(
        &self,
        cancellation: &Cancellation,
        mut disk: Option<StoreReader<'_>>,
        sink: &mut dyn Sink,
    ) -> Result<RunTotals, CommandError> {
        let StudyRun { study, ref options, ref stop_condition, progress, engine } = *self;
        let plan: &Plan = study;
        let pool = WorkerPool::new(options.threads)?;
        let computed = |label| progress.finished(label);
        let reused = |label| progress.reused(label);
        let size = options.chunk.max(1) as u64;
        let reused_count = AtomicU64::new(0);
        let (counts, failures) = Default::default();
        let mut collector = PointCollector { study, sink, point: None, counts, failures };
        let mut batches = Batches::new(study, options.shard);
        let mut due = 0;
        while let Some(batch) = batches.next(collector.point.as_ref().map(|point| &point.runs)) {
            progress.limit(batches.most);
            due += batch.runs;
            let mut finished: Vec<RunRecord> = Vec::new();
            let mut first = 0;
            let more_on_disk = |disk: &Option<StoreReader<'_>>, first| {
                let reaches = |disk: &StoreReader<'_>| disk.chunk_index.reach(batch.run_id(first));
                !stop_condition.stops_reading() && disk.as_ref().is_some_and(reaches)
            };
            while first < batch.runs
                && (!stop_condition.begins_no_run() || more_on_disk(&disk, first))
            {
                let end = batch.runs.min(first.saturating_add(size));
                let run_ids: Vec<u64> = (first..end).map(|index| batch.run_id(index)).collect();
                first = end;
                let found = match (&mut disk, run_ids.first(), run_ids.last()) {
                    (Some(disk), Some(&first), Some(&last)) => disk.chunk_index.window(first, last),
                    _ => HashMap::new(),
                };
                let disk =
                    disk.as_ref().map(|StoreReader { result_cache, new_results, .. }| Storage {
                        found: &found,
                        reused: &reused,
                        result_cache,
                        retry_failed: options.retry_failed,
                        new_results: new_results.clone(),
                        reused_count: &reused_count,
                    });
                let begun = AtomicU64::new(0);
                let batch = RunQueue {
                    runs: run_ids.into_iter().map(|run_id| (plan, run_id)).collect(),
                    begun,
                    audits: true,
                    stop_condition,
                    finished: &computed,
                    disk,
                };
                let waiting = std::mem::take(&mut finished);
                let compute = || pool.compute(cancellation, engine, &batch);
                let (records, delivered) =
                    pool.install(|| rayon::join(compute, || collector.add_all(waiting)));
                delivered?;
                finished = records;
            }
            collector.add_all(finished)?;
            if collector.counts.total() < due {
                break;
            }
        }
        progress.limit(batches.most);
        collector.close_point()?;
        let PointCollector { counts, failures, .. } = collector;
        let stopped = (counts.total() < due)
            .then(|| stop_condition.reason().unwrap_or(StopReason::Interrupted));
        Ok(RunTotals {
            counts,
            failures,
            stopped,
            reused: reused_count.into_inner(),
            abandoned: stop_condition.abandoned(),
        })
    }
}

/// The finished runs of a point.
struct FinishedPoint<'a> {
    point_id: u64,
    runs: PointAccumulator,
    responses: ResponseSamples<'a>,
}

/// Passes runs to the sink and collects them point by point.
struct PointCollector<'a> {
    study: &'a Study,
    sink: &'a mut dyn Sink,
    point: Option<FinishedPoint<'a>>,
    counts: LabelCounts,
    failures: FailureCounts,
}

impl PointCollector<'_> {
    fn add_all(&mut self, records: Vec<RunRecord>) -> Result<(), WriteError> {
        for record in records {
            let point_id = record.planned.point_id;
            if self.point.as_ref().is_some_and(|point| point.point_id != point_id) {
                self.close_point()?;
            }
            let point = self.point.get_or_insert_with(|| {
                let cells = self.study.point(point_id).cells;
                let responses = ResponseSamples::new(self.study.responses(), cells);
                FinishedPoint { point_id, runs: PointAccumulator::new(cells), responses }
            });
            point.runs.add(record.observed());
            point.responses.add(&record);
            self.counts.add(record.outcome.label());
            self.failures.add(&record.outcome.evidence);
            self.sink.run(record)?;
        }
        Ok(())
    }

    fn close_point(&mut self) -> Result<(), WriteError> {
        match self.point.take() {
            Some(FinishedPoint { point_id, runs, responses }) => {
                let point = self.study.point(point_id);
                let detail = runs.detail(observed_times_s(self.study.simulation(), point.model()));
                let row = PointRow::new(&point, runs.summary(), &responses);
                self.sink.point(row, detail)
            }
            None => Ok(()),
        }
    }
}

/// Returns how long runs of a model are observed in their last stage, s, until the end time and until that of continued
/// runs; for the durations of stages at the medians of uncertain parameters.
fn observed_times_s(simulation: &Simulation, model: &Model) -> [f64; 2] {
    let end_time_s = model.end_time_s().unwrap_or(simulation.end_time_s);
    let simulation = Simulation { end_time_s, ..*simulation };
    simulation.end_times_s().map(|end_time_s| end_time_s - model.last_stage_begins_s())
}
