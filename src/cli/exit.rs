//! How a command ends, and the exit code for it.

use std::io;
use std::process::ExitCode;

use thiserror::Error;

use crate::engine::{EngineError, OutputDirError, StoreError};
use crate::study::StudyError;
use crate::table::{ResultsError, TableError, WriteError};

/// A command that did what it was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// All well.
    Well,
    /// Finished, but some runs failed.
    RunsFailed,
    /// Not finished: more runs failed than may.
    TooManyFailed,
    /// An expectation of the study is not met.
    ExpectationNotMet,
    /// A run computed again is not what its row says.
    NotReproduced,
    /// Interrupted; everything finished is kept.
    Interrupted,
}

impl End {
    /// The exit code.
    pub fn code(self) -> ExitCode {
        ExitCode::from(match self {
            End::Well => 0,
            End::TooManyFailed => 1,
            End::NotReproduced => 1,
            End::RunsFailed => 3,
            End::ExpectationNotMet => 4,
            End::Interrupted => 130,
        })
    }
}

/// A command that could not do what it was asked for.
#[derive(Debug, Error)]
pub enum CliError {
    /// The study cannot be used.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The arguments do not fit the study.
    #[error("{0}")]
    Usage(String),
    /// The output directory cannot be used, or a table not be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A table cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Finished runs cannot be kept or read.
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
    /// The exit code: 2 where the user can mend it in the study or on the command line.
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
