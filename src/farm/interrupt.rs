//! Ctrl-C and termination: finish what is running and keep it; the second time, stop at once.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Exit code after an interruption.
const INTERRUPTED: i32 = 130;

/// A flag that Ctrl-C and SIGTERM set; when they come again the program ends with exit code 130.
///
/// # Errors
/// Where the operating system refuses.
pub fn stop_on_signals() -> io::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // The order matters: the second signal must find the flag set by the first.
        flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&stop))?;
        flag::register(signal, Arc::clone(&stop))?;
    }
    Ok(stop)
}
