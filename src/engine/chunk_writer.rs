//! Writes finished runs to disk: collects them for a few seconds and writes them as a chunk from a separate
//! thread, so that no worker waits for the disk.

use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use super::stop::StopCondition;
use super::store::{Folder, NewResult, StoreError};

/// The longest time before a finished run is written.
const MAX_WAIT: Duration = Duration::from_secs(3);
/// The largest number of runs that wait for the disk; above it workers wait, too.
const WAITING: usize = 16_384;

/// The time between two looks for finished runs while a chunk is collected. A thread that waits inside the channel is woken
/// for each run, which costs the worker a system call per run.
const PAUSE: Duration = Duration::from_millis(2);

/// Creates the channel from the workers to the writer.
pub(super) fn new_results() -> (SyncSender<NewResult>, Receiver<NewResult>) {
    sync_channel(WAITING)
}

/// Writes the received runs until all senders are gone: one chunk per `chunk` runs, or earlier when `MAX_WAIT` has
/// passed.
pub(super) fn write_chunks(
    output: &mut Folder,
    finished: &Receiver<NewResult>,
    chunk: usize,
    stop_condition: &StopCondition<'_>,
) -> Result<(), StoreError> {
    let mut written = Ok(());
    let mut open = true;
    while open {
        let mut runs = Vec::new();
        let mut due = None;
        while runs.len() < chunk.max(1) {
            match next(finished, due) {
                Ok(run) => {
                    due = due.or_else(|| Instant::now().checked_add(MAX_WAIT));
                    runs.push(run);
                }
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => {
                    open = false;
                    break;
                }
            }
        }
        runs.sort_unstable_by_key(|run: &NewResult| run.run_id);
        if written.is_ok() && !runs.is_empty() {
            written = output.append(&runs);
            if written.is_err() {
                stop_condition.stop_for_storage();
            }
        }
    }
    written
}

/// Waits for the next finished run: without a limit for the first one of a chunk, and until the chunk is due for the
/// others.
fn next(
    finished: &Receiver<NewResult>,
    due: Option<Instant>,
) -> Result<NewResult, RecvTimeoutError> {
    let Some(due) = due else {
        return finished.recv().map_err(|_| RecvTimeoutError::Disconnected);
    };
    loop {
        match finished.try_recv() {
            Ok(run) => return Ok(run),
            Err(TryRecvError::Disconnected) => return Err(RecvTimeoutError::Disconnected),
            Err(TryRecvError::Empty) if Instant::now() >= due => {
                return Err(RecvTimeoutError::Timeout);
            }
            // Sleeping costs this thread at most `PAUSE` per chunk; waiting in the channel costs the workers more (`PAUSE`).
            Err(TryRecvError::Empty) => thread::sleep(PAUSE),
        }
    }
}
