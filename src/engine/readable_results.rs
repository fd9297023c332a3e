//! The tables of a study that is running, was interrupted or was killed: from its finished runs, in a temporary directory.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::command_error::CommandError;
use super::results_study::results_study;
use super::{Shard, listed_runs, read_finished};
use crate::sanitize::shell_word;
use crate::study::Study;
use crate::table::{Circumstances, Manifest, Results, ResultsError};

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
    read_finished(study, shard, directory, &mut results)?;
    let circumstances = Circumstances {
        shard: manifest.shard.clone(),
        runs_planned: manifest.runs_planned,
        started_unix_s: manifest.started_unix_s,
        threads: manifest.threads,
        merging: manifest.merging.clone(),
        ..Circumstances::default()
    };
    let mut written = results.finish(study, circumstances)?;
    written.host.clone_from(&manifest.host);
    written.computed_by.clone_from(&manifest.computed_by);
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
