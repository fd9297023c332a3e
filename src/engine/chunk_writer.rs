//! Finished runs on their way to the disk: collected for a few seconds, then written as a chunk by a
//! thread of its own, so that no worker waits for the disk.

use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use super::stop::StopCondition;
use super::store::{ChunkAppender, NewResult, StoreError};

/// How long a finished run waits at most before it is written.
const LONGEST: Duration = Duration::from_secs(3);
/// Runs that may wait for the disk; then workers wait, too.
const WAITING: usize = 16_384;

/// Where workers put finished runs, and where they are taken from.
pub(super) fn new_results() -> (SyncSender<NewResult>, Receiver<NewResult>) {
    sync_channel(WAITING)
}

/// Writes what comes, so many runs in a chunk if that does not take too long, until nobody is left who
/// could send.
///
/// # Errors
/// Where a chunk cannot be written; the study is then broken off.
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
                    due = due.or_else(|| Instant::now().checked_add(LONGEST));
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
                stop_condition.break_off();
            }
        }
    }
    written
}
