//! Where tables of designs and of measured runs come from.

use std::path::Path;

use arrow_array::RecordBatchReader;

use super::error::StudyError;
use super::file::read_file::read_bytes;
use super::file::table_input::cells_in_memory;
use super::file::values::Entry;
use crate::tabular::{Cells, Limits, Refusal, check_name};

/// A table that a study reads. Messages call a table that is no file by its name here.
pub enum TableSource<'a> {
    /// A CSV or Parquet file.
    File(&'a Path),
    /// The name and an Arrow table.
    Arrow(&'a str, Box<dyn RecordBatchReader + 'a>),
    /// The name, the columns, and rows with one value per column, `None` if it is missing.
    Rows(&'a str, Vec<String>, Vec<Vec<Option<Entry>>>),
}

impl<'a, P: AsRef<Path> + ?Sized> From<&'a P> for TableSource<'a> {
    fn from(path: &'a P) -> Self {
        TableSource::File(path.as_ref())
    }
}

/// Reads the cells of a table within limits.
type Read<'a> = Box<dyn FnOnce(&Limits<'_>) -> Result<Cells, Refusal> + 'a>;

impl<'a> TableSource<'a> {
    /// Opens the table under its name in messages. `allowed` says in words which files can be read.
    pub(super) fn open(self, allowed: &str) -> Result<(&'a Path, Read<'a>), StudyError> {
        Ok(match self {
            TableSource::File(path) => {
                let refuse = |fault| StudyError::about_file(path, fault);
                check_name(path, allowed).map_err(refuse)?;
                let bytes = read_bytes(path).map_err(refuse)?;
                (path, Box::new(move |limits| Cells::read(path, bytes, limits)))
            }
            TableSource::Arrow(name, reader) => {
                (name.as_ref(), Box::new(move |limits| Cells::of_arrow(reader, limits)))
            }
            TableSource::Rows(name, columns, rows) => {
                (name.as_ref(), Box::new(move |limits| cells_in_memory(columns, rows, limits)))
            }
        })
    }
}
