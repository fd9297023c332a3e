//! The state of an output directory before a run. A file counts as a result only if it is, byte for
//! byte, what stickslip has written or would write.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::durable_files::final_name;
use super::file_entry::{FileEntry, has_content, short_hash};
use super::manifest::{MANIFEST, Manifest};
use super::provenance::{FORMAT, VERSION};
use super::results::{DATA_FILES, ResultsError, STUDY};
use crate::classification::MODEL_VERSION;
use crate::sanitize::one_line;
use crate::study::Study;

/// The largest number of characters of a finding that are shown.
const LONGEST_FOUND: usize = 400;

/// The state of an output directory before a run.
#[derive(Debug)]
pub enum OutputState {
    /// Contains nothing that would be replaced: the study can run.
    Unused,
    /// Contains result files without a manifest, which do not name their study.
    WithoutManifest,
    /// Contains incomplete results of this study and shard, which can be resumed.
    Incomplete(Box<Manifest>),
    /// Contains all results of this study and shard.
    Complete(Box<Manifest>),
    /// Contains results of this study and shard whose files differ from the manifest, with a
    /// description of the difference.
    Changed(Box<Manifest>, String),
    /// Contains results of another study, or of this study by another version of the program.
    OtherStudy(Box<Manifest>),
}

/// Reads the manifest of an output directory, if there is one.
///
/// # Errors
/// Returns [`ResultsError::Occupied`] if the manifest is damaged or foreign, and
/// [`ResultsError::Unusable`] if it cannot be read.
pub fn manifest_of(directory: &Path) -> Result<Option<Manifest>, ResultsError> {
    Manifest::read(directory).map_err(|cause| match cause.kind() {
        io::ErrorKind::InvalidData => ResultsError::occupied(
            directory,
            format!("{MANIFEST} is damaged, or is not a manifest of stickslip"),
            one_line(&cause.to_string(), LONGEST_FOUND),
            format!(
                "another directory, with --out DIR; or, if these are results of a study, remove \
                 {MANIFEST} and run the study again, which reuses the finished runs"
            ),
        ),
        _ => ResultsError::Unusable { path: directory.to_owned(), cause },
    })
}

/// Inspects an output directory and refuses it if its files are not results, or are results of
/// another shard. `ours` lists names of folders that may exist beside the tables. Changes nothing.
///
/// # Errors
/// Returns [`ResultsError::Occupied`] or [`ResultsError::Unusable`].
pub fn inspect(
    directory: &Path,
    study: &Study,
    shard: &str,
    ours: &[&str],
) -> Result<OutputState, ResultsError> {
    check_path(directory)?;
    let unusable = ResultsError::unusable(directory);
    let Some(manifest) = manifest_of(directory)? else {
        return without_manifest(directory, study, ours);
    };
    if manifest.shard != shard {
        let reason = "this directory holds the results of another shard";
        let found = format!(
            "study {}, hash {}, shard {} (this one: {}, hash {}, shard {shard})",
            manifest.study,
            short_hash(&manifest.study_hash),
            manifest.shard,
            study.name(),
            short_hash(&study.hash()),
        );
        return Err(occupied(directory, reason, &found));
    }
    let manifest = Box::new(manifest);
    let same_layout = (manifest.version.as_str(), manifest.format) == (VERSION, FORMAT);
    if manifest.study_hash != study.hash() || manifest.model_version != MODEL_VERSION {
        return Ok(OutputState::OtherStudy(manifest));
    }
    if manifest.complete && !same_layout {
        let found = format!("tables of stickslip {} (this is {VERSION})", manifest.version);
        return Ok(OutputState::Changed(manifest, found));
    }
    // The tables of incomplete results would be replaced.
    let names = match manifest.complete {
        true => manifest.files.keys().cloned().collect(),
        false => written_tables(directory).map_err(&unusable)?,
    };
    for name in names {
        let changed = match manifest.files.get(&name) {
            None => Some(format!("{name}, which {MANIFEST} does not name")),
            Some(entry) => difference(directory, &name, entry).map_err(&unusable)?,
        };
        if let Some(found) = changed {
            return Ok(OutputState::Changed(manifest, found));
        }
    }
    let study_file = directory.join(STUDY);
    let has_study = manifest.complete || fs::symlink_metadata(&study_file).is_ok();
    if has_study && !is_own_study(&study_file, study).map_err(unusable)? {
        let found =
            format!("{STUDY}, by another name of the study, other expectations or other responses");
        return Ok(OutputState::Changed(manifest, found));
    }
    Ok(match manifest.complete {
        true => OutputState::Complete(manifest),
        false => OutputState::Incomplete(manifest),
    })
}

