//! An output directory that one command fills once: `equilibria`, `replay`.
//!
//! While it is being filled there is an empty file `unfinished` in it, the first that is made and the last
//! that is removed, which the process has locked. Where it was left behind, the command was killed, and the
//! same command goes on: files that are finished stay, which it checks to the byte, the others are written
//! anew. `files.json` lists all of them with their hashes.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::exit::CliError;
use crate::engine::Lock;
use crate::foreign::shorten;
use crate::table::{
    FILES, FileList, ResultsError, check_path, clear_temporaries, is_one_of, make_directory,
    sync_directory,
};

/// The file that says that a directory is being filled.
const UNFINISHED: &str = "unfinished";

/// A directory that is being filled, ours alone as long as this value lives.
pub struct FilledOnce {
    /// The files that it will hold.
    pub list: FileList,
    directory: PathBuf,
    lock: Lock,
}

impl FilledOnce {
    /// Refuses a directory that holds anything but what the same command, which writes these `files`, has left
    /// there when it was killed. Changes nothing.
    ///
    /// # Errors
    /// Where there is something else, or where it cannot be read.
    pub fn inspect(directory: &Path, files: &[&str]) -> Result<(), ResultsError> {
        check_path(directory)?;
        let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
        let entries = match fs::read_dir(directory) {
            Ok(entries) => entries.collect::<io::Result<Vec<_>>>().map_err(unusable)?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(unusable(error)),
        };
        // With anything in it, it is not the file that says so.
        let unfinished = fs::symlink_metadata(directory.join(UNFINISHED))
            .is_ok_and(|found| found.is_file() && found.len() == 0);
        let own = |name: &str| {
            unfinished
                && (name == UNFINISHED || is_one_of(name, files) || is_one_of(name, &[FILES]))
        };
        let mut names: Vec<String> = entries
            .iter()
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .filter(|name| !own(name))
            .collect();
        names.sort();
        names.first().map_or(Ok(()), |name| {
            Err(ResultsError::Occupied {
                path: directory.to_owned(),
                reason: "this directory is not empty".to_owned(),
                found: format!("{} and perhaps more", shorten(name)),
                allowed: "another directory, with --out DIR, or this one removed or renamed first"
                    .to_owned(),
            })
        })
    }

    /// Makes the directory, if need be, and begins to fill it, or goes on.
    ///
    /// # Errors
    /// As for [`FilledOnce::inspect`]; where another process fills it, or where it cannot be written to.
    pub fn open(directory: &Path, files: &[&str]) -> Result<Self, CliError> {
        Self::inspect(directory, files)?;
        let begun = directory.join(UNFINISHED).exists();
        let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
        make_directory(directory).map_err(unusable)?;
        let lock = Lock::take(directory.join(UNFINISHED), directory)?;
        // In the meantime another process may have filled it.
        lock.check()?;
        Self::inspect(directory, if begun { files } else { &[] })?;
        sync_directory(directory).map_err(unusable)?;
        clear_temporaries(directory, files).map_err(unusable)?;
        clear_temporaries(directory, &[FILES]).map_err(unusable)?;
        // A list that was begun is written anew; what is none is not ours.
        FileList::read(directory)?;
        Ok(FilledOnce { list: FileList::default(), directory: directory.to_owned(), lock })
    }

    /// All files are there.
    ///
    /// # Errors
    /// Where the directory was taken away from this process, or cannot be written to.
    pub fn finish(self) -> Result<(), CliError> {
        let FilledOnce { directory, lock, .. } = self;
        lock.check()?;
        fs::remove_file(directory.join(UNFINISHED))
            .and_then(|()| sync_directory(&directory))
            .map_err(|cause| ResultsError::Unusable { path: directory, cause })?;
        Ok(())
    }
}
