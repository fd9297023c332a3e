//! Python exceptions with the messages of the command line.

use std::ffi::CString;

use pyo3::create_exception;
use pyo3::exceptions::{
    PyFileExistsError, PyKeyboardInterrupt, PyOSError, PyRuntimeError, PyTypeError, PyUserWarning,
    PyValueError,
};
use pyo3::prelude::*;
use stickslip::CommandError;
use stickslip::engine::StoreError;
use stickslip::study;
use stickslip::table::{ResultsError, TableError, WriteError};

use crate::values::kind;

create_exception!(
    stickslip,
    StudyError,
    PyValueError,
    "Raised for an invalid study, machine or design.\n\n\
     The text is the message of the command line, with arguments in place of its options: place, \
     problem, what was found, and what is allowed. Each attribute is None if the message has no such part:\n\n\
     file: the study file, or the name of the argument.\n\
     line, column: position in the file, from 1.\n\
     key: the key, such as `model.parameters.speed_rad_s`, row and column of a table, or the argument.\n\
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
    /// An invalid argument.
    Argument(Box<Argument>),
    /// A study without a required part.
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

/// An invalid argument of Python, with the parts of the message.
#[derive(Debug)]
pub struct Argument {
    /// The argument, or the part of it that is wrong, such as `times_s[3]`.
    pub key: String,
    /// The problem, in a few words.
    pub problem: String,
    /// What was found.
    pub found: String,
    /// What is allowed.
    pub allowed: String,
}

impl Argument {
    fn text(&self) -> String {
        let Argument { key, problem, found, allowed } = self;
        format!("{key}: {problem}\n  found:   {found}\n  allowed: {allowed}")
    }
}

/// Returns the error for an argument with a wrong value, a `StudyError`.
pub fn refused(key: &str, problem: &str, found: &str, allowed: &str) -> Trouble {
    let [key, problem, found, allowed] = [key, problem, found, allowed].map(str::to_owned);
    Trouble::Argument(Box::new(Argument { key, problem, found, allowed }))
}

/// Returns the error for an argument of a wrong type, a `TypeError`.
pub fn wrong_type(key: &str, found: &Bound<'_, PyAny>, allowed: &str) -> PyErr {
    let found = format!("a value of type {}", kind(found));
    let problem = "wrong type".to_owned();
    let argument = Argument { key: key.to_owned(), problem, found, allowed: allowed.to_owned() };
    PyTypeError::new_err(argument.text())
}

/// Issues a `UserWarning` at the caller's line.
///
/// # Errors
/// Returns the exception of a filter that turns warnings into errors.
pub fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    // Text with a zero byte is not a C string; a path cannot contain one.
    let text = CString::new(text)?;
    PyErr::warn(py, py.get_type::<PyUserWarning>().as_any(), &text, 1)
}

/// What the command line calls an option, and what it is in Python.
const WORDS: [(&str, &str); 14] = [
    (", or - for standard input", ""),
    ("with --out DIR", "as `out`"),
    ("with --out FILE", "as `out`"),
    ("with --out", "as `out`"),
    ("or --recompute, which", "or `recompute=True`, which"),
    ("with --simulations DIR", "as `simulations`"),
    ("--simulations ", "`simulations` with "),
    ("after --tables", "in `tables`"),
    ("given with --tables", "given as `tables`"),
    ("the option --tables DIR", "the argument `tables`"),
    ("--grid G", "`grid`"),
    ("--samples SAMPLES", "`samples`"),
    ("--grid", "`grid`"),
    ("--samples", "`samples`"),
];

/// Replaces the options of the command line in a message by the arguments of Python.
fn in_python(text: &str) -> String {
    WORDS.iter().fold(text.to_owned(), |text, (option, argument)| text.replace(option, argument))
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

/// A table in memory cannot be written if values do not fit their columns.
impl From<WriteError> for Trouble {
    fn from(error: WriteError) -> Self {
        Trouble::Defect(format!("a defect of stickslip: {}", error.cause))
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
            Trouble::Argument(argument) => {
                Python::attach(|py| of_argument(py, &argument).unwrap_or_else(|other| other))
            }
            Trouble::Usage(text) => StudyError::new_err(in_python(&text)),
            Trouble::Occupied(text) => PyFileExistsError::new_err(in_python(&text)),
            Trouble::System(text) => PyOSError::new_err(in_python(&text)),
            Trouble::Interrupted => PyKeyboardInterrupt::new_err(()),
            Trouble::Defect(text) => PyRuntimeError::new_err(text),
        }
    }
}

fn of_study(py: Python<'_>, error: &study::StudyError) -> PyResult<PyErr> {
    let raised = StudyError::new_err(in_python(&error.to_string()));
    let value = raised.value(py);
    let key = Some(error.key()).filter(|key| !key.is_empty());
    value.setattr("file", error.file().display().to_string())?;
    value.setattr("line", error.line())?;
    value.setattr("column", error.column())?;
    value.setattr("key", key)?;
    value.setattr("problem", error.problem())?;
    value.setattr("found", error.found())?;
    value.setattr("allowed", error.allowed().map(in_python))?;
    Ok(raised)
}

fn of_argument(py: Python<'_>, argument: &Argument) -> PyResult<PyErr> {
    let raised = StudyError::new_err(argument.text());
    let value = raised.value(py);
    value.setattr("key", &argument.key)?;
    value.setattr("problem", &argument.problem)?;
    value.setattr("found", &argument.found)?;
    value.setattr("allowed", &argument.allowed)?;
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
