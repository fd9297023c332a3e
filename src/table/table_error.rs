//! Why a table cannot be read.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::sanitize::{shorten, shown_path};
use crate::tabular::Fault;

/// Why a table cannot be read: file, column, what was found and what is allowed.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "{}: {}{problem}\n  found:   {found}\n  allowed: {allowed}",
    shown_path(file),
    place(column)
)]
pub struct TableError {
    /// The file, or the directory where there is no such table.
    pub file: PathBuf,
    /// The column, where one is meant.
    pub column: Option<String>,
    /// What is wrong.
    pub problem: String,
    /// What was found.
    pub found: String,
    /// What is allowed, or what to do.
    pub allowed: String,
}

fn place(column: &Option<String>) -> String {
    column.as_ref().map_or_else(String::new, |name| format!("column {}: ", shorten(name)))
}

impl TableError {
    pub(crate) fn new(file: &Path, column: Option<&str>, fault: Fault) -> Self {
        TableError {
            file: file.to_owned(),
            column: column.map(str::to_owned),
            problem: fault.problem,
            found: fault.found.unwrap_or_else(|| "this file".to_owned()),
            allowed: fault.allowed.unwrap_or_else(|| "the file that was written".to_owned()),
        }
    }
}
