//! `files.json`: the hashes of the files that this program has written into a directory without a manifest.
//!
//! A file is listed before it is renamed to its final name, and the entry of the file that it replaces remains until then.
//! If the process is killed at any time, the file on disk therefore matches one of the two entries.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::column::Column;
use super::durable_files::{write_atomically, write_once};
use super::file_entry::{FileEntry, ListedFiles, is_file_name, read_regular};
use super::provenance::FORMAT;
use super::table_error::TableError;
use super::writer::{TableWriter, WriteError};
use crate::sanitize::shorten;
use crate::tabular::Fault;

/// The file name of the list.
pub const FILES: &str = "files.json";

/// The largest size of a list, bytes.
const MAX_BYTES: u64 = 4 * 1024 * 1024;

/// The listed files of a directory.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileList {
    /// The version of the layout.
    format: u32,
    /// The files by name; a table in a directory has one entry per part.
    files: BTreeMap<String, FileEntry>,
    /// The files that had these names before.
    #[serde(default)]
    replaced: BTreeMap<String, FileEntry>,
}

impl Default for FileList {
    fn default() -> Self {
        FileList { format: FORMAT, files: BTreeMap::new(), replaced: BTreeMap::new() }
    }
}

impl FileList {
    /// Reads the list of a directory, or `None` if it has no list.
    ///
    /// # Errors
    /// Returns an error if the list cannot be read or is invalid.
    pub fn read(directory: &Path) -> Result<Option<Self>, TableError> {
        let path = directory.join(FILES);
        let refuse = |found: &str| {
            let problem = "this is not a list of files written by this program";
            let allowed = "the unchanged list, or another directory with --out DIR";
            TableError::new(&path, None, Fault::new(problem, shorten(found), allowed))
        };
        let bytes = match read_regular(&path, MAX_BYTES) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            other => other.map_err(|error| refuse(&error.to_string()))?,
        };
        let list: Self = serde_json::from_slice(&bytes).map_err(|e| refuse(&e.to_string()))?;
        if list.format != FORMAT {
            return Err(refuse(&format!("layout {}, not {FORMAT}", list.format)));
        }
        match list.files.keys().find(|name| !is_file_name(name)) {
            Some(name) => Err(refuse(&format!("the name {name}"))),
            None => Ok(Some(list)),
        }
    }

    /// Adds files that are about to be renamed to their final names, and writes the list. The files that were announced
    /// before have their final names.
    ///
    /// # Errors
    /// Returns an error if the list cannot be written.
    pub fn announce(&mut self, directory: &Path, files: &[(String, FileEntry)]) -> io::Result<()> {
        self.replaced.clear();
        for (name, entry) in files {
            let before = self.files.insert(name.clone(), entry.clone());
            if let Some(before) = before.filter(|before| before != entry) {
                self.replaced.insert(name.clone(), before);
            }
        }
        self.save(directory)
    }

    /// Writes the list into its directory.
    ///
    /// # Errors
    /// Returns an error if the list cannot be written.
    pub fn save(&self, directory: &Path) -> io::Result<()> {
        let text = serde_json::to_string_pretty(self).map_err(io::Error::other)? + "\n";
        write_atomically(&directory.join(FILES), text.as_bytes())
    }

    /// Removes a deleted file from the list.
    pub fn remove(&mut self, name: &str) {
        self.files.remove(name);
        self.replaced.remove(name);
    }

    /// Writes a file atomically and adds it to the list. Unless an existing file is `replaced`, it must have the same content.
    ///
    /// # Errors
    /// Returns an error if the file or the list cannot be written, or if the name is taken.
    pub fn write(
        &mut self,
        directory: &Path,
        name: &str,
        content: &[u8],
        replaced: bool,
    ) -> io::Result<()> {
        self.announce(directory, &[(name.to_owned(), FileEntry::of_content(content))])?;
        let write = if replaced { write_atomically } else { write_once };
        write(&directory.join(name), content)
    }

    /// Writes a table with this provenance and adds its files to the list. Unless an existing table is `replaced`, it must
    /// have the same bytes.
    ///
    /// # Errors
    /// Returns an error if a file or the list cannot be written, or if the name is taken.
    pub fn write_table<R>(
        &mut self,
        directory: &Path,
        name: &str,
        provenance: &str,
        columns: Vec<Column<R>>,
        rows: impl IntoIterator<Item = R>,
        replaced: bool,
    ) -> Result<(), WriteError> {
        let path = directory.join(format!("{name}.parquet"));
        let mut table = TableWriter::create(&path, columns, provenance)?;
        table.extend(rows)?;
        table.finish_after(replaced, |files| self.announce(directory, files))
    }

    /// Returns the content of a file if the list names it.
    ///
    /// # Errors
    /// Returns an error if the file is missing, cannot be read, or differs from the one that was written.
    pub fn read_file(&self, directory: &Path, name: &str) -> Result<Option<Vec<u8>>, TableError> {
        let Some(entry) = self.files.get(name) else { return Ok(None) };
        let path = self.in_directory(directory).check(name, entry)?;
        let content = read_regular(&path, entry.bytes).map_err(|error| {
            let problem = "this file cannot be read";
            TableError::new(&path, None, Fault::new(problem, error.to_string(), "a readable file"))
        })?;
        Ok(Some(content))
    }

    /// Returns whether the list names a file.
    pub fn has(&self, name: &str) -> bool {
        self.files.contains_key(name)
    }

    /// Compares the list with the directory: selects the matching one of two entries for a name, and removes the entries of
    /// deleted files. Returns the names of the files that match neither entry.
    pub fn reconcile(&mut self, directory: &Path) -> Vec<String> {
        let mut changed = Vec::new();
        for (name, entry) in std::mem::take(&mut self.files) {
            let path = directory.join(&name);
            if fs::symlink_metadata(&path).is_err() {
                continue;
            }
            let is_there = |entry: &FileEntry| entry.is_at(&path).unwrap_or(false);
            let entry = match self.replaced.remove(&name) {
                Some(before) if is_there(&before) => before,
                _ => entry,
            };
            if !is_there(&entry) {
                changed.push(name.clone());
            }
            self.files.insert(name, entry);
        }
        self.replaced.clear();
        changed
    }

    /// Returns the listed files with their directory.
    pub(super) fn in_directory<'a>(&'a self, directory: &'a Path) -> ListedFiles<'a> {
        let remedy = "to write it again, repeat its command with another directory".to_owned();
        ListedFiles { directory, list: FILES, files: &self.files, remedy }
    }
}
