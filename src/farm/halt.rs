//! When a farm stops before all its runs are finished.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use super::FarmOptions;

/// Why a farm stopped before all its runs were finished. Runs in progress were finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// It was asked to: Ctrl-C, or a signal to terminate.
    Asked,
    /// The time that it may take was over.
    Time,
    /// More runs failed than may.
    Failures,
}

/// Says when to begin no further run.
pub(super) struct Halt<'a> {
    asked: &'a AtomicBool,
    deadline: Option<Instant>,
    most_failed: Option<u64>,
    failed: AtomicU64,
    broken: AtomicBool,
}

impl<'a> Halt<'a> {
    pub(super) fn new(asked: &'a AtomicBool, options: &FarmOptions) -> Self {
        let FarmOptions { deadline, most_failed, .. } = *options;
        let (failed, broken) = (AtomicU64::new(0), AtomicBool::new(false));
        Halt { asked, deadline, most_failed, failed, broken }
    }

    /// Counts a failed run.
    pub(super) fn failed(&self) {
        self.failed.fetch_add(1, Ordering::Relaxed);
    }

    /// Nothing can be kept any more: going on would be in vain.
    pub(super) fn break_off(&self) {
        self.broken.store(true, Ordering::Relaxed);
    }

    /// Whether to stop.
    pub(super) fn now(&self) -> bool {
        self.broken.load(Ordering::Relaxed) || self.reason().is_some()
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
