//! Farms runs over the cores and hands them on in order.
//!
//! Which run is computed where and when changes nothing in its result: a run is a pure function of
//! the study and its number. How many runs there are is decided in rounds, of which a study without a
//! precision has one. Chunks of a round bound the memory; while one is computed, the one before is
//! written.

mod compute;
mod interrupt;
mod progress;
mod rounds;
mod shard;
mod work;

pub use compute::compute;
pub use interrupt::stop_on_signals;
pub use progress::{Progress, say};
pub use shard::{Shard, ShardError};

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;
use thiserror::Error;

use self::compute::{Engine, InLockstep, OneByOne};
use self::rounds::{Round, Rounds};
use self::work::{Chunk, Work};
use crate::analysis::{LabelCounts, NearestFinder, PointAccumulator, PointDetail};
use crate::ending::Outcome;
use crate::model::Case;
use crate::motion::VectorLevel;
use crate::study::Study;
use crate::table::{PointRow, RunRecord};

/// How a study is farmed. None of it changes a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FarmOptions {
    /// Worker threads; at least one is used.
    pub threads: usize,
    /// Runs computed before they are handed on; at least one.
    pub chunk: usize,
    /// The part of the study to compute.
    pub shard: Shard,
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
}

/// What a farm has done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tally {
    /// Finished runs per label.
    pub counts: LabelCounts,
    /// Whether `stop` cut it short.
    pub interrupted: bool,
}

/// Computes the runs of a study's shard in lockstep and hands runs and points to `sink`.
///
/// When `stop` becomes true, runs in progress are finished, all finished runs are handed on, and
/// the farm returns. A panic in a run is that run's failure and nobody else's.
///
/// # Errors
/// Where threads cannot be started or the sink refuses.
pub fn farm_in_lockstep<S: Sink>(
    study: &Study,
    options: FarmOptions,
    stop: &AtomicBool,
    progress: &Progress,
    sink: &mut S,
) -> Result<Tally, FarmError<S::Error>> {
    farm_with(&InLockstep(VectorLevel::best()), study, options, stop, progress, sink)
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
    sink: &mut S,
) -> Result<Tally, FarmError<S::Error>> {
    farm_with(&OneByOne(simulate), study, options, stop, progress, sink)
}

fn farm_with<S: Sink>(
    engine: &impl Engine,
    study: &Study,
    options: FarmOptions,
    stop: &AtomicBool,
    progress: &Progress,
    sink: &mut S,
) -> Result<Tally, FarmError<S::Error>> {
    let threads = options.threads.max(1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let size = options.chunk.max(1) as u64;
    let finder = NearestFinder::new(!study.uncertain().is_empty());
    let compute_all = |round: Round, first: u64| -> Vec<RunRecord> {
        let runs = size.min(round.runs - first);
        let begun = AtomicU64::new(0);
        let finder = &finder;
        let chunk = Chunk { study, round, first, runs, begun, finder, stop, progress };
        let mut finished: Vec<(u64, RunRecord)> = (0..threads)
            .into_par_iter()
            .with_max_len(1)
            .flat_map_iter(|_| {
                let mut work = Work::new(&chunk);
                engine.compute(&mut work);
                work.finished
            })
            .collect();
        finished.sort_unstable_by_key(|(place, _)| *place);
        finished.into_iter().map(|(_, record)| record).collect()
    };
    let mut intake = Intake { study, sink, point: None, counts: LabelCounts::default() };
    let mut rounds = Rounds::new(study, options.shard);
    let mut due = 0;
    while let Some(round) = rounds.next(intake.so_far()) {
        progress.expect(rounds.most_runs());
        due += round.runs;
        let mut finished: Vec<RunRecord> = Vec::new();
        let mut first = 0;
        while first < round.runs && !stop.load(Ordering::Relaxed) {
            let waiting = std::mem::take(&mut finished);
            let (computed, taken) = pool
                .install(|| rayon::join(|| compute_all(round, first), || intake.take_all(waiting)));
            taken.map_err(FarmError::Sink)?;
            finished = computed;
            first += size;
        }
        intake.take_all(finished).map_err(FarmError::Sink)?;
        if intake.counts.total() < due {
            break;
        }
    }
    let counts = intake.finish().map_err(FarmError::Sink)?;
    Ok(Tally { counts, interrupted: counts.total() < due })
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
