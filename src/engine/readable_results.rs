//! The study of a directory of results, and the finished runs of a study that is running, was interrupted or was killed, with
//! their tables in a temporary directory.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Instant;

use tempfile::TempDir;

use super::command_error::CommandError;
use super::{
    EngineOptions, Parts, Planned, Progress, ProgressDisplay, RunTotals, Shard, Sink, Store,
    StoreError, listed_runs, run_study,
};
use crate::classification::MODEL_VERSION;
use crate::sanitize::{shell_word, shown_path};
use crate::study::Study;
use crate::table::{MANIFEST, Manifest, Results, ResultsError, RunRecord, VERSION, manifest_of};

const STUDY: &str = "study.yaml";
/// Other commands with directories of their own: a file, the command that writes it, and what reads the directory.
const OTHER_COMMANDS: [(&str, &str, &str); 4] = [
    (
        "evaluations.parquet",
        "optimize",
        "`stickslip report DIR` writes a page of the search, and `stickslip optimize STUDY --out DIR` continues it",
    ),
    ("equilibrium_set_summary.parquet", "equilibria", FIGURES),
    ("trajectory.parquet", "replay", FIGURES),
    ("identification.json", "identify", FIGURES),
];
const FIGURES: &str = "the Python package's `stickslip-figures DIR` draws its tables";

/// Returns the study and the manifest of a directory of results, finished or not, whose study file is unchanged.
///
/// # Errors
/// Returns an error if there are no results, if another version computed them, or if the study file was edited.
pub fn results_study(directory: &Path) -> Result<(Study, Manifest), CommandError> {
    let (study, manifest) = begun_study(directory)?;
    manifest.check_file(directory, STUDY)?;
    Ok((study, manifest))
}

/// Returns the study and the manifest of a directory of results to be continued. Parts of the study that do not
/// affect the runs may have been edited.
///
/// # Errors
/// Returns an error if there are no results, if another version computed them, or if the study has other runs.
pub fn begun_study(directory: &Path) -> Result<(Study, Manifest), CommandError> {
    let occupied = |reason: &str, found: String, allowed: String| {
        ResultsError::occupied(directory, reason, found, allowed)
    };
    if directory.is_file() {
        return Err(not_a_directory(directory));
    }
    if !directory.as_os_str().is_empty() && !directory.exists() {
        let what = format!("{}: this directory does not exist", shown_path(directory));
        return Err(CommandError::refusal(what, "no such directory", allowed_directory()));
    }
    let Some(manifest) = manifest_of(directory)? else {
        let reason = "this directory holds no results of `stickslip run`";
        let (found, allowed) =
            match OTHER_COMMANDS.iter().find(|(file, ..)| directory.join(file).exists()) {
                Some((file, command, reader)) => (
                    format!("{file}, which `stickslip {command}` writes, and no {MANIFEST}"),
                    format!(
                        "results of `stickslip run`; {}",
                        reader.replace("DIR", &shell_word(directory))
                    ),
                ),
                None => (format!("no {MANIFEST}"), allowed_directory()),
            };
        return Err(occupied(reason, found, allowed).into());
    };
    if manifest.model_version != MODEL_VERSION {
        let found = format!(
            "stickslip {}, version {} of the model (this is {VERSION} with version {MODEL_VERSION})",
            manifest.version, manifest.model_version,
        );
        let allowed = format!(
            "that version of the program; or `stickslip run {} --out DIR`, which computes all runs",
            shell_word(&directory.join(STUDY))
        );
        let reason = "these runs were computed by another version";
        return Err(occupied(reason, found, allowed).into());
    }
    let study = Study::load(&directory.join(STUDY))?;
    if study.hash() != manifest.study_hash {
        let found = format!("a study.yaml whose runs are not those of study {}", manifest.study);
        let allowed = format!(
            "the original study.yaml; or `stickslip run {} --out {}{}`, which \
             computes the new runs",
            shell_word(&directory.join(STUDY)),
            shell_word(directory),
            match manifest.shard.as_str() {
                "1/1" => String::new(),
                shard => format!(" --shard {shard}"),
            }
        );
        return Err(occupied("the study has been edited since the run", found, allowed).into());
    }
    Ok((study, manifest))
}

fn allowed_directory() -> String {
    "a directory that `stickslip run` has written to".to_owned()
}

/// Returns the error for a file in place of a directory of results.
fn not_a_directory(file: &Path) -> CommandError {
    let what = format!("{}: this is a file, not a directory of results", shown_path(file));
    match Study::load(file) {
        Ok(study) => {
            let directory = Path::new("results").join(study.name());
            let allowed = format!(
                "a directory of results; `stickslip run {}` computes this study first and writes {}",
                shell_word(file),
                shell_word(&directory)
            );
            CommandError::refusal(what, format!("the study {}", study.name()), allowed)
        }
        Err(_) => CommandError::refusal(what, "a file", allowed_directory()),
    }
}

/// Passes the finished runs of a study's shard and their points to `sink`. Computes no run, takes no lock, and changes
/// nothing in the directory. Chunks that another process finishes in the meantime are not read.
fn read_finished(
    study: &Study,
    shard: Shard,
    directory: &Path,
    sink: &mut dyn Sink,
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
