//! What is wrong with a table: in words, and in which row and column.

use crate::foreign::shorten;

/// What is wrong, before it is known where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    /// What is wrong, in a few words.
    pub problem: String,
    /// What stands there.
    pub found: Option<String>,
    /// What could stand there.
    pub allowed: Option<String>,
}

impl Fault {
    /// A fault with all three parts.
    pub fn new(
        problem: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Fault {
        Fault { problem: problem.into(), found: Some(found.into()), allowed: Some(allowed.into()) }
    }

    /// A file that is no Parquet file, or a damaged one.
    pub fn damaged(found: &str) -> Fault {
        Fault::new("not a readable Parquet file", shorten(found), "a Parquet file that is whole")
    }
}

/// What is wrong in a table, and where.
#[derive(Debug)]
pub(crate) struct Refusal {
    /// The line of the file, where it has lines.
    pub line: Option<usize>,
    /// The row, counted from 0.
    pub row: Option<usize>,
    /// The name of the column.
    pub column: Option<String>,
    /// What is wrong there.
    pub fault: Box<Fault>,
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Refusal {
        Refusal { line: None, row: None, column: None, fault: Box::new(fault) }
    }
}
