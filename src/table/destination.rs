//! What an output directory holds before a study is run, and how earlier results are put aside.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::manifest::{FileEntry, MANIFEST, Manifest};
use super::provenance::{FORMAT, VERSION};
use super::results::{DATA_FILES, ResultsError, STUDY};
use super::temporary::{sync_directory, will_become};
use crate::ending::MODEL_VERSION;
use crate::foreign::one_line;
use crate::study::Study;

/// Folder of earlier results in an output directory.
pub const EARLIER: &str = "earlier";

/// The most characters of what was found that are shown.
const LONGEST_FOUND: usize = 400;

/// What an output directory holds before a study is run.
#[derive(Debug)]
pub enum Destination {
    /// Nothing: the study can be run.
    Free,
    /// Tables of which nothing says whose they are, the manifest being gone.
    Loose,
    /// A part of the results of this very study and shard: it can go on.
    Begun(Box<Manifest>),
    /// All results of this very study and shard.
    Complete(Box<Manifest>),
    /// All results of this very study and shard, but not the files that were written; what differs, in
    /// words.
    Changed(Box<Manifest>, String),
    /// Results of another study, or of this one by another version of the program.
    Another(Box<Manifest>),
}

/// The manifest of an output directory, if there is one.
///
/// # Errors
/// [`ResultsError::Occupied`] where it is damaged or none of ours, [`ResultsError::Unusable`].
pub fn manifest_of(directory: &Path) -> Result<Option<Manifest>, ResultsError> {
    Manifest::read(directory).map_err(|cause| match cause.kind() {
        io::ErrorKind::InvalidData => ResultsError::Occupied {
            path: directory.to_owned(),
            reason: format!("{MANIFEST} is damaged, or no manifest of ours"),
            found: one_line(&cause.to_string(), LONGEST_FOUND),
            allowed: format!(
                "another directory, with --out DIR; or, if these are results of a study, {MANIFEST} \
                 removed and the study run again: finished runs are found without it"
            ),
        },
        _ => ResultsError::Unusable { path: directory.to_owned(), cause },
    })
}

/// Looks at an output directory and refuses one whose files are not results, or are those of another
/// shard. `ours` are names of folders that results may have beside their tables. Changes nothing.
///
/// # Errors
/// [`ResultsError::Occupied`] or [`ResultsError::Unusable`].
pub fn inspect(
    directory: &Path,
    study: &Study,
    shard: &str,
    ours: &[&str],
) -> Result<Destination, ResultsError> {
    let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
    let occupied = |reason: &str, found: String| ResultsError::Occupied {
        path: directory.to_owned(),
        reason: reason.to_owned(),
        found: one_line(&found, LONGEST_FOUND),
        allowed: "another directory, with --out DIR, or this one removed or renamed first"
            .to_owned(),
    };
    let manifest = manifest_of(directory)?;
    let Some(manifest) = manifest else {
        let entries = match fs::read_dir(directory) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Destination::Free),
            entries => entries.map_err(unusable)?,
        };
        let mut loose = false;
        for entry in entries {
            // What a run that was killed at its very start may have left.
            let name = entry.map_err(unusable)?.file_name();
            let name = name.to_string_lossy();
            let file = will_become(&name).unwrap_or(&name);
            loose |= DATA_FILES.contains(&&*name) && name != STUDY;
            let of_results = DATA_FILES.contains(&file) || file == MANIFEST || ours.contains(&file);
            if !of_results {
                let reason = "this directory is not empty and holds no finished study";
                return Err(occupied(
                    reason,
                    format!("files without a {MANIFEST}, such as {name}"),
                ));
            }
        }
        return Ok(if loose { Destination::Loose } else { Destination::Free });
    };
    let another = |manifest: &Manifest| {
        format!(
            "study {}, hash {}, shard {} (this one: {}, hash {}, shard {shard})",
            manifest.study,
            &manifest.study_hash.chars().take(12).collect::<String>(),
            manifest.shard,
            study.name(),
            &study.hash()[..12],
        )
    };
    if manifest.shard != shard {
        let reason = "this directory holds the results of another shard";
        return Err(occupied(reason, another(&manifest)));
    }
    let manifest = Box::new(manifest);
    let same_layout = (manifest.version.as_str(), manifest.format) == (VERSION, FORMAT);
    if manifest.study_hash != study.hash() || manifest.model_version != MODEL_VERSION {
        return Ok(Destination::Another(manifest));
    }
    if !manifest.complete {
        return Ok(Destination::Begun(manifest));
    }
    if !same_layout {
        let found = format!("tables of stickslip {} (this is {VERSION})", manifest.version);
        return Ok(Destination::Changed(manifest, found));
    }
    for (name, entry) in &manifest.files {
        // The file itself: a link may lead anywhere.
        let bytes = fs::symlink_metadata(directory.join(name)).and_then(|file| {
            let other = || io::Error::other("not a regular file");
            file.is_file().then_some(file.len()).ok_or_else(other)
        });
        if bytes.as_ref().ok() != Some(&entry.bytes) {
            let found = match bytes {
                Ok(bytes) => format!("{name} of {bytes} bytes, {} in the manifest", entry.bytes),
                Err(error) if error.kind() == io::ErrorKind::NotFound => {
                    format!("{name} is missing")
                }
                Err(error) => format!("{name}: {error}"),
            };
            return Ok(Destination::Changed(manifest, found));
        }
        let content = FileEntry::of(&directory.join(name), entry.rows).map_err(unusable)?;
        if content != *entry {
            let found = format!("the content of {name}");
            return Ok(Destination::Changed(manifest, found));
        }
    }
    if fs::read_to_string(directory.join(STUDY)).map_err(unusable)? != study.resolved_yaml() {
        let found = format!("{STUDY}, by another name of the study or other expectations");
        return Ok(Destination::Changed(manifest, found));
    }
    Ok(Destination::Complete(manifest))
}

/// Moves the tables, the study and the manifest of earlier results into a folder of their own below
/// `earlier/`, from which nothing is ever removed; returns that folder.
///
/// # Errors
/// Where they cannot be moved; what is left is moved by the next try.
pub fn put_aside(directory: &Path) -> Result<PathBuf, ResultsError> {
    let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
    let folder = directory.join(EARLIER);
    fs::create_dir_all(&folder).map_err(unusable)?;
    if !fs::symlink_metadata(&folder).map_err(unusable)?.is_dir() {
        return Err(unusable(io::Error::other(format!("{EARLIER} is a link to somewhere else"))));
    }
    let number = (1..u64::MAX).find(|number| !folder.join(number.to_string()).exists());
    let place = folder.join(number.unwrap_or(u64::MAX).to_string());
    // A folder that a crash has left half full is filled up: the manifest is moved last.
    let filling = place.with_extension("partial");
    fs::create_dir_all(&filling).map_err(unusable)?;
    for name in DATA_FILES.into_iter().chain([MANIFEST]) {
        match fs::rename(directory.join(name), filling.join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(unusable(error)),
            _ => {}
        }
    }
    fs::rename(&filling, &place).map_err(unusable)?;
    sync_directory(&folder).map_err(unusable)?;
    sync_directory(directory).map_err(unusable)?;
    Ok(place)
}
