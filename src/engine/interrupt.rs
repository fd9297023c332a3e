//! Signals: the first Ctrl-C or SIGTERM lets runs finish for a second, the second one ends the program. A file size
//! limit becomes a write error.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::message::say;

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
