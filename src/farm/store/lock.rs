//! One process at a time writes into an output directory.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use super::StoreError;
use crate::farm::say;

/// A directory that is ours as long as this value lives; the operating system gives it free when the
/// process ends, however it ends.
#[derive(Debug)]
pub(super) struct Lock {
    _file: Option<File>,
}

impl Lock {
    /// Takes the lock `path`.
    ///
    /// # Errors
    /// [`StoreError::Busy`] where another process has it; [`StoreError::Unusable`]. A file system that has
    /// no locks is warned of.
    pub fn take(path: PathBuf, directory: &Path) -> Result<Self, StoreError> {
        let opened = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
        let file = opened.map_err(|cause| StoreError::Unusable { path: path.clone(), cause })?;
        match file.try_lock() {
            Ok(()) => Ok(Lock { _file: Some(file) }),
            Err(TryLockError::WouldBlock) => Err(StoreError::Busy { path: directory.to_owned() }),
            Err(TryLockError::Error(cause)) => {
                say(&format!(
                    "warning: {} cannot be locked ({cause}): make sure that no other process writes \
                     into this directory",
                    path.display()
                ));
                Ok(Lock { _file: None })
            }
        }
    }
}
