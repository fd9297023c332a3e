//! A pool of worker threads that share queues of runs.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use rayon::prelude::*;

use super::EngineOptions;
use super::compute::{Engine, in_lockstep};
use super::stop::{StopCondition, with_grace_period};
use super::worker::{RunQueue, Worker};
use crate::classification::Label;
use crate::motion::Cancellation;
use crate::study::Plan;
use crate::table::RunRecord;

/// The interval between two checks whether abandonable work has to stop.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// A pool of worker threads.
pub struct WorkerPool {
    pool: rayon::ThreadPool,
    /// The number of threads.
    threads: usize,
}

impl WorkerPool {
    /// Starts a pool of `threads` threads; at least one.
    ///
    /// # Errors
    /// Returns an error if the operating system cannot start the threads.
    pub fn new(threads: usize) -> Result<WorkerPool, rayon::ThreadPoolBuildError> {
        let threads = threads.max(1);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        Ok(WorkerPool { pool, threads })
    }

    /// Runs `work` on the pool, where rayon distributes it.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.pool.install(work)
    }

    /// Runs `work` on the pool, where rayon distributes it, and returns its result. Returns `None` as soon as `stop`
    /// becomes true; the work then continues unnoticed until it or the program ends.
    pub fn unless_stopped<T: Send + 'static>(
        &self,
        stop: &AtomicBool,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Option<T> {
        let (sender, receiver) = channel();
        self.pool.spawn(move || {
            // A panic continues on the waiting thread, which does not use the work's data. Nobody waits for abandoned work.
            let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
        });
        loop {
            match receiver.recv_timeout(POLL_INTERVAL) {
                Ok(Ok(result)) => return Some(result),
                Ok(Err(panic)) => resume_unwind(panic),
                Err(RecvTimeoutError::Timeout) if !stop.load(Ordering::Relaxed) => {}
                // The other end sends before it is dropped, so that only a stop leads here.
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return None,
            }
        }
    }

    /// Computes the first samples of some points, each a point of a plan, in lockstep and each run once. Returns the
    /// runs of each point in the order of their numbers. Calls `finished` for each run. Returns `None` if `stop`
    /// becomes true before all runs have finished; runs in progress are then abandoned immediately.
    ///
    /// The runs of all these points are in one queue, so that workers and lanes are idle only at its end.
    pub fn sample(
        &self,
        points: &[(&Plan, u64)],
        stop: &AtomicBool,
        finished: &(dyn Fn(Label) + Sync),
    ) -> Option<Vec<Vec<RunRecord>>> {
        let run_ids = |&(plan, point_id): &(&Plan, u64)| {
            let point = plan.point(point_id);
            point.first_run..point.first_run + point.sampling.first
        };
        let of_point = |point| run_ids(point).map(|run_id| (point.0, run_id));
        let stop_condition = StopCondition::new(stop, &EngineOptions::default());
        let queue = RunQueue {
            runs: points.iter().flat_map(of_point).collect(),
            begun: AtomicU64::new(0),
            audits: false,
            stop_condition: &stop_condition,
            finished,
            disk: None,
        };
        let is_over = || stop.load(Ordering::Relaxed);
        let runs = with_grace_period(is_over, |cancellation| {
            self.install(|| self.compute(cancellation, &in_lockstep, &queue))
        });
        if runs.len() < queue.runs.len() {
            return None;
        }
        let mut runs = runs.into_iter();
        let take = |point| run_ids(point).map_while(|_| runs.next()).collect();
        Some(points.iter().map(take).collect())
    }

    /// Computes a batch and returns its finished runs in the order of the batch; must be called on this pool.
    pub(super) fn compute(
        &self,
        cancellation: &Cancellation,
        engine: &Engine<'_>,
        batch: &RunQueue<'_>,
    ) -> Vec<RunRecord> {
        let mut finished: Vec<(u64, RunRecord)> = (0..self.threads)
            .into_par_iter()
            .with_max_len(1)
            .flat_map_iter(|_| {
                let mut work = Worker::new(batch);
                let computed = cancellation.unless_cancelled(|| engine(&mut work));
                if computed.is_none() {
                    batch.stop_condition.abandon(work.in_progress());
                }
                work.finished
            })
            .collect();
        finished.sort_unstable_by_key(|(place, _)| *place);
        finished.into_iter().map(|(_, record)| record).collect()
    }
}
