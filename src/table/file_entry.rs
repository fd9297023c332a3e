//! A file on a list of files: its rows, its size and its hash, against which it is verified once, before any of its content
//! is used.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::table_error::TableError;
use crate::sanitize::is_acted_on;
use crate::tabular::Fault;

/// A data file in the manifest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileEntry {
    /// Number of rows; `None` for a file that is not a table.
    pub rows: Option<u64>,
    /// Size in bytes.
    pub bytes: u64,
    /// SHA-256 hash of the content, in hexadecimal.
    pub sha256: String,
}

impl FileEntry {
    /// Creates the entry of a file on disk.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn of(path: &Path, rows: Option<u64>) -> io::Result<Self> {
        let mut hasher = HashWriter { hasher: Sha256::new(), bytes: 0 };
        io::copy(&mut fs::File::open(path)?, &mut hasher)?;
        Ok(FileEntry { rows, bytes: hasher.bytes, sha256: hexadecimal(&hasher.hasher.finalize()) })
    }

    /// Creates the entry of a file that has this content and is not a table.
    pub(super) fn of_content(content: &[u8]) -> Self {
        FileEntry { rows: None, bytes: content.len() as u64, sha256: sha256(content) }
    }

    /// Returns whether there is a regular file with this content.
    pub(super) fn is_at(&self, path: &Path) -> io::Result<bool> {
        // Checked before opening: opening a named pipe would wait for a writer.
        let found = fs::symlink_metadata(path)?;
        let may_be = found.is_file() && found.len() == self.bytes;
        Ok(may_be && FileEntry::of(path, None)?.sha256 == self.sha256)
    }
}

/// Returns the first digits of a hash, for messages.
pub(super) fn short_hash(hash: &str) -> String {
    hash.chars().take(12).collect()
}

/// Returns the SHA-256 hash of a content, in hexadecimal.
pub(crate) fn sha256(content: impl AsRef<[u8]>) -> String {
    hexadecimal(&Sha256::digest(content))
}

pub(crate) fn hexadecimal(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

struct HashWriter {
    hasher: Sha256,
    bytes: u64,
}

impl io::Write for HashWriter {
    fn write(&mut self, content: &[u8]) -> io::Result<usize> {
        self.hasher.update(content);
        self.bytes += content.len() as u64;
        Ok(content.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Returns whether there is a regular file with this content.
pub(super) fn has_content(path: &Path, content: &[u8]) -> io::Result<bool> {
    let found = fs::symlink_metadata(path)?;
    let may_be = found.is_file() && found.len() == content.len() as u64;
    Ok(may_be && read_regular(path, found.len())? == content)
}

/// Reads a regular file of at most `most` bytes.
pub(crate) fn read_regular(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // Checked before opening: opening a named pipe would wait for a writer, and a link may lead
    // anywhere.
    if !fs::symlink_metadata(path)?.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    let mut bytes = Vec::new();
    fs::File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("larger than {most} bytes")));
    }
    Ok(bytes)
}

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
