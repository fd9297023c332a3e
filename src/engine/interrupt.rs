//! Ctrl-C and termination: wait a second for what is running and keep what is finished; the second time, stop at
//! once. And a limit of the size of files, which is an error of what is written and not the end of the program.

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

/// Makes a write beyond the limit of the size of files (`ulimit -f`) an error like that of a full disk; by default
/// its signal, SIGXFSZ, ends the program without a word.
///
/// # Errors
/// Where the operating system refuses.
pub fn survive_file_size_limit() -> io::Result<()> {
    #[cfg(unix)]
    flag::register(signal_hook::consts::SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
    Ok(())
}
