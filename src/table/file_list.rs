//! `files.json`: the files that this program has written into a directory without a manifest, with their hashes.
//!
//! A file is on the list before it has its name, and what had the name before stays there until the next one
//! is: whenever a process is ended, the file under the name is one of the two.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::file_entry::{FileEntry, read_regular};
use super::provenance::FORMAT;
use super::table_error::TableError;
use super::temporary::{write_atomically, write_once};
use super::verified_files::{Listed, is_file_name};
use crate::foreign::shorten;
use crate::tabular::Fault;

/// Name of the list in its directory.
pub const FILES: &str = "files.json";

/// The largest list that is read, bytes.
const MAX_BYTES: u64 = 4 * 1024 * 1024;

/// What to do about a file that is another one.
const REMEDY: &str = "the command that has written it, with another directory, makes it again";

/// The files that a directory holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileList {
    /// Version of the layout.
    format: u32,
    /// The files by their names; of a table that is a directory, each of its parts.
    files: BTreeMap<String, FileEntry>,
    /// What had the same names before.
    #[serde(default)]
    replaced: BTreeMap<String, FileEntry>,
}

impl Default for FileList {
    fn default() -> Self {
        FileList { format: FORMAT, files: BTreeMap::new(), replaced: BTreeMap::new() }
    }
}

impl FileList {
    /// Reads the list of a directory; none where there is no such file.
    ///
    /// # Errors
    /// Where it cannot be read or is no such list.
    pub fn read(directory: &Path) -> Result<Option<Self>, TableError> {
        let path = directory.join(FILES);
        let refuse = |found: &str| {
            let problem = "this is no list of files that this program has written";
            let allowed = "the file that was written, or another directory, with --out DIR";
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

    /// Puts files on the list that are about to get their names in the directory, and writes it there.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn announce(&mut self, directory: &Path, files: &[(String, FileEntry)]) -> io::Result<()> {
        for (name, entry) in files {
            if let Some(before) = self.files.insert(name.clone(), entry.clone()) {
                self.replaced.insert(name.clone(), before);
            }
        }
        self.save(directory)
    }

    /// Writes the list into its directory.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn save(&self, directory: &Path) -> io::Result<()> {
        let text = serde_json::to_string_pretty(self).map_err(io::Error::other)? + "\n";
        write_atomically(&directory.join(FILES), text.as_bytes())
    }

    /// Whether two lists say the same of all files that have their names.
    pub fn has_files_of(&self, other: &Self) -> bool {
        self.files == other.files
    }

    /// Takes a file off the list that has been removed.
    pub fn forget(&mut self, name: &str) {
        self.files.remove(name);
        self.replaced.remove(name);
    }

    /// Writes a file, whole or not at all, and puts it on the list.
    ///
    /// # Errors
    /// Where it or the list cannot be written.
    pub fn write(&mut self, directory: &Path, name: &str, content: &[u8]) -> io::Result<()> {
        self.announce(directory, &[(name.to_owned(), FileEntry::of_content(content))])?;
        write_atomically(&directory.join(name), content)
    }

    /// As [`Self::write`], of a file that replaces nothing: where its name is taken, by this very content.
    ///
    /// # Errors
    /// Where something else has the name; where the file or the list cannot be written.
    pub fn write_once(&mut self, directory: &Path, name: &str, content: &[u8]) -> io::Result<()> {
        self.announce(directory, &[(name.to_owned(), FileEntry::of_content(content))])?;
        write_once(&directory.join(name), content)
    }

    /// Finds out which of its files the directory holds: of two that may have a name the one that is there; one
    /// that is gone is forgotten. Returns the names of those that are neither.
    pub fn settle(&mut self, directory: &Path) -> Vec<String> {
        let mut changed = Vec::new();
        for (name, entry) in std::mem::take(&mut self.files) {
            let path = directory.join(&name);
            let Ok(found) = fs::symlink_metadata(&path) else { continue };
            // What is no file is not read: a pipe would be waited for.
            let found = found.is_file().then(|| FileEntry::of(&path, None).ok()).flatten();
            let is_there =
                |entry: &FileEntry| found.as_ref().is_some_and(|found| found.has_content_of(entry));
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

    /// The files of the list in its directory.
    pub(super) fn in_directory<'a>(&'a self, directory: &'a Path) -> Listed<'a> {
        Listed { directory, list: FILES, files: &self.files, remedy: REMEDY }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::tempdir;

    use super::{FILES, FileList};
    use crate::table::FileEntry;

    #[test]
    fn a_process_may_be_ended_before_any_renaming() {
        let scratch = tempdir().unwrap();
        let there =
            |name: &str, content: &str| fs::write(scratch.path().join(name), content).unwrap();
        let announced = |list: &mut FileList, content: &str| {
            let entry = FileEntry::of_content(content.as_bytes());
            list.announce(scratch.path(), &[("a".to_owned(), entry)]).unwrap();
        };
        let settled = || {
            let mut list = FileList::read(scratch.path()).unwrap().unwrap();
            (list.settle(scratch.path()), list)
        };
        let mut list = FileList::default();
        list.write(scratch.path(), "a", b"one").unwrap();
        // Ended before the renaming, twice.
        announced(&mut list, "two");
        let (changed, mut list) = settled();
        assert!(changed.is_empty() && list.in_directory(scratch.path()).check_all().is_ok());
        announced(&mut list, "three");
        assert!(settled().0.is_empty());
        // And after it.
        there("a", "three");
        let (changed, list) = settled();
        assert!(changed.is_empty() && list.in_directory(scratch.path()).check_all().is_ok());
        for other in ["two", "thre3", ""] {
            there("a", other);
            let (changed, list) = settled();
            assert_eq!((changed, other), (vec!["a".to_owned()], other));
            assert!(list.in_directory(scratch.path()).check_all().is_err());
        }
        fs::remove_file(scratch.path().join("a")).unwrap();
        let (changed, list) = settled();
        assert_eq!((changed, list), (vec![], FileList::default()));
    }

    #[test]
    fn other_lists_are_refused() {
        let scratch = tempdir().unwrap();
        assert!(FileList::read(scratch.path()).unwrap().is_none());
        let hash = "0".repeat(64);
        let entry = format!("{{\"rows\": null, \"bytes\": 1, \"sha256\": \"{hash}\"}}");
        for text in [
            "",
            "{}",
            "{\"format\": 99, \"files\": {}}",
            &format!("{{\"format\": 1, \"files\": {{\"../a\": {entry}}}}}"),
            &format!("{{\"format\": 1, \"files\": {{\"/a\": {entry}}}}}"),
            &format!("{{\"format\": 1, \"files\": {{\"a\\u001b\": {entry}}}}}"),
        ] {
            fs::write(scratch.path().join(FILES), text).unwrap();
            let error = FileList::read(scratch.path()).unwrap_err().to_string();
            assert!(error.contains("no list of files") && !error.contains('\u{1b}'), "{error}");
        }
    }
}
