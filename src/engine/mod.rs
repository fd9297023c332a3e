//! Farms runs over the cores and hands them on in order.
//!
//! Which run is computed where and when changes nothing in its result: a run is a pure function of
//! the study and its number. How many runs there are is decided in rounds, of which a study without a
//! precision has one. Chunks of a round bound the memory; while one is computed, the one before is
//! written.

mod batches;
mod chunk_writer;
mod compute;
mod interrupt;
mod output_dir;
mod patience;
mod progress;
mod record_motion;
mod shard;
mod stop;
mod store;
mod worker;
mod worker_pool;

pub use compute::{compute, quietly};
pub use interrupt::{stop_on_signals, survive_file_size_limit};
pub use output_dir::{Place, PlaceError, Ready};
pub use progress::{Planned, Progress, Show, say};
pub use record_motion::record;
pub use shard::{Shard, ShardError};
pub use stop::StopReason;
pub use store::{CHUNKS, Chunk, ChunkFault, Listed, Lock, Store, StoreError, listed_runs};
pub use worker_pool::WorkerPool;

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU64};
use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::Instant;

use thiserror::Error;

use self::batches::Rounds;
use self::chunk_writer::{keep, outbox};
use self::compute::{Engine, InLockstep, OneByOne};
use self::patience::with_patience;
use self::stop::Halt;
use self::store::{Fresh, Reuse, Shelves};
use self::worker::{Batch, Disk};
use crate::analysis::{LabelCounts, PointAccumulator, PointDetail};
use crate::classification::Outcome;
use crate::model::Case;
use crate::motion::{Cancellation, VectorLevel};
use crate::study::Study;
use crate::table::{PointRow, RunRecord};

/// How a study is farmed. None of it changes a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FarmOptions {
    /// Worker threads; at least one is used.
    pub threads: usize,
    /// Runs computed before they are handed on, and kept in one file; at least one.
    pub chunk: usize,
    /// The part of the study to compute.
    pub shard: Shard,
    /// When to begin no further run; those in progress are given up a second later.
    pub deadline: Option<Instant>,
    /// How many runs may fail before no further run is begun; any number if none.
    pub most_failed: Option<u64>,
    /// Whether finished runs that failed are computed again, from the same case.
    pub retry_failed: bool,
}

impl Default for FarmOptions {
    /// The whole study on one thread, to its end.
    fn default() -> Self {
        let (deadline, most_failed, retry_failed) = (None, None, false);
        FarmOptions {
            threads: 1,
            chunk: 1024,
            shard: Shard::WHOLE,
            deadline,
            most_failed,
            retry_failed,
        }
    }
}

/// Takes in runs and points, in the order of the study.
pub trait Sink: Send {
    /// What can go wrong.
    type Error: Send;

    /// A run has finished. Runs come in ascending order of their numbers.
    ///
    /// # Errors
    /// Stops the farm.
    fn run(&mut self, record: RunRecord) -> Result<(), Self::Error>;

    /// All runs of a point have finished, or those that will; `detail` goes into tables of its own.
    ///
    /// # Errors
    /// Stops the farm.
    fn point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), Self::Error>;
}

/// Why a study could not be farmed.
#[derive(Debug, Error)]
pub enum FarmError<E> {
    /// The worker threads could not be started.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The sink refused.
    #[error("{0}")]
    Sink(E),
    /// Finished runs could not be kept.
    #[error(transparent)]
    Store(StoreError),
}

/// What a farm has done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tally {
    /// Finished runs per label.
    pub counts: LabelCounts,
    /// Why it was cut short, if it was.
    pub stopped: Option<StopReason>,
    /// How many of the finished runs did not have to be computed.
    pub kept: u64,
    /// How many runs had begun and were given up; nothing of them is kept.
    pub given_up: u64,
}

impl Tally {
    /// Whether it was cut short.
    pub fn interrupted(&self) -> bool {
        self.stopped.is_some()
    }
}

/// Computes the runs of a study's shard in lockstep and hands runs and points to `sink`. Runs that are in
/// `store` are not computed; all others go there.
///
/// When `stop` becomes true, runs in progress are finished, or given up where that takes longer than a second;
/// all finished runs are handed on, and the farm returns. A panic in a run is that run's failure and nobody else's.
///
/// # Errors
/// Where threads cannot be started, the sink refuses or the store cannot be written.
pub fn farm_in_lockstep<S: Sink>(
    study: &Study,
    options: FarmOptions,
    stop: &AtomicBool,
    progress: &Progress,
    store: Option<&mut Store>,
    sink: &mut S,
) -> Result<Tally, FarmError<S::Error>> {
    let farm = Farm { study, options, halt: Halt::new(stop, &options), progress };
    farm.run(&InLockstep(VectorLevel::best()), store, sink)
}

/// The same with a function that simulates one case.
///
/// # Errors
/// As for [`farm_in_lockstep`].
pub fn farm<S: Sink>(
    study: &Study,
    options: FarmOptions,
    simulate: impl Fn(&Case) -> Outcome + Sync,
    stop: &AtomicBool,
    progress: &Progress,
    store: Option<&mut Store>,
    sink: &mut S,
) -> Result<Tally, FarmError<S::Error>> {
    let farm = Farm { study, options, halt: Halt::new(stop, &options), progress };
    farm.run(&OneByOne(simulate), store, sink)
}

/// A study on its way.
struct Farm<'a> {
    study: &'a Study,
    options: FarmOptions,
    halt: Halt<'a>,
    progress: &'a Progress,
}

/// What is needed of a store while runs are computed.
struct Reading<'a> {
    shelves: &'a mut Shelves,
    reuse: &'a Reuse,
    outbox: SyncSender<Fresh>,
}

