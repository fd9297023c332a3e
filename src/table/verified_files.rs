//! Verifies files against a list of their sizes and hashes.
//!
//! Every file is verified once, before any of its content is used.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

use super::file_entry::{FileEntry, short_hash};
use super::table_error::TableError;
use crate::sanitize::is_acted_on;
use crate::tabular::Fault;

/// Returns whether a listed name is printable and refers to a file in the directory or a subdirectory.
pub(super) fn is_file_name(name: &str) -> bool {
    let inside = |part: Component<'_>| matches!(part, Component::Normal(_));
    !name.is_empty() && !name.chars().any(is_acted_on) && Path::new(name).components().all(inside)
}

/// The files of a directory, as listed in it.
#[derive(Clone, Debug)]
pub(super) struct ListedFiles<'a> {
    /// The directory.
    pub directory: &'a Path,
    /// The file name of the list.
    pub list: &'a str,
    /// Its entries.
    pub files: &'a BTreeMap<String, FileEntry>,
    /// The remedy for a changed file, for messages.
    pub remedy: String,
}

impl<'a> ListedFiles<'a> {
    /// Returns the entries of a table by its name without `.parquet`: its file, or its parts in order.
    pub fn of_table(&self, name: &str) -> impl Iterator<Item = (&'a str, &'a FileEntry)> {
        let file = format!("{name}.parquet");
        let of_table = move |entry: &str| {
            entry.strip_prefix(&file).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let files = self.files.iter().map(|(name, entry)| (name.as_str(), entry));
        files.filter(move |(name, _)| of_table(name))
    }

    /// Checks a file and returns its path.
    ///
    /// # Errors
    /// Returns an error if the file is missing, cannot be read, or differs from the one that was written.
    pub fn check(&self, name: &str, expected: &FileEntry) -> Result<PathBuf, TableError> {
        let path = self.directory.join(name);
        let changed = |found: String| {
            let FileEntry { bytes, sha256, .. } = expected;
            let allowed = format!(
                "{bytes} bytes with SHA-256 {}..., as listed in {}; {}",
                short_hash(sha256),
                self.list,
                self.remedy
            );
            let problem = "this is not the file that was written";
            TableError::new(&path, None, Fault::new(problem, found, allowed))
        };
        // Checked before opening, because opening a named pipe would wait for a writer.
        let found = fs::metadata(&path).map_err(|error| changed(error.to_string()))?;
        if !found.is_file() {
            return Err(changed("not a regular file".to_owned()));
        }
        if found.len() != expected.bytes {
            return Err(changed(format!("{} bytes", found.len())));
        }
        let content = FileEntry::of(&path, expected.rows);
        let content = content.map_err(|error| changed(error.to_string()))?;
        match content == *expected {
            true => Ok(path),
            false => Err(changed(format!(
                "other content, with SHA-256 {}...",
                short_hash(&content.sha256)
            ))),
        }
    }

    /// Checks all files of a table and returns their paths and numbers of rows.
    ///
    /// # Errors
    /// Returns an error for the reasons given at [`Self::check`].
    pub fn check_table(&self, name: &str) -> Result<Vec<(PathBuf, u64)>, TableError> {
        let checked = self.of_table(name).map(|(name, entry)| {
            self.check(name, entry).map(|path| (path, entry.rows.unwrap_or(0)))
        });
        checked.collect()
    }
}
