//! Reads finished runs of a directory to which another process may be writing: all runs, or one.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Instant;

use super::{
    EngineError, EngineOptions, Parts, Planned, Progress, ProgressDisplay, RunTotals, Shard, Sink,
    Store, StoreError, run_study,
};
use crate::study::Study;
use crate::table::RunRecord;

/// Passes the finished runs of a study's shard and their points to `sink`. Computes no run, takes no lock, and changes
/// nothing in the directory. Chunks that another process finishes in the meantime are not read.
///
/// # Errors
/// Returns an error if the list of chunks cannot be read, if the worker threads cannot be started, or if the sink returns
/// one.
pub fn read_finished<S: Sink>(
    study: &Study,
    shard: Shard,
    directory: &Path,
    sink: &mut S,
) -> Result<RunTotals, EngineError<S::Error>> {
    let mut store = Store::open_shared(directory, study).map_err(EngineError::Store)?;
    // After the deadline no run begins, but stored runs are still read.
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let deadline = Some(Instant::now());
    let options = EngineOptions { threads, shard, deadline, ..EngineOptions::default() };
    let (study_name, runs) = (study.name(), shard.most_runs(study));
    let parts = Parts::Points(study.point_count());
    let planned = Planned { study: study_name, runs, at_most: true, parts };
    let progress = Progress::begin(planned, ProgressDisplay::Nothing);
    run_study(study, options, &AtomicBool::new(false), &progress, Some(&mut store), sink)
}

/// Returns a finished run of a directory; `None` if it is not among the finished runs. Takes no lock and changes nothing
/// in the directory.
///
/// # Errors
/// Returns [`StoreError::Unusable`] if the list of chunks cannot be read.
///
/// # Panics
/// If `run_id` is not below [`crate::study::Plan::run_count`].
pub fn finished_run(
    study: &Study,
    directory: &Path,
    run_id: u64,
) -> Result<Option<RunRecord>, StoreError> {
    let mut store = Store::open_shared(directory, study)?;
    let found = store.chunk_index.window(run_id, run_id).remove(&run_id);
    Ok(found.and_then(|found| found.of_run(study.planned_run(run_id))))
}
