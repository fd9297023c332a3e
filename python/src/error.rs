//! Python exceptions with the messages of the command line.

use pyo3::create_exception;
use pyo3::exceptions::{
    PyFileExistsError, PyKeyboardInterrupt, PyOSError, PyRuntimeError, PyValueError,
};
use pyo3::prelude::*;
use stickslip::CommandError;
use stickslip::engine::{EngineError, OutputDirError, StoreError};
use stickslip::study;
use stickslip::table::{ResultsError, TableError};

create_exception!(
    stickslip,
    StudyError,
    PyValueError,
    "Raised for an invalid study, machine or design.\n\n\
     The text is the message of the command line: place, problem, what was found, and what is \
     allowed. Each attribute is None if the message has no such part:\n\n\
     file: the study file, or the name of the argument.\n\
     line, column: position in the file, from 1.\n\
     key: the key, such as `model.parameters.speed_rad_s`, or row and column of a table.\n\
     problem: the problem, in a few words.\n\
     found: what was found.\n\
     allowed: what is allowed, or what to do."
);

/// The attributes of a `StudyError`, by name.
const PARTS: [&str; 7] = ["file", "line", "column", "key", "problem", "found", "allowed"];

/// An error before its conversion to a Python exception.
#[derive(Debug)]
pub enum Trouble {
    /// An invalid study or design.
    Study(study::StudyError),
    /// A study without a required part, or an invalid argument.
    Usage(String),
    /// A directory or file is in the way.
    Occupied(String),
    /// An error of the operating system.
    System(String),
    /// The computation was stopped; the exception of the signal handler replaces this one.
    Interrupted,
    /// A bug of the program.
    Defect(String),
}

impl From<study::StudyError> for Trouble {
    fn from(error: study::StudyError) -> Self {
        Trouble::Study(error)
    }
}

impl From<ResultsError> for Trouble {
    fn from(error: ResultsError) -> Self {
        match error {
            ResultsError::Occupied { .. } => Trouble::Occupied(error.to_string()),
            ResultsError::Unusable { .. } | ResultsError::Write(_) => {
                Trouble::System(error.to_string())
            }
        }
    }
}

impl From<StoreError> for Trouble {
    fn from(error: StoreError) -> Self {
        Trouble::System(error.to_string())
    }
}

impl From<TableError> for Trouble {
    fn from(error: TableError) -> Self {
        Trouble::System(error.to_string())
    }
}

impl From<OutputDirError> for Trouble {
    fn from(error: OutputDirError) -> Self {
        match error {
            OutputDirError::Results(error) => error.into(),
            OutputDirError::Store(error) => error.into(),
        }
    }
}

impl From<CommandError> for Trouble {
    fn from(error: CommandError) -> Self {
        match error {
            CommandError::Study(error) => error.into(),
            CommandError::Usage(text) => Trouble::Usage(text),
            CommandError::Results(error) => error.into(),
            CommandError::Table(error) => error.into(),
            CommandError::Store(error) => error.into(),
            CommandError::Write(_) | CommandError::Threads(_) | CommandError::Output(_) => {
                Trouble::System(error.to_string())
            }
        }
    }
}

impl From<arrow_schema::ArrowError> for Trouble {
    fn from(error: arrow_schema::ArrowError) -> Self {
        Trouble::Defect(format!("a defect of stickslip: {error}"))
    }
}

impl<E: Into<Trouble>> From<EngineError<E>> for Trouble {
    fn from(error: EngineError<E>) -> Self {
        match error {
            EngineError::Threads(error) => no_threads(error),
            EngineError::Sink(error) => error.into(),
            EngineError::Store(error) => error.into(),
        }
    }
}

/// Returns the error for worker threads that could not be started.
pub fn no_threads(error: impl std::fmt::Display) -> Trouble {
    Trouble::System(format!("cannot start the worker threads: {error}"))
}

impl From<Trouble> for PyErr {
    fn from(trouble: Trouble) -> PyErr {
        match trouble {
            Trouble::Study(error) => {
                Python::attach(|py| of_study(py, &error).unwrap_or_else(|other| other))
            }
            Trouble::Usage(text) => StudyError::new_err(text),
            Trouble::Occupied(text) => PyFileExistsError::new_err(text),
            Trouble::System(text) => PyOSError::new_err(text),
            Trouble::Interrupted => PyKeyboardInterrupt::new_err(()),
            Trouble::Defect(text) => PyRuntimeError::new_err(text),
        }
    }
}

fn of_study(py: Python<'_>, error: &study::StudyError) -> PyResult<PyErr> {
    let raised = StudyError::new_err(error.to_string());
    let value = raised.value(py);
    let key = Some(error.key()).filter(|key| !key.is_empty());
    value.setattr("file", error.file().display().to_string())?;
    value.setattr("line", error.line())?;
    value.setattr("column", error.column())?;
    value.setattr("key", key)?;
    value.setattr("problem", error.problem())?;
    value.setattr("found", error.found())?;
    value.setattr("allowed", error.allowed())?;
    Ok(raised)
}

/// Adds the exceptions to the module.
///
/// # Errors
/// Returns the exception of Python if an exception type cannot be created.
pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let class = module.py().get_type::<StudyError>();
    for part in PARTS {
        class.setattr(part, module.py().None())?;
    }
    module.add("StudyError", class)
}
