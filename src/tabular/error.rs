//! The error of a table that is refused, with its line, row and column, also for a panic of the Parquet library.

use std::panic::{self, AssertUnwindSafe};

use serde::Serialize;

use crate::sanitize::shorten;

/// A fault without its location.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Fault {
    /// The fault in a few words.
    pub problem: String,
    /// The value or content that was found.
    pub found: Option<String>,
    /// The allowed values or content.
    pub allowed: Option<String>,
}

impl Fault {
    /// Creates a fault with all three parts.
    pub fn new(
        problem: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Fault {
        Fault { problem: problem.into(), found: Some(found.into()), allowed: Some(allowed.into()) }
    }

    /// Returns the fault of a damaged Parquet file, or of a file in another format.
    pub fn damaged(found: &str) -> Fault {
        Fault::new("not a readable Parquet file", shorten(found), "a complete Parquet file")
    }
}

/// A fault with its location in a table.
#[derive(Debug)]
pub(crate) struct Refusal {
    /// The line of the file, counted from 1, if it is a text file.
    pub line: Option<usize>,
    /// The row, counted from 0.
    pub row: Option<usize>,
    /// The name of the column.
    pub column: Option<String>,
    /// The fault.
    pub fault: Box<Fault>,
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Refusal {
        Refusal { line: None, row: None, column: None, fault: Box::new(fault) }
    }
}

/// Calls the Parquet library, which panics on some damaged files, for example if a value refers to a missing dictionary
/// entry. The values that `call` changes must not be used after a fault.
pub(super) fn guarded<T>(call: impl FnOnce() -> T) -> Result<T, Fault> {
    // The caller drops every value that `call` may have left half changed.
    panic::catch_unwind(AssertUnwindSafe(call))
        .map_err(|_| Fault::damaged("contents that the Parquet library cannot decode"))
}
