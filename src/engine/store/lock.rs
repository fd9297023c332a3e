//! One process at a time writes into an output directory.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use super::StoreError;
use crate::engine::say;

/// A directory that is ours as long as this value lives; the operating system gives it free when the
/// process ends, however it ends.
#[derive(Debug)]
pub struct Lock {
    file: Option<File>,
    path: PathBuf,
    directory: PathBuf,
}

impl Lock {
    /// Takes the lock `path`.
    ///
    /// # Errors
    /// [`StoreError::Busy`] where another process has it; [`StoreError::Unusable`]. A file system that has
    /// no locks is warned of.
    pub fn take(path: PathBuf, directory: &Path) -> Result<Self, StoreError> {
        let unusable = |cause| StoreError::Unusable { path: path.clone(), cause };
        let named = || path.strip_prefix(directory).unwrap_or(&path).to_owned();
        // Nothing is opened that another could have put there to be waited for, or to lead elsewhere.
        if fs::symlink_metadata(&path).is_ok_and(|found| !found.is_file()) {
            return Err(unusable(io::Error::other("not a regular file")));
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

    /// Whether the directory is still ours: somebody may have removed the lock.
    ///
    /// # Errors
    /// [`StoreError::Lost`] where it is not.
    pub fn check(&self) -> Result<(), StoreError> {
        #[cfg(unix)]
        if let Some(file) = &self.file {
            use std::os::unix::fs::MetadataExt;
            let place = |found: fs::Metadata| (found.dev(), found.ino());
            let ours = file.metadata().map(place).ok();
            if ours.is_none() || fs::symlink_metadata(&self.path).map(place).ok() != ours {
                let lock = self.path.strip_prefix(&self.directory).unwrap_or(&self.path).to_owned();
                return Err(StoreError::Lost { path: self.directory.clone(), lock });
            }
        }
        Ok(())
    }
}

impl Drop for Lock {
    /// Gives the directory free at once. A process that another thread is just starting has a copy of the
    /// open file until it becomes another program; to close ours alone would leave the lock in its hands.
    fn drop(&mut self) {
        if let Some(file) = &self.file {
            // Where this fails, closing the file is what is left.
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
