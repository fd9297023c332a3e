//! The ways a command ends, and their exit codes.

pub use crate::engine::CommandError as CliError;
use crate::engine::StoreError;
use crate::table::ResultsError;

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
    pub fn code(self) -> u8 {
        match self {
            End::Well => 0,
            End::TooManyFailed => 1,
            End::NotReproduced => 1,
            End::Warned => 2,
            End::RunsFailed => 3,
            End::ExpectationNotMet => 4,
            End::Interrupted => 130,
        }
    }
}

impl CliError {
    /// Returns the exit code: 2 if the user can fix the cause in the study or on the command line, otherwise 1.
    pub fn code(&self) -> u8 {
        match self {
            CliError::Study(_) | CliError::Usage(_) | CliError::Table(_) => 2,
            CliError::Results(ResultsError::Occupied { .. } | ResultsError::Unusable { .. }) => 2,
            CliError::Store(StoreError::Unusable(_)) => 2,
            CliError::Results(ResultsError::Write(_))
            | CliError::Store(
                StoreError::Unwritten { .. } | StoreError::Busy { .. } | StoreError::Lost { .. },
            )
            | CliError::Write(_)
            | CliError::Threads(_)
            | CliError::Output(_) => 1,
        }
    }
}
