//! How a study is computed, and what stops it before all its runs have finished: signals, a time limit or failures. The first
//! Ctrl-C or SIGTERM lets runs finish for a second, the second one ends the program. A file size limit becomes a write error.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::Shard;
use super::message::say;
use crate::motion::Cancellation;

/// How a study is computed. No option changes a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EngineOptions {
    /// Number of worker threads; at least one is used.
    pub threads: usize,
    /// Number of runs in one part of a batch and in one chunk file; at least one.
    pub chunk: usize,
    /// The part of the study to compute.
    pub shard: Shard,
    /// The time from which no further run begins; runs in progress are abandoned a second later.
    pub deadline: Option<Instant>,
    /// The number of failed runs above which no further run begins; no limit if `None`.
    pub most_failed: Option<u64>,
    /// Whether failed runs are computed again, from the same case.
    pub retry_failed: bool,
}

impl Default for EngineOptions {
    /// Returns options for the whole study on one thread, without limits.
    fn default() -> Self {
        let (deadline, most_failed, retry_failed) = (None, None, false);
        EngineOptions {
            threads: 1,
            chunk: 1024,
            shard: Shard::WHOLE,
            deadline,
            most_failed,
            retry_failed,
        }
    }
}

/// Why a study stopped before all its runs were finished. Runs in progress were finished or, after a second,
/// abandoned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// Ctrl-C or a termination signal.
    Interrupted,
    /// The time limit.
    Time,
    /// More failed runs than allowed.
    Failures,
}

/// Decides when no further run begins, and when runs in progress are abandoned.
pub(super) struct StopCondition<'a> {
    interrupted: &'a AtomicBool,
    deadline: Option<Instant>,
    most_failed: Option<u64>,
    failed: AtomicU64,
    storage_failed: AtomicBool,
    abandoned: AtomicU64,
}

impl<'a> StopCondition<'a> {
    pub(super) fn new(interrupted: &'a AtomicBool, options: &EngineOptions) -> Self {
        let EngineOptions { deadline, most_failed, .. } = *options;
        let [failed, abandoned] = [AtomicU64::new(0), AtomicU64::new(0)];
        StopCondition {
            interrupted,
            deadline,
            most_failed,
            failed,
            storage_failed: AtomicBool::new(false),
            abandoned,
        }
    }

    /// Counts a failed run.
    pub(super) fn failed(&self) {
        self.failed.fetch_add(1, Ordering::Relaxed);
    }

    /// Stops the study because finished runs can no longer be stored.
    pub(super) fn stop_for_storage(&self) {
        self.storage_failed.store(true, Ordering::Relaxed);
    }

    /// Whether no further run may begin.
    pub(super) fn begins_no_run(&self) -> bool {
        self.storage_failed.load(Ordering::Relaxed) || self.reason().is_some()
    }

    /// Whether reading runs from disk stops, too.
    pub(super) fn stops_reading(&self) -> bool {
        self.storage_failed.load(Ordering::Relaxed) || self.interrupted.load(Ordering::Relaxed)
    }

    /// Whether to abandon runs in progress. Must be called repeatedly; `stopped` stores the time of the first reason to
    /// stop. Runs that cannot be stored are abandoned immediately.
    pub(super) fn abandons_runs(&self, stopped: &mut Option<Instant>) -> bool {
        if self.reason().is_some() {
            stopped.get_or_insert_with(Instant::now);
        }
        let waited = stopped.is_some_and(|since| since.elapsed() >= GRACE);
        waited || self.storage_failed.load(Ordering::Relaxed)
    }

    /// Counts runs that had begun and were abandoned.
    pub(super) fn abandon(&self, runs: u64) {
        self.abandoned.fetch_add(runs, Ordering::Relaxed);
    }

    /// Returns the number of abandoned runs.
    pub(super) fn abandoned(&self) -> u64 {
        self.abandoned.load(Ordering::Relaxed)
    }

    /// Returns the reason to stop, if any.
    pub(super) fn reason(&self) -> Option<StopReason> {
        let failed = self.failed.load(Ordering::Relaxed);
        if self.interrupted.load(Ordering::Relaxed) {
            Some(StopReason::Interrupted)
        } else if self.most_failed.is_some_and(|most| failed > most) {
            Some(StopReason::Failures)
        } else if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            Some(StopReason::Time)
        } else {
            None
        }
    }
}

/// The time that runs in progress have to finish when a study stops, before they are cancelled.
const GRACE: Duration = Duration::from_secs(1);
/// The interval between two checks of the grace period.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Runs `work` under a cancellation, which a separate thread triggers as soon as `is_over` returns true.
pub(super) fn with_grace_period<T>(
    mut is_over: impl FnMut() -> bool + Send,
    work: impl FnOnce(&Cancellation) -> T,
) -> T {
    let cancellation = Cancellation::default();
    thread::scope(|scope| {
        let (working, done) = channel::<()>();
        let to_cancel = cancellation.clone();
        let watch = move || {
            while done.recv_timeout(POLL_INTERVAL) == Err(RecvTimeoutError::Timeout) {
                if is_over() {
                    to_cancel.cancel();
                    return;
                }
            }
        };
        // If the watching thread cannot be started, runs in progress finish normally.
        let _watching = thread::Builder::new().spawn_scoped(scope, watch);
        let result = work(&cancellation);
        drop(working);
        result
    })
}

/// Exit code after an interruption.
const INTERRUPTED: i32 = 130;

/// Returns a flag that Ctrl-C and SIGTERM set; a second signal ends the program with exit code 130. Warns if the operating system
/// refuses the handlers.
pub fn stop_on_signals() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // The order matters: only the second signal may find the flag set.
        let handled = flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&stop))
            .and_then(|_| flag::register(signal, Arc::clone(&stop)));
        if let Err(error) = handled {
            say(&format!("warning: cannot handle Ctrl-C: {error}"));
        }
    }
    stop
}

/// Makes a write above the file size limit (`ulimit -f`) fail like one to a full disk. By default its signal,
/// SIGXFSZ, ends the program without a message.
///
/// # Errors
/// Returns an error if the operating system refuses the handler.
pub fn survive_file_size_limit() -> io::Result<()> {
    #[cfg(unix)]
    flag::register(signal_hook::consts::SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
    Ok(())
}
