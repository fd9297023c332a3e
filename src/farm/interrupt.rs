//! Ctrl-C and termination: finish what is running and keep it; the second time, stop at once.

use std::sync::atomic::{AtomicBool, Ordering};

/// Makes Ctrl-C, SIGTERM and SIGHUP set `stop`, and exit with code 130 when they come again.
///
/// # Errors
/// Where the operating system refuses, or this has been called before.
pub fn stop_on_signals(stop: &'static AtomicBool) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || {
        if stop.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
}