impl Farm<'_> {
    fn run<S: Sink>(
        &self,
        engine: &impl Engine,
        store: Option<&mut Store>,
        sink: &mut S,
    ) -> Result<Tally, FarmError<S::Error>> {
        let mut stopped = None;
        let is_over = || self.halt.gives_up(&mut stopped);
        with_patience(is_over, |cancellation| self.run_under(cancellation, engine, store, sink))
    }

    fn run_under<S: Sink>(
        &self,
        cancellation: &Cancellation,
        engine: &impl Engine,
        store: Option<&mut Store>,
        sink: &mut S,
    ) -> Result<Tally, FarmError<S::Error>> {
        let Some(Store { keeper, shelves, reuse, .. }) = store else {
            return self.compute_all(cancellation, engine, None, sink);
        };
        let (outbox, finished) = outbox();
        let (halt, chunk) = (&self.halt, self.options.chunk);
        thread::scope(|scope| {
            let keeping = scope.spawn(move || keep(keeper, &finished, chunk, halt));
            let reading = Some(Reading { shelves, reuse, outbox });
            let tally = self.compute_all(cancellation, engine, reading, sink);
            // It has nothing to panic about; if it does, that is a failure of the program.
            keeping
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
                .map_err(FarmError::Store)?;
            tally
        })
    }

    fn compute_all<S: Sink>(
        &self,
        cancellation: &Cancellation,
        engine: &impl Engine,
        mut disk: Option<Reading<'_>>,
        sink: &mut S,
    ) -> Result<Tally, FarmError<S::Error>> {
        let Farm { study, ref options, ref halt, progress } = *self;
        let pool = WorkerPool::new(options.threads)?;
        let computed = |label| progress.finished(label);
        let taken = |label| progress.found(label);
        let size = options.chunk.max(1) as u64;
        let kept = AtomicU64::new(0);
        let mut intake = Intake { study, sink, point: None, counts: LabelCounts::default() };
        let mut rounds = Rounds::new(study, options.shard);
        let mut due = 0;
        while let Some(round) = rounds.next(intake.so_far()) {
            progress.expect(rounds.most_runs());
            due += round.runs;
            let mut finished: Vec<RunRecord> = Vec::new();
            let mut first = 0;
            let more_on_disk = |disk: &Option<Reading<'_>>, first| {
                let reaches = |disk: &Reading<'_>| disk.shelves.reach(round.run_id(first));
                !halt.at_once() && disk.as_ref().is_some_and(reaches)
            };
            while first < round.runs && (!halt.now() || more_on_disk(&disk, first)) {
                let end = round.runs.min(first.saturating_add(size));
                let run_ids: Vec<u64> = (first..end).map(|index| round.run_id(index)).collect();
                first = end;
                let found = match (&mut disk, run_ids.first(), run_ids.last()) {
                    (Some(disk), Some(&first), Some(&last)) => disk.shelves.window(first, last),
                    _ => HashMap::new(),
                };
                let disk = disk.as_ref().map(|Reading { reuse, outbox, .. }| Disk {
                    found: &found,
                    taken: &taken,
                    reuse,
                    retry_failed: options.retry_failed,
                    outbox: outbox.clone(),
                    kept: &kept,
                });
                let begun = AtomicU64::new(0);
                let batch =
                    Batch { study, run_ids, begun, audits: true, halt, finished: &computed, disk };
                let waiting = std::mem::take(&mut finished);
                let compute = || pool.compute(cancellation, engine, &batch);
                let (records, handed_on) =
                    pool.install(|| rayon::join(compute, || intake.take_all(waiting)));
                handed_on.map_err(FarmError::Sink)?;
                finished = records;
            }
            intake.take_all(finished).map_err(FarmError::Sink)?;
            if intake.counts.total() < due {
                break;
            }
        }
        let counts = intake.finish().map_err(FarmError::Sink)?;
        let stopped = (counts.total() < due).then(|| halt.reason().unwrap_or(StopReason::Asked));
        Ok(Tally { counts, stopped, kept: kept.into_inner(), given_up: halt.given_up() })
    }
}

/// Hands runs to the sink and collects them point by point.
struct Intake<'a, S> {
    study: &'a Study,
    sink: &'a mut S,
    point: Option<(u64, PointAccumulator)>,
    counts: LabelCounts,
}

impl<S: Sink> Intake<'_, S> {
    /// What is known of the point whose runs came last.
    fn so_far(&self) -> Option<&PointAccumulator> {
        self.point.as_ref().map(|(_, runs)| runs)
    }

    fn take_all(&mut self, records: Vec<RunRecord>) -> Result<(), S::Error> {
        for record in records {
            let point_id = record.planned.point_id;
            if self.point.as_ref().is_some_and(|(current, _)| *current != point_id) {
                self.close_point()?;
            }
            let start = || (point_id, PointAccumulator::new(self.study.point(point_id).cells));
            let (_, point) = self.point.get_or_insert_with(start);
            point.add(record.observed());
            self.counts.add(record.outcome.label());
            self.sink.run(record)?;
        }
        Ok(())
    }

    fn close_point(&mut self) -> Result<(), S::Error> {
        match self.point.take() {
            Some((point_id, runs)) => {
                let detail = runs.detail(self.study.simulation().end_times_s());
                let row = PointRow::new(&self.study.point(point_id), runs.summary());
                self.sink.point(row, detail)
            }
            None => Ok(()),
        }
    }

    fn finish(mut self) -> Result<LabelCounts, S::Error> {
        self.close_point()?;
        Ok(self.counts)
    }
}
