//! Worker threads that share queues of runs: each takes runs from a queue, plans them and finishes them.

use std::collections::{HashMap, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, SyncSender, channel};
use std::time::Duration;

use rayon::prelude::*;

use super::EngineOptions;
use super::compute::{Engine, in_lockstep};
use super::stop::{StopCondition, with_grace_period};
use super::store::{CaseKey, NewResult, ResultCache, StoredOutcome, StoredResult};
use crate::classification::{Evidence, Label, Outcome, Runs};
use crate::model::Case;
use crate::motion::Cancellation;
use crate::study::{Plan, PlannedRun};
use crate::table::RunRecord;

/// A batch of runs that the workers share.
pub(super) struct RunQueue<'a> {
    /// The runs: each has a plan, and a number in it.
    pub(super) runs: Vec<(&'a Plan, u64)>,
    /// Number of runs that have begun.
    pub(super) begun: AtomicU64,
    pub(super) stop_condition: &'a StopCondition<'a>,
    /// Whether audited runs are computed a second time.
    pub(super) audits: bool,
    /// Called for each computed run.
    pub(super) finished: &'a (dyn Fn(Label) + Sync),
    pub(super) disk: Option<Storage<'a>>,
}

/// The finished runs on disk, and the channel for new ones.
#[derive(Clone)]
pub(super) struct Storage<'a> {
    /// Finished runs of this study, by number.
    pub(super) found: &'a HashMap<u64, StoredResult>,
    /// Called for each run that need not be computed.
    pub(super) reused: &'a (dyn Fn(Label) + Sync),
    /// Finished runs of other studies, by case.
    pub(super) result_cache: &'a ResultCache,
    /// Whether failed runs are computed again.
    pub(super) retry_failed: bool,
    /// Channel for runs that are not in the output directory.
    pub(super) new_results: SyncSender<NewResult>,
    /// Number of runs that did not have to be computed.
    pub(super) reused_count: &'a AtomicU64,
}

/// The part of a batch that one worker computes.
pub(super) struct Worker<'a> {
    batch: &'a RunQueue<'a>,
    disk: Option<Storage<'a>>,
    /// Second computations of audited runs that have not begun.
    again: VecDeque<(u64, Case)>,
    open: HashMap<u64, Incomplete>,
    /// Finished runs with their places in the batch, in any order.
    pub(super) finished: Vec<(u64, RunRecord)>,
}

/// A run whose result is incomplete.
struct Incomplete {
    planned: PlannedRun,
    outcome: Option<Outcome>,
    again: Option<Evidence>,
}

impl<'a> Worker<'a> {
    pub(super) fn new(batch: &'a RunQueue<'a>) -> Self {
        let disk = batch.disk.clone();
        Worker { batch, disk, again: VecDeque::new(), open: HashMap::new(), finished: Vec::new() }
    }

    /// Returns the number of runs that have begun and not finished.
    pub(super) fn in_progress(&self) -> u64 {
        self.open.len() as u64
    }

    /// Takes a run from disk if it is stored with everything that its plan requires; otherwise returns the plan.
    fn take_stored(&mut self, place: u64, planned: PlannedRun) -> Option<PlannedRun> {
        let Some(disk) = &self.disk else { return Some(planned) };
        let key = CaseKey::of(&planned);
        let found = disk.found.get(&planned.run_id).filter(|found| found.key == key);
        let in_output = found.is_some_and(|found| found.in_output);
        let content =
            found.map(|found| found.content.clone()).or_else(|| disk.result_cache.find(key));
        let finished = content.and_then(|content| StoredOutcome::decode(&content, &planned));
        let usable =
            finished.filter(|found| !disk.retry_failed || found.outcome.label() != Label::Failed);
        let Some(StoredOutcome { outcome, audit }) = usable else { return Some(planned) };
        disk.reused_count.fetch_add(1, Ordering::Relaxed);
        (disk.reused)(outcome.label());
        let record = RunRecord { planned, outcome, audit };
        self.finish(place, record, (!in_output).then_some(key));
        None
    }

    /// Adds a finished run to the result and, if it has a key, sends it to the disk.
    fn finish(&mut self, place: u64, record: RunRecord, key: Option<CaseKey>) {
        if record.outcome.label() == Label::Failed {
            self.batch.stop_condition.failed();
        }
        if let (Some(disk), Some(key)) = (&self.disk, key) {
            let result = NewResult {
                run_id: record.planned.run_id,
                key,
                content: StoredOutcome::encode(&record),
            };
            // A closed channel means that the disk failed, which is reported at the end.
            let _ = disk.new_results.send(result);
        }
        self.finished.push((place, record));
    }

    /// Adds a result of a run, and finishes the run when all its results are present.
    fn add_result(&mut self, place: u64, open: Incomplete) {
        let Incomplete { planned, outcome, again } = open;
        let complete = !planned.audited || again.is_some();
        let (Some(outcome), true) = (&outcome, complete) else {
            self.open.insert(place, Incomplete { planned, outcome, again });
            return;
        };
        (self.batch.finished)(outcome.label());
        let record = RunRecord { planned, outcome: outcome.clone(), audit: again };
        let key = self.disk.is_some().then(|| CaseKey::of(&record.planned));
        self.finish(place, record, key);
    }
}

/// Each place in the batch has two numbers: one for the run and one for its second computation.
impl Runs for Worker<'_> {
    fn next(&mut self) -> Option<(u64, Case)> {
        if let Some(again) = self.again.pop_front() {
            return Some(again);
        }
        loop {
            if self.batch.stop_condition.stops_reading() {
                return None;
            }
            let place = self.batch.begun.fetch_add(1, Ordering::Relaxed);
            let (study, run_id) = *self.batch.runs.get(usize::try_from(place).ok()?)?;
            let mut planned = study.planned_run(run_id);
            planned.audited &= self.batch.audits;
            let Some(planned) = self.take_stored(place, planned) else { continue };
            if self.batch.stop_condition.begins_no_run() {
                continue;
            }
            match &planned.case {
                Ok(case) => {
                    let case = case.clone();
                    if planned.audited {
                        let simulation = case.simulation.counter_check();
                        self.again.push_back((2 * place + 1, Case { simulation, ..case.clone() }));
                    }
                    self.open.insert(place, Incomplete { planned, outcome: None, again: None });
                    return Some((2 * place, case));
                }
                Err(invalid) => {
                    let evidence = Evidence::InvalidParameters(invalid.to_string());
                    let again = planned.audited.then(|| evidence.clone());
                    let outcome = Some(Outcome::of(evidence));
                    self.add_result(place, Incomplete { planned, outcome, again });
                }
            }
        }
    }

    fn ended(&mut self, number: u64, outcome: Outcome) {
        let place = number / 2;
        let Some(mut open) = self.open.remove(&place) else { return };
        if number.is_multiple_of(2) {
            open.outcome = Some(outcome);
        } else {
            open.again = Some(outcome.evidence);
        }
        self.add_result(place, open);
    }
}

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
