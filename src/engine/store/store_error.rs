//! Why the store of finished runs fails.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::table::ResultsError;

/// The reason why finished runs could not be stored or read.
#[derive(Debug, Error)]
pub enum StoreError {
    /// A folder or file cannot be used.
    #[error(transparent)]
    Unusable(#[from] ResultsError),
    /// Another process writes to the directory.
    #[error(
        "{}: another process is writing into this directory\n  found:   its lock on {}\n  allowed: \
         wait until it has ended, or another directory, with --out DIR",
        path.display(), lock.display()
    )]
    Busy {
        /// The directory.
        path: PathBuf,
        /// The lock file, relative to the directory.
        lock: PathBuf,
    },
    /// The lock was removed while this process had it.
    #[error(
        "{}: this process lost its lock on the directory\n  found:   {} was removed, so that another \
         process may write here, too\n  allowed: no other process that uses this directory; the same command then \
         continues from the finished runs",
        path.display(), lock.display()
    )]
    Lost {
        /// The directory.
        path: PathBuf,
        /// The lock file, relative to the directory.
        lock: PathBuf,
    },
    /// A chunk could not be written.
    #[error(
        "cannot write {}: {cause}\n  earlier finished runs are saved; after the cause is removed, the same \
         command continues",
        path.display()
    )]
    Unwritten {
        /// The chunk.
        path: PathBuf,
        /// The operating system's error.
        cause: io::Error,
    },
}
