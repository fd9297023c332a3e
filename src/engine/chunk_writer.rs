//! Writes finished runs to disk: collects them for a few seconds and writes them as a chunk from a separate
//! thread, so that no worker waits for the disk.

use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use super::stop::StopCondition;
use super::store::{ChunkAppender, NewResult, StoreError};

/// The longest time before a finished run is written.
const MAX_WAIT: Duration = Duration::from_secs(3);
/// The largest number of runs that wait for the disk; above it workers wait, too.
const WAITING: usize = 16_384;

/// Creates the channel from the workers to the writer.
pub(super) fn new_results() -> (SyncSender<NewResult>, Receiver<NewResult>) {
    sync_channel(WAITING)
}

/// Writes the received runs until all senders are gone: one chunk per `chunk` runs, or earlier when `MAX_WAIT` has
/// passed.
///
/// # Errors
/// Returns an error if a chunk cannot be written; the study then stops.
pub(super) fn write_chunks(
    appender: &mut ChunkAppender,
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
            let left = due.map_or(Duration::MAX, |due: Instant| {
                due.saturating_duration_since(Instant::now())
            });
            match finished.recv_timeout(left) {
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
            written = appender.append(&runs);
            if written.is_err() {
                stop_condition.stop_for_storage();
            }
        }
    }
    written
}
