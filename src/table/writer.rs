//! Writes one table row by row, with constant memory into files or into memory: record batches with the columns and the
//! provenance of the Parquet files.

use std::collections::HashMap;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use arrow_array::builder::StringDictionaryBuilder;
use arrow_array::cast::AsArray;
use arrow_array::types::Int32Type;
use arrow_array::{RecordBatch, StringArray, TypedDictionaryArray};
use arrow_schema::{ArrowError, Schema, SchemaRef};
use arrow_select::concat::concat_batches;
use thiserror::Error;

use super::column::{Column, batch, schema};

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

/// Number of rows in a batch.
const BATCH: usize = 65_536;

/// A table in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct MemoryTable {
    /// The schema, with unit and meaning of each column, and the provenance under the
    /// metadata key `stickslip`.
    pub schema: SchemaRef,
    /// The rows, in order.
    pub batches: Vec<RecordBatch>,
}

impl MemoryTable {
    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }
}

/// The rows of a table in memory.
pub struct MemoryRows {
    schema: SchemaRef,
    /// Batches of few rows, until they are enough for a full batch.
    pieces: Vec<RecordBatch>,
    batches: Vec<RecordBatch>,
}

impl Destination for MemoryRows {
    fn write(&mut self, rows: Result<RecordBatch, ArrowError>) -> Result<(), WriteError> {
        let rows = rows.and_then(|rows| rows.with_schema(Arc::clone(&self.schema)));
        self.pieces.push(rows.map_err(unwritten)?);
        let rows: usize = self.pieces.iter().map(RecordBatch::num_rows).sum();
        if rows < BATCH { Ok(()) } else { self.join().map_err(unwritten) }
    }
}

/// Returns the error for values that do not fit their columns.
fn unwritten(error: ArrowError) -> WriteError {
    WriteError { path: PathBuf::from("a table in memory"), cause: io::Error::other(error) }
}

impl MemoryRows {
    /// Starts a table with `provenance` as the value of the metadata key `stickslip`.
    pub(super) fn new(schema: &Schema, provenance: &str) -> Self {
        let metadata = HashMap::from([("stickslip".to_owned(), provenance.to_owned())]);
        Self::of_schema(Arc::new(schema.clone().with_metadata(metadata)))
    }

    pub(super) fn of_schema(schema: SchemaRef) -> Self {
        MemoryRows { schema, pieces: Vec::new(), batches: Vec::new() }
    }

    /// Joins the pieces into one batch.
    fn join(&mut self) -> Result<(), ArrowError> {
        let pieces = std::mem::take(&mut self.pieces);
        if !pieces.is_empty() {
            self.batches.push(concat_batches(&self.schema, &pieces)?);
        }
        Ok(())
    }

    /// Returns the table. Each column of words has one dictionary for all batches, without repeated
    /// words: some readers use the dictionary of the first batch for all batches, or treat each
    /// entry as a different word.
    pub(super) fn finish(self) -> Result<MemoryTable, WriteError> {
        self.with_common_words().map_err(unwritten)
    }

    fn with_common_words(mut self) -> Result<MemoryTable, ArrowError> {
        self.join()?;
        let MemoryRows { schema, mut batches, .. } = self;
        for index in 0..schema.fields().len() {
            let parts: Option<Vec<_>> = batches
                .iter()
                .map(|batch| batch.column(index).as_dictionary_opt::<Int32Type>()?.downcast_dict())
                .collect();
            let Some(parts) = parts else { continue };
            let mut words = StringDictionaryBuilder::<Int32Type>::new();
            parts.into_iter().for_each(|part: TypedDictionaryArray<'_, _, StringArray>| {
                words.extend(part);
            });
            let words = words.finish();
            let mut first = 0;
            for batch in &mut batches {
                let mut columns = batch.columns().to_vec();
                columns[index] = Arc::new(words.slice(first, batch.num_rows()));
                first += batch.num_rows();
                *batch = RecordBatch::try_new(batch.schema(), columns)?;
            }
        }
        Ok(MemoryTable { schema, batches })
    }
}

impl<R> TableWriter<R, MemoryRows> {
    /// Starts a table in memory with `provenance` as the value of the metadata key `stickslip`.
    pub fn in_memory(columns: Vec<Column<R>>, provenance: &str) -> Self {
        let rows = MemoryRows::new(&schema(&columns), provenance);
        TableWriter::new(columns, rows)
    }

    /// Returns the table.
    ///
    /// # Errors
    /// Returns an error if values do not fit their column, which is a bug.
    pub fn finish(self) -> Result<MemoryTable, WriteError> {
        self.close()?.finish()
    }
}

/// Creates a table from rows.
///
/// # Errors
/// Returns an error if values do not fit their column, which is a bug.
pub fn in_memory<R>(
    columns: Vec<Column<R>>,
    provenance: &str,
    rows: impl IntoIterator<Item = R>,
) -> Result<MemoryTable, WriteError> {
    let mut table = TableWriter::in_memory(columns, provenance);
    table.extend(rows)?;
    table.finish()
}
