//! How long runs in progress are waited for when they are to stop.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use crate::motion::Cancellation;

/// How long runs in progress may go on when a study stops; they are then given up.
pub(super) const GRACE: Duration = Duration::from_secs(1);
/// How often it is asked whether patience is over.
const LOOK: Duration = Duration::from_millis(20);

/// Does `work` under a cancellation that is cancelled as soon as `is_over` says so, which a thread of its own asks
/// now and then until `work` is done.
pub(super) fn with_patience<T>(
    mut is_over: impl FnMut() -> bool + Send,
    work: impl FnOnce(&Cancellation) -> T,
) -> T {
    let cancellation = Cancellation::default();
    thread::scope(|scope| {
        let (working, done) = channel::<()>();
        let to_cancel = cancellation.clone();
        let watch = move || {
            while done.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                if is_over() {
                    to_cancel.cancel();
                    return;
                }
            }
        };
        // Where no thread can be had, runs in progress are finished.
        let _watching = thread::Builder::new().spawn_scoped(scope, watch);
        let result = work(&cancellation);
        drop(working);
        result
    })
}
