//! An output directory that the same command continues, such as that of `optimize`.
//!
//! An empty file `lock`, which the process locks, keeps other processes away, and `files.json` lists all files with their
//! hashes.

use std::fs;
use std::path::Path;

use super::Lock;
use super::command_error::CommandError;
use super::exclusive_directory::check_entries;
use crate::table::column::Column;
use crate::table::{FILES, FileList, ResultsError, WriteError, clear_temporaries, make_directory};

/// The file that is locked.
const LOCK: &str = "lock";

/// A directory that a command continues, locked for this process as long as the value lives.
pub struct ContinuedDirectory<'a> {
    /// The directory.
    pub path: &'a Path,
    /// The files with their hashes.
    pub list: FileList,
    /// Names of the files that differ from what was written.
    pub changed: Vec<String>,
    _lock: Lock,
}

impl<'a> ContinuedDirectory<'a> {
    /// Opens the directory, creates it if needed, and locks it. `belongs` names the files of the command, without list and lock.
    ///
    /// # Errors
    /// Returns an error, with this reason, if the directory holds anything but own files, also under temporary names; and if it
    /// is locked or cannot be used.
    pub fn open(
        path: &'a Path,
        reason: &str,
        belongs: impl Fn(&str) -> bool,
    ) -> Result<Self, CommandError> {
        let unusable = ResultsError::unusable(path);
        let belongs = |name: &str| belongs(name) || name == FILES || name == LOCK;
        check_entries(path, reason, |name| crate::table::is_own(name, belongs))?;
        make_directory(path).map_err(&unusable)?;
        let lock = Lock::take(path.join(LOCK), path)?;
        clear_temporaries(path, belongs).map_err(&unusable)?;
        let found = FileList::read(path)?;
        let mut list = found.clone().unwrap_or_default();
        let changed = list.reconcile(path);
        if found.is_some_and(|found| found != list) {
            list.save(path).map_err(unusable)?;
        }
        Ok(ContinuedDirectory { path, list, changed, _lock: lock })
    }

    /// Removes files.
    pub fn remove<'n>(&mut self, names: impl IntoIterator<Item = &'n str>) {
        for name in names {
            // A missing file needs no removal, and one that cannot be removed is overwritten at the end.
            let _ = fs::remove_file(self.path.join(name));
            self.list.remove(name);
        }
    }

    /// Writes a table; `about` is its provenance.
    ///
    /// # Errors
    /// Returns an error if the table cannot be written.
    pub fn write<R>(
        &mut self,
        name: &str,
        about: &str,
        columns: Vec<Column<R>>,
        rows: impl IntoIterator<Item = R>,
    ) -> Result<(), WriteError> {
        self.list.write_table(self.path, name, about, columns, rows, true)
    }

    /// Writes a file of JSON.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn write_json(
        &mut self,
        name: &str,
        value: &serde_json::Value,
    ) -> Result<(), CommandError> {
        let text = format!("{value:#}\n");
        let written = self.list.write(self.path, name, text.as_bytes());
        let path = self.path.join(name);
        written.map_err(|cause| WriteError { path, cause }.into())
    }
}
