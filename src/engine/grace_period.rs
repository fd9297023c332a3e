//! The grace period of runs in progress when a study stops.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use crate::motion::Cancellation;

/// The time that runs in progress have to finish when a study stops, before they are cancelled.
pub(super) const GRACE: Duration = Duration::from_secs(1);
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
