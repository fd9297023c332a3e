//! Output directories of commands that do not compute a study. `files.json` lists all files with their hashes, and an empty
//! file, which the process locks, keeps other processes away.
//!
//! `equilibria` and `replay` fill a directory once. Its file `unfinished` is the first one created and the last one removed.
//! If it remains, the command was killed, and the same command continues: it verifies finished files by their hashes and
//! writes the others anew. `optimize` and `identify` continue a directory, whose file `lock` stays.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::Lock;
use super::command_error::CommandError;
use crate::sanitize::shorten;
use crate::table::column::Column;
use crate::table::{
    FILES, FileList, ResultsError, WriteError, check_path, clear_temporaries, is_own,
    make_directory, sync_directory,
};

/// The file that marks a directory that is being filled.
const UNFINISHED: &str = "unfinished";

/// A directory that is being filled, locked for this process as long as the value lives.
pub struct ExclusiveDirectory {
    /// The files of the finished directory.
    pub list: FileList,
    directory: PathBuf,
    lock: Lock,
}

impl ExclusiveDirectory {
    /// Checks that a directory is empty, missing, or left unfinished by the same command, which writes these `files`.
    /// Changes nothing.
    ///
    /// # Errors
    /// Returns an error if the directory holds anything else or cannot be read.
    pub fn inspect(directory: &Path, files: &[&str]) -> Result<(), ResultsError> {
        check_path(directory)?;
        // A marker with content belongs to someone else.
        let unfinished = fs::symlink_metadata(directory.join(UNFINISHED))
            .is_ok_and(|found| found.is_file() && found.len() == 0);
        let belongs = |name: &str| {
            unfinished && (name == UNFINISHED || is_own(name, |name| is_listed(name, files)))
        };
        check_entries(directory, "this directory is not empty", belongs)
    }

    /// Creates the directory if needed and locks it for filling.
    ///
    /// # Errors
    /// Returns the errors of [`ExclusiveDirectory::inspect`], and an error if another process fills the directory or it cannot
    /// be written to.
    pub fn open(directory: &Path, files: &[&str]) -> Result<Self, CommandError> {
        Self::inspect(directory, files)?;
        let begun = directory.join(UNFINISHED).exists();
        let unusable = ResultsError::unusable(directory);
        make_directory(directory).map_err(&unusable)?;
        let lock = Lock::take(directory.join(UNFINISHED), directory)?;
        // Another process may have filled it before this one got the lock.
        lock.check()?;
        Self::inspect(directory, if begun { files } else { &[] })?;
        sync_directory(directory).map_err(&unusable)?;
        clear_temporaries(directory, |name| is_listed(name, files)).map_err(unusable)?;
        // An unfinished list is written anew; an invalid one belongs to someone else.
        FileList::read(directory)?;
        Ok(ExclusiveDirectory { list: FileList::default(), directory: directory.to_owned(), lock })
    }

    /// Marks the directory as complete.
    ///
    /// # Errors
    /// Returns an error if another process took the lock, or if the directory cannot be written to.
    pub fn finish(self) -> Result<(), CommandError> {
        let ExclusiveDirectory { directory, lock, .. } = self;
        lock.check()?;
        fs::remove_file(directory.join(UNFINISHED))
            .and_then(|()| sync_directory(&directory))
            .map_err(ResultsError::unusable(&directory))?;
        Ok(())
    }
}

fn is_listed(name: &str, files: &[&str]) -> bool {
    name == FILES || files.contains(&name)
}

/// Checks that every entry of a directory `belongs` to it; a missing directory has no entries.
///
/// # Errors
/// Returns an error with `reason` and the first other entry, or an error if the directory cannot be read.
pub fn check_entries(
    directory: &Path,
    reason: &str,
    belongs: impl Fn(&str) -> bool,
) -> Result<(), ResultsError> {
    let unusable = ResultsError::unusable(directory);
    let entries = match fs::read_dir(directory) {
        Ok(entries) => entries.collect::<io::Result<Vec<_>>>().map_err(unusable)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(unusable(error)),
    };
    let names = entries.iter().map(|entry| entry.file_name().to_string_lossy().into_owned());
    match names.filter(|name| !belongs(name)).min() {
        None => Ok(()),
        Some(name) => {
            let found = format!("{} and perhaps more", shorten(&name));
            let allowed = "another directory, with --out DIR, or this one removed or renamed first";
            Err(ResultsError::occupied(directory, reason, found, allowed))
        }
    }
}

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
        let written = self.list.write(self.path, name, text.as_bytes(), true);
        let path = self.path.join(name);
        written.map_err(|cause| WriteError { path, cause }.into())
    }
}
