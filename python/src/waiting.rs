//! Work in a thread of its own, while Python's other threads go on and Ctrl-C is looked for.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often signals are looked for.
const LOOK: Duration = Duration::from_millis(20);
/// How long work that was interrupted is waited for. It goes on in its thread until the runs that have begun
/// are finished or given up, about a second, and until tables are written.
const PATIENCE: Duration = Duration::from_millis(700);

/// Does work and gives what comes out. When Python is interrupted, `work` finds its flag set.
///
/// # Errors
/// What a signal's handler has raised, mostly `KeyboardInterrupt`; a `RuntimeError` where the work panicked.
pub fn wait<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, mut receiver) = sync_channel(1);
    let flag = Arc::clone(&stop);
    thread::Builder::new().name("stickslip".to_owned()).spawn(move || {
        // What outlives the unwinding is the flag alone.
        let done = catch_unwind(AssertUnwindSafe(|| work(&flag)));
        // Nobody takes it where Python was interrupted.
        let _ = sender.send(done);
    })?;
    loop {
        match py.detach(|| receive(&mut receiver, LOOK)) {
            Ok(Ok(done)) => return Ok(done),
            Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => {
                let text = "the program failed: a defect of stickslip; standard error says where";
                return Err(PyRuntimeError::new_err(text));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(interrupt) = py.check_signals() {
            stop.store(true, Ordering::Relaxed);
            // Whatever it is, it is not wanted any more.
            let _ = py.detach(|| receive(&mut receiver, PATIENCE));
            return Err(interrupt);
        }
    }
}

/// Receives through a unique borrow, which another thread may hold where a shared one may not.
fn receive<T>(receiver: &mut Receiver<T>, most: Duration) -> Result<T, RecvTimeoutError> {
    receiver.recv_timeout(most)
}