/// Refuses an empty path, which operating systems interpret inconsistently.
///
/// # Errors
/// Returns [`ResultsError::Unusable`] if the path is empty.
pub fn check_path(directory: &Path) -> Result<(), ResultsError> {
    if !directory.as_os_str().is_empty() {
        return Ok(());
    }
    let cause = io::Error::other("an empty path; the current directory is `.`");
    // Shows the path as it was given.
    Err(ResultsError::Unusable { path: PathBuf::from("\"\""), cause })
}

fn occupied(directory: &Path, reason: &str, found: &str) -> ResultsError {
    let allowed = "another directory, with --out DIR, or this one removed or renamed first";
    ResultsError::occupied(directory, reason, one_line(found, LONGEST_FOUND), allowed)
}

/// Inspects a directory without a manifest. A program that is killed at its start leaves finished
/// runs, the study, and unfinished files. A foreign study file is refused, unless there are tables or
/// finished runs beside it: then all files are later moved to `earlier/`.
fn without_manifest(
    directory: &Path,
    study: &Study,
    ours: &[&str],
) -> Result<OutputState, ResultsError> {
    let unusable = ResultsError::unusable(directory);
    let refused = |found: String| {
        let reason = "this directory is not empty and holds no finished study";
        Err(occupied(directory, reason, &found))
    };
    let entries = match fs::read_dir(directory) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(OutputState::Unused),
        entries => entries.map_err(&unusable)?,
    };
    let (mut tables, mut of_results, mut other) = (false, false, None);
    for entry in entries {
        let entry = entry.map_err(&unusable)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let unfinished = final_name(&name);
        if ours.contains(&&*name) {
            of_results = true;
        } else if DATA_FILES.contains(&&*name) && name != STUDY {
            tables = true;
        } else if name == STUDY {
            if !is_own_study(&entry.path(), study).map_err(&unusable)? {
                other = Some(name);
            }
        } else if !unfinished.is_some_and(|of| DATA_FILES.contains(&of) || of == MANIFEST) {
            return refused(format!("files without a {MANIFEST}, such as {name}"));
        }
    }
    match other {
        Some(name) if !(tables || of_results) => {
            refused(format!("a {name} that is not what this study writes, and no {MANIFEST}"))
        }
        None if !tables => Ok(OutputState::Unused),
        _ => Ok(OutputState::WithoutManifest),
    }
}

/// Returns whether a file is the resolved study file of the study.
fn is_own_study(path: &Path, study: &Study) -> io::Result<bool> {
    has_content(path, study.resolved_yaml().as_bytes())
}

/// Returns the names of the tables in a directory, with the name of each part of a table.
fn written_tables(directory: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for &table in DATA_FILES.iter().filter(|name| **name != STUDY) {
        let Ok(found) = fs::symlink_metadata(directory.join(table)) else { continue };
        if !found.is_dir() {
            names.push(table.to_owned());
            continue;
        }
        for part in fs::read_dir(directory.join(table))? {
            names.push(format!("{table}/{}", part?.file_name().to_string_lossy()));
        }
    }
    Ok(names)
}

/// Describes how a file differs from its entry in the manifest, or returns `None` if it does not.
fn difference(directory: &Path, name: &str, entry: &FileEntry) -> io::Result<Option<String>> {
    Ok(match regular_file(directory, name) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Some(format!("{name} is missing")),
        Err(error) => Some(format!("{name}: {error}")),
        Ok(bytes) if bytes != entry.bytes => {
            Some(format!("{name} of {bytes} bytes, {} in the manifest", entry.bytes))
        }
        Ok(_) if FileEntry::of(&directory.join(name), entry.rows)? != *entry => {
            Some(format!("the content of {name}"))
        }
        Ok(_) => None,
    })
}

/// Returns the size of a regular file below a directory, without following links.
fn regular_file(directory: &Path, name: &str) -> io::Result<u64> {
    let path = directory.join(name);
    let refused = || io::Error::other("not a regular file");
    for parent in path.ancestors().skip(1).take_while(|parent| *parent != directory) {
        if !fs::symlink_metadata(parent)?.is_dir() {
            return Err(refused());
        }
    }
    let found = fs::symlink_metadata(&path)?;
    if found.is_file() { Ok(found.len()) } else { Err(refused()) }
}
