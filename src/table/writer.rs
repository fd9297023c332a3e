//! Writes one table row by row with constant memory, into files or into memory.

use std::io;
use std::path::PathBuf;

use arrow_array::RecordBatch;
use arrow_schema::ArrowError;
use thiserror::Error;

use super::column::{Column, batch};

/// Rows per write, because rows take more memory than columns. This number alone determines the boundaries of pages and row
/// groups, so that the bytes do not depend on how many runs were computed at a time.
pub(super) const BLOCK: usize = 4096;

/// Why a table could not be written.
#[derive(Debug, Error)]
#[error("cannot write {}: {cause}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The error of the operating system, or of the Parquet library, which the former usually causes.
    pub cause: io::Error,
}

/// Where the rows of a table go: [`super::TableFiles`] or [`super::MemoryRows`].
pub trait Destination: Send {
    /// Takes further rows, or the reason why they form no columns, which is a bug.
    ///
    /// # Errors
    /// Returns an error if the rows cannot be written.
    fn write(&mut self, rows: Result<RecordBatch, ArrowError>) -> Result<(), WriteError>;
}

/// Writes a table.
pub struct TableWriter<R, D> {
    columns: Vec<Column<R>>,
    rows: Vec<R>,
    pub(super) destination: D,
}

impl<R, D: Destination> TableWriter<R, D> {
    /// Starts a table.
    pub(super) fn new(columns: Vec<Column<R>>, destination: D) -> Self {
        TableWriter { columns, rows: Vec::new(), destination }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Returns an error if the table cannot be written.
    pub fn push(&mut self, row: R) -> Result<(), WriteError> {
        self.rows.push(row);
        if self.rows.len() < BLOCK { Ok(()) } else { self.flush() }
    }

    /// Adds rows.
    ///
    /// # Errors
    /// Returns an error if the table cannot be written.
    pub fn extend(&mut self, rows: impl IntoIterator<Item = R>) -> Result<(), WriteError> {
        rows.into_iter().try_for_each(|row| self.push(row))
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let rows = batch(&self.columns, &self.rows);
        self.rows.clear();
        self.destination.write(rows)
    }

    /// Passes the remaining rows on, and returns the destination with all rows.
    pub(super) fn close(mut self) -> Result<D, WriteError> {
        self.flush()?;
        Ok(self.destination)
    }
}
