//! Lock files: only one process at a time writes to an output directory.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use super::StoreError;
use crate::engine::say;
use crate::table::ResultsError;

/// A directory that this process alone writes to as long as the value lives. The operating system releases the lock
/// when the process ends.
#[derive(Debug)]
pub struct Lock {
    file: Option<File>,
    path: PathBuf,
    directory: PathBuf,
}

impl Lock {
    /// Takes the lock file `path`. Warns if the file system does not support locks.
    ///
    /// # Errors
    /// Returns [`StoreError::Busy`] if another process holds the lock, [`StoreError::Unusable`] if the file cannot be
    /// opened.
    pub fn take(path: PathBuf, directory: &Path) -> Result<Self, StoreError> {
        let unusable = |cause| ResultsError::Unusable { path: path.clone(), cause };
        let named = || path.strip_prefix(directory).unwrap_or(&path).to_owned();
        // Opening a FIFO would block, and a link could lead elsewhere.
        if fs::symlink_metadata(&path).is_ok_and(|found| !found.is_file()) {
            return Err(unusable(io::Error::other("not a regular file")).into());
        }
        let opened = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
        let file = opened.map_err(unusable)?;
        let file = match file.try_lock() {
            Ok(()) => Some(file),
            Err(TryLockError::WouldBlock) => {
                return Err(StoreError::Busy { path: directory.to_owned(), lock: named() });
            }
            Err(TryLockError::Error(cause)) => {
                say(&format!(
                    "warning: {} cannot be locked ({cause}): make sure that no other process writes \
                     into this directory",
                    path.display()
                ));
                None
            }
        };
        Ok(Lock { file, path, directory: directory.to_owned() })
    }

    /// Checks that the lock file still exists and is this process's.
    ///
    /// # Errors
    /// Returns [`StoreError::Lost`] if the lock file is gone or replaced.
    pub fn check(&self) -> Result<(), StoreError> {
        if self.file.as_ref().is_some_and(|file| !is_at(file, &self.path)) {
            let lock = self.path.strip_prefix(&self.directory).unwrap_or(&self.path).to_owned();
            return Err(StoreError::Lost { path: self.directory.clone(), lock });
        }
        Ok(())
    }
}

/// Returns whether the open file is still the one at this path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |found: fs::Metadata| (found.dev(), found.ino());
    let ours = file.metadata().map(identity).ok();
    ours.is_some() && fs::symlink_metadata(path).map(identity).ok() == ours
}

/// Returns whether there is a file at this path; the operating system does not let others replace an open one.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.is_file()
}

impl Drop for Lock {
    /// Releases the lock explicitly. A child process that another thread is just starting holds a copy of the open
    /// file until it executes its program; closing our copy alone would leave the lock with the child.
    fn drop(&mut self) {
        if let Some(file) = &self.file {
            // If this fails, closing the file releases the lock.
            let _ = file.unlock();
        }
    }
}

#[cfg(test)]
mod tests {
    use tempfile::TempDir;

    use super::*;

    #[test]
    fn a_copy_of_the_file_in_a_process_just_started_does_not_hold_the_lock() {
        let directory = TempDir::new().unwrap();
        let take = || Lock::take(directory.path().join("lock"), directory.path());
        let lock = take().unwrap();
        let copy = lock.file.as_ref().unwrap().try_clone().unwrap();
        assert!(matches!(take(), Err(StoreError::Busy { .. })));
        drop(lock);
        take().unwrap();
        drop(copy);
    }
}
