//! Runs a computation in a separate thread, while other Python threads run and Ctrl-C is handled.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::progress::Bars;

/// The interval at which signals are checked.
const LOOK: Duration = Duration::from_millis(20);
/// The time to wait for an interrupted computation. It continues in its thread until the current
/// runs have finished or stopped, about a second, and until tables are written.
const PATIENCE: Duration = Duration::from_millis(700);

/// Runs a computation and returns its result. On an interruption, the flag of `work` is set.
///
/// # Errors
/// Returns the exception of a signal handler, usually `KeyboardInterrupt`, and a `RuntimeError` if
/// the computation panics.
pub fn wait<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
    wait_with(py, &Bars::none(), work)
}

/// Runs a computation like [`wait`], and draws its progress.
///
/// # Errors
/// Returns the errors of [`wait`] and the exceptions of the bars.
pub fn wait_with<T: Send + 'static>(
    py: Python<'_>,
    bars: &Bars,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, mut receiver) = sync_channel(1);
    let flag = Arc::clone(&stop);
    thread::Builder::new().name("stickslip".to_owned()).spawn(move || {
        // Only the flag survives the unwinding.
        let done = catch_unwind(AssertUnwindSafe(|| work(&flag)));
        // Sending fails if an interruption has dropped the receiver.
        let _ = sender.send(done);
    })?;
    loop {
        match py.detach(|| receive(&mut receiver, LOOK)) {
            Ok(Ok(done)) => {
                bars.close(py)?;
                return Ok(done);
            }
            Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => {
                let text = "the program failed: a defect of stickslip; standard error says where";
                return Err(PyRuntimeError::new_err(text));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        // A signal handler may also run in the Python code that draws.
        if let Err(interrupt) = bars.draw(py).and_then(|()| py.check_signals()) {
            stop.store(true, Ordering::Relaxed);
            // The result is no longer wanted.
            let _ = py.detach(|| receive(&mut receiver, PATIENCE));
            return Err(interrupt);
        }
    }
}

/// Receives through a unique borrow, which another thread may hold, unlike a shared borrow.
fn receive<T>(receiver: &mut Receiver<T>, most: Duration) -> Result<T, RecvTimeoutError> {
    receiver.recv_timeout(most)
}
