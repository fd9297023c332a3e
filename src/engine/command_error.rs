//! Why the work of a command, such as a search or a replay, could not be completed.

use std::fmt::Display;
use std::io;

use thiserror::Error;

use super::StoreError;
use crate::study::StudyError;
use crate::table::{ResultsError, TableError, WriteError};

/// An error that prevented a command from completing.
#[derive(Debug, Error)]
pub enum CommandError {
    /// The study is invalid.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The arguments are invalid or do not fit the study.
    #[error("{0}")]
    Usage(String),
    /// The output directory cannot be used, or a table cannot be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A table cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Finished runs cannot be stored or read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A table cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The worker threads cannot be started.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Standard output cannot be written to.
    #[error("cannot write to standard output: {0}")]
    Output(#[from] io::Error),
}

impl CommandError {
    /// Returns the error of an argument or a file that cannot be used: what it is, what was found, and what is allowed.
    pub fn refusal(what: impl Display, found: impl Display, allowed: impl Display) -> Self {
        CommandError::Usage(format!("{what}\n  found:   {found}\n  allowed: {allowed}"))
    }
}
