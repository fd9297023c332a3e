//! A file on a list of files: its rows, its size and its hash.

use std::fs;
use std::io::{self, Read};
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

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
