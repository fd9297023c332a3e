//! When a study stops before all its runs are finished.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use super::EngineOptions;
use super::patience::GRACE;

/// Why a study stopped before all its runs were finished. Runs in progress were finished, or given up after a
/// second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// It was asked to: Ctrl-C, or a signal to terminate.
    Asked,
    /// The time that it may take was over.
    Time,
    /// More runs failed than may.
    Failures,
}

/// Says when to begin no further run, and when to give up those in progress.
pub(super) struct StopCondition<'a> {
    asked: &'a AtomicBool,
    deadline: Option<Instant>,
    most_failed: Option<u64>,
    failed: AtomicU64,
    broken: AtomicBool,
    given_up: AtomicU64,
}

impl<'a> StopCondition<'a> {
    pub(super) fn new(asked: &'a AtomicBool, options: &EngineOptions) -> Self {
        let EngineOptions { deadline, most_failed, .. } = *options;
        let [failed, given_up] = [AtomicU64::new(0), AtomicU64::new(0)];
        StopCondition {
            asked,
            deadline,
            most_failed,
            failed,
            broken: AtomicBool::new(false),
            given_up,
        }
    }

    /// Counts a failed run.
    pub(super) fn failed(&self) {
        self.failed.fetch_add(1, Ordering::Relaxed);
    }

    /// Nothing can be kept any more: going on would be in vain.
    pub(super) fn break_off(&self) {
        self.broken.store(true, Ordering::Relaxed);
    }

    /// Whether to compute no further run.
    pub(super) fn now(&self) -> bool {
        self.broken.load(Ordering::Relaxed) || self.reason().is_some()
    }

    /// Whether not even to go on with runs that are on disk, which takes no time worth the name.
    pub(super) fn at_once(&self) -> bool {
        self.broken.load(Ordering::Relaxed) || self.asked.load(Ordering::Relaxed)
    }

    /// Whether to give up runs in progress, where `stopped` is when this first had a reason to stop; to be asked
    /// again and again. What cannot be kept is not waited for.
    pub(super) fn gives_up(&self, stopped: &mut Option<Instant>) -> bool {
        if self.reason().is_some() {
            stopped.get_or_insert_with(Instant::now);
        }
        let waited = stopped.is_some_and(|since| since.elapsed() >= GRACE);
        waited || self.broken.load(Ordering::Relaxed)
    }

    /// Counts runs that had begun and were given up.
    pub(super) fn gave_up(&self, runs: u64) {
        self.given_up.fetch_add(runs, Ordering::Relaxed);
    }

    /// How many runs were given up.
    pub(super) fn given_up(&self) -> u64 {
        self.given_up.load(Ordering::Relaxed)
    }

    /// Why to stop.
    pub(super) fn reason(&self) -> Option<StopReason> {
        let failed = self.failed.load(Ordering::Relaxed);
        if self.asked.load(Ordering::Relaxed) {
            Some(StopReason::Asked)
        } else if self.most_failed.is_some_and(|most| failed > most) {
            Some(StopReason::Failures)
        } else if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            Some(StopReason::Time)
        } else {
            None
        }
    }
}
