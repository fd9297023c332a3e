//! The ways a command ends, and their exit codes.

use std::fmt::Display;
use std::io;
use std::process::ExitCode;

use thiserror::Error;

use crate::engine::{EngineError, OutputDirError, StoreError};
use crate::study::StudyError;
use crate::table::{ResultsError, TableError, WriteError};

/// The end of a command that did its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Success.
    Well,
    /// Finished, but some runs failed.
    RunsFailed,
    /// Stopped because more runs failed than `--on-failure` allows.
    TooManyFailed,
    /// `check --strict` has warned.
    Warned,
    /// An expectation of the study is not met.
    ExpectationNotMet,
    /// A replayed run differs from its row.
    NotReproduced,
    /// Interrupted; all finished runs are on disk.
    Interrupted,
}

impl End {
    /// Returns the exit code.
    pub fn code(self) -> ExitCode {
        ExitCode::from(match self {
            End::Well => 0,
            End::TooManyFailed => 1,
            End::NotReproduced => 1,
            End::Warned => 2,
            End::RunsFailed => 3,
            End::ExpectationNotMet => 4,
            End::Interrupted => 130,
        })
    }
}

/// An error that prevented a command from completing.
#[derive(Debug, Error)]
pub enum CliError {
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
    Threads(rayon::ThreadPoolBuildError),
    /// Standard output cannot be written to.
    #[error("cannot write to standard output: {0}")]
    Output(#[from] io::Error),
}

impl From<OutputDirError> for CliError {
    fn from(error: OutputDirError) -> Self {
        match error {
            OutputDirError::Results(error) => CliError::Results(error),
            OutputDirError::Store(error) => CliError::Store(error),
        }
    }
}

impl From<EngineError<ResultsError>> for CliError {
    fn from(error: EngineError<ResultsError>) -> Self {
        match error {
            EngineError::Threads(error) => CliError::Threads(error),
            EngineError::Sink(error) => CliError::Results(error),
            EngineError::Store(error) => CliError::Store(error),
        }
    }
}

impl CliError {
    /// Returns the error of an argument or a file that cannot be used: what it is, what was found, and what is allowed.
    pub fn refusal(what: impl Display, found: impl Display, allowed: impl Display) -> Self {
        CliError::Usage(format!("{what}\n  found:   {found}\n  allowed: {allowed}"))
    }

    /// Returns the exit code: 2 if the user can fix the cause in the study or on the command line, otherwise 1.
    pub fn code(&self) -> ExitCode {
        ExitCode::from(match self {
            CliError::Study(_) | CliError::Usage(_) | CliError::Table(_) => 2,
            CliError::Results(ResultsError::Occupied { .. } | ResultsError::Unusable { .. }) => 2,
            CliError::Store(StoreError::Unusable { .. }) => 2,
            CliError::Results(ResultsError::Write(_))
            | CliError::Store(
                StoreError::Unwritten { .. } | StoreError::Busy { .. } | StoreError::Lost { .. },
            )
            | CliError::Write(_)
            | CliError::Threads(_)
            | CliError::Output(_) => 1,
        })
    }
}
