//! Worker threads that stay: they compute one sample of runs after another, for whoever asks.
//!
//! Unlike a farm, a crew keeps nothing on disk, computes no run a second time and knows no precision.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

use super::compute::{Engine, InLockstep};
use super::patience::with_patience;
use crate::ending::{Evidence, Label, Outcome, Runs};
use crate::model::Case;
use crate::motion::{Cancellation, VectorLevel};
use crate::study::{PlannedRun, Study};

/// Worker threads.
pub struct Crew {
    pool: rayon::ThreadPool,
    threads: usize,
}

impl Crew {
    /// So many threads; one at least.
    ///
    /// # Errors
    /// Where they cannot be started.
    pub fn new(threads: usize) -> Result<Crew, rayon::ThreadPoolBuildError> {
        let threads = threads.max(1);
        Ok(Crew { pool: rayon::ThreadPoolBuilder::new().num_threads(threads).build()?, threads })
    }

    /// Calls `work` on one of the threads: what it does in parallel it does on them.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.pool.install(work)
    }

    /// All runs of a point in the order of their numbers, each told to `finished` as it ends; none where
    /// `stop` became true before all of them had ended. A panic in a run is that run's failure.
    pub fn point(
        &self,
        study: &Study,
        point_id: u64,
        stop: &AtomicBool,
        finished: &(dyn Fn(Label) + Sync),
    ) -> Option<Vec<(PlannedRun, Outcome)>> {
        let point = study.point(point_id);
        let (first, end) = (point.first_run, point.first_run + point.sampling.first);
        let next = AtomicU64::new(first);
        let share = |cancellation: &Cancellation| {
            let (open, done) = (HashMap::new(), Vec::new());
            let mut share = Share { study, end, next: &next, stop, finished, open, done };
            // Where it was cancelled, runs are missing in the end.
            let engine = InLockstep(VectorLevel::best());
            let _ = cancellation.unless_cancelled(|| engine.compute(&mut share));
            share.done
        };
        let in_parallel = |cancellation: &Cancellation| {
            let shares = (0..self.threads).into_par_iter().with_max_len(1);
            shares.flat_map_iter(|_| share(cancellation)).collect()
        };
        let is_over = || stop.load(Ordering::Relaxed);
        // Parts of a sample are of no use: nothing is waited for.
        let mut runs: Vec<(PlannedRun, Outcome)> =
            with_patience(is_over, |cancellation| self.pool.install(|| in_parallel(cancellation)));
        runs.sort_unstable_by_key(|(planned, _)| planned.run_id);
        (runs.len() as u64 == end - first).then_some(runs)
    }
}

/// The runs of one worker.
struct Share<'a> {
    study: &'a Study,
    end: u64,
    next: &'a AtomicU64,
    stop: &'a AtomicBool,
    finished: &'a (dyn Fn(Label) + Sync),
    open: HashMap<u64, PlannedRun>,
    done: Vec<(PlannedRun, Outcome)>,
}

impl Share<'_> {
    fn finish(&mut self, planned: PlannedRun, outcome: Outcome) {
        (self.finished)(outcome.label());
        self.done.push((planned, outcome));
    }
}

impl Runs for Share<'_> {
    fn next(&mut self) -> Option<(u64, Case)> {
        loop {
            if self.stop.load(Ordering::Relaxed) {
                return None;
            }
            let run_id = self.next.fetch_add(1, Ordering::Relaxed);
            if run_id >= self.end {
                return None;
            }
            let planned = self.study.planned_run(run_id);
            match planned.case.clone() {
                Ok(case) => {
                    self.open.insert(run_id, planned);
                    return Some((run_id, case));
                }
                Err(invalid) => {
                    let failed = Outcome::failed(Evidence::InvalidParameters, invalid.to_string());
                    self.finish(planned, failed);
                }
            }
        }
    }

    fn ended(&mut self, number: u64, outcome: Outcome) {
        if let Some(planned) = self.open.remove(&number) {
            self.finish(planned, outcome);
        }
    }
}
