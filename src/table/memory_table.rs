//! Tables in memory: record batches with the columns and the provenance of the Parquet files.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use arrow_array::builder::StringDictionaryBuilder;
use arrow_array::cast::AsArray;
use arrow_array::types::Int32Type;
use arrow_array::{RecordBatch, StringArray, TypedDictionaryArray};
use arrow_schema::{ArrowError, Schema, SchemaRef};
use arrow_select::concat::concat_batches;

use super::column::{Column, batch, schema};
use super::read::Table;
use super::table_error::TableError;
use crate::tabular::Fault;

/// Number of rows in a batch.
const BATCH: usize = 65_536;
/// Number of rows that are buffered before they become columns, because rows take more memory than
/// columns.
const WAITING: usize = 4096;

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

    /// Creates a table from batches. Each column of words has one dictionary for all batches,
    /// without repeated words: some readers use the dictionary of the first batch for all batches,
    /// or treat each entry as a different word.
    pub(super) fn new(
        schema: SchemaRef,
        mut batches: Vec<RecordBatch>,
    ) -> Result<Self, ArrowError> {
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

/// Builds a table in memory row by row.
pub struct MemoryWriter<R> {
    columns: Vec<Column<R>>,
    schema: SchemaRef,
    rows: Vec<R>,
    /// Batches of few rows, until they are enough for a full batch.
    pieces: Vec<RecordBatch>,
    batches: Vec<RecordBatch>,
}

impl<R> MemoryWriter<R> {
    /// Creates an empty table with `provenance` as the value of the metadata key `stickslip`.
    pub fn new(columns: Vec<Column<R>>, provenance: String) -> Self {
        let schema = schema(&columns).as_ref().clone();
        let metadata = HashMap::from([("stickslip".to_owned(), provenance)]);
        let schema = Arc::new(schema.with_metadata(metadata));
        let (rows, pieces, batches) = (Vec::new(), Vec::new(), Vec::new());
        MemoryWriter { columns, schema, rows, pieces, batches }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Returns an error if the values of a column do not fit its type, which is a bug.
    pub fn push(&mut self, row: R) -> Result<(), ArrowError> {
        self.rows.push(row);
        if self.rows.len() < WAITING { Ok(()) } else { self.flush() }
    }

    fn flush(&mut self) -> Result<(), ArrowError> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let piece = batch(&self.columns, &self.rows)?.with_schema(Arc::clone(&self.schema))?;
        self.rows.clear();
        self.pieces.push(piece);
        if self.pieces.len() * WAITING >= BATCH { self.join() } else { Ok(()) }
    }

    /// Joins the pieces into one batch.
    fn join(&mut self) -> Result<(), ArrowError> {
        let pieces = std::mem::take(&mut self.pieces);
        if !pieces.is_empty() {
            self.batches.push(concat_batches(&self.schema, &pieces)?);
        }
        Ok(())
    }

    /// Returns the table.
    ///
    /// # Errors
    /// Returns an error in the cases of [`MemoryWriter::push`].
    pub fn finish(mut self) -> Result<MemoryTable, ArrowError> {
        self.flush()?;
        self.join()?;
        MemoryTable::new(self.schema, self.batches)
    }
}

/// Creates a table from rows.
///
/// # Errors
/// Returns an error in the cases of [`MemoryWriter::push`].
pub fn in_memory<R>(
    columns: Vec<Column<R>>,
    provenance: String,
    rows: impl IntoIterator<Item = R>,
) -> Result<MemoryTable, ArrowError> {
    let mut table = MemoryWriter::new(columns, provenance);
    for row in rows {
        table.push(row)?;
    }
    table.finish()
}

impl Table {
    /// The table in memory, in full, as it was when it was written.
    pub fn in_memory(&self) -> Result<MemoryTable, TableError> {
        let mut schema = None;
        let mut batches = Vec::new();
        for (path, rows) in &self.parts {
            let refuse = |fault| TableError::new(path, None, fault);
            let part = self.open_part(path, *rows)?;
            let own = part.written_schema().map_err(refuse)?;
            let all: Vec<usize> = (0..own.fields().len()).collect();
            // Adds the metadata of the columns of the file.
            let joined = |read: &[RecordBatch]| {
                let joined = concat_batches(&own, read);
                joined.map_err(|error| refuse(Fault::damaged(&error.to_string())))
            };
            let mut read = Vec::new();
            for batch in part.batches(&all, &own).map_err(refuse)? {
                read.push(batch.map_err(refuse)?);
                let rows: usize = read.iter().map(RecordBatch::num_rows).sum();
                if rows >= BATCH {
                    batches.push(joined(&read)?);
                    read.clear();
                }
            }
            if !read.is_empty() {
                batches.push(joined(&read)?);
            }
            schema.get_or_insert(own);
        }
        // An open table has at least one part.
        let schema = schema.unwrap_or_else(|| Arc::new(Schema::empty()));
        MemoryTable::new(schema, batches).map_err(|error| {
            let problem = "the parts of this table have different columns";
            let file = self.parts.first().map_or(Path::new(""), |(path, _)| path);
            let allowed = "the files that were written";
            TableError::new(file, None, Fault::new(problem, error.to_string(), allowed))
        })
    }
}
