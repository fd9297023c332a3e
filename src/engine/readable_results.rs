//! The finished runs of a study that is running, was interrupted or was killed, and their tables in a temporary
//! directory.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Instant;

use tempfile::TempDir;

use super::command_error::CommandError;
use super::results_study::results_study;
use super::{
    EngineOptions, Parts, Planned, Progress, ProgressDisplay, RunTotals, Shard, Sink, Store,
    StoreError, listed_runs, run_study,
};
use crate::sanitize::shell_word;
use crate::study::Study;
use crate::table::{Manifest, Results, ResultsError, RunRecord};

/// Passes the finished runs of a study's shard and their points to `sink`. Computes no run, takes no lock, and changes
/// nothing in the directory. Chunks that another process finishes in the meantime are not read.
fn read_finished(
    study: &Study,
    shard: Shard,
    directory: &Path,
    sink: &mut impl Sink,
) -> Result<RunTotals, CommandError> {
    let mut store = Store::open_shared(directory, study)?;
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

/// Results with tables.
pub struct ReadableResults {
    /// The study.
    pub study: Study,
    /// The manifest of the tables.
    pub manifest: Manifest,
    /// The directory of the tables: the directory of the results, or a temporary one.
    pub tables: PathBuf,
    /// Removes the temporary directory at the end.
    temporary: Option<TempDir>,
}

impl ReadableResults {
    /// Returns the results of a study that has just been run into a directory.
    pub fn finished(study: Study, manifest: Manifest, directory: &Path) -> Self {
        ReadableResults { study, manifest, tables: directory.to_owned(), temporary: None }
    }

    /// Whether the tables are temporary, because the study is running or was killed.
    pub fn is_from_chunks(&self) -> bool {
        self.temporary.is_some()
    }
}

/// Opens a directory of results. If it holds more finished runs than its tables, because the study is running or was
/// killed, writes temporary tables of all finished runs. Neither takes the lock of the directory nor changes it.
///
/// # Errors
/// Returns an error if the directory holds no readable results, or if temporary tables cannot be written.
pub fn readable_results(directory: &Path) -> Result<ReadableResults, CommandError> {
    let (study, manifest) = results_study(directory)?;
    let finished = ReadableResults::finished(study, manifest, directory);
    let ReadableResults { study, manifest, .. } = &finished;
    let has_tables = !manifest.files.is_empty();
    let is_current =
        || Ok::<_, CommandError>(listed_runs(directory, study)? <= manifest.runs_finished);
    if has_tables && (manifest.complete || is_current()?) {
        return Ok(finished);
    }
    let temporary = tempfile::Builder::new().prefix("stickslip-").tempdir();
    let temporary = temporary.map_err(ResultsError::unusable(&std::env::temp_dir()))?;
    let tables = temporary.path().join("results");
    let shard = manifest.shard.parse::<Shard>().map_err(|error| {
        CommandError::Usage(format!("{}: `shard` of manifest.json: {error}", directory.display()))
    })?;
    let mut results = Results::create(&tables, study)?;
    let totals = read_finished(study, shard, directory, &mut results.tables)?;
    let read = Manifest::begin(study, shard).with_runs(totals.counts, &totals.failures);
    let written = results.finish(Manifest {
        runs_planned: manifest.runs_planned,
        started_unix_s: manifest.started_unix_s,
        threads: manifest.threads,
        merging: manifest.merging.clone(),
        host: manifest.host.clone(),
        computed_by: manifest.computed_by.clone(),
        ..read
    })?;
    let ReadableResults { study, .. } = finished;
    Ok(ReadableResults { study, manifest: written, tables, temporary: Some(temporary) })
}

/// Returns how to continue a study that is not complete, in brackets.
pub fn how_to_continue(results: &ReadableResults, directory: &Path) -> String {
    let resume = format!("`stickslip resume {}` continues", shell_word(directory));
    match results.is_from_chunks() {
        true => format!("this study is running or was interrupted; if it is not running, {resume}"),
        false => resume,
    }
}
