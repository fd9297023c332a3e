//! Reads whole tables of a results directory into memory.

use std::path::Path;
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_schema::{Schema, SchemaRef};
use arrow_select::concat::concat_batches;

use super::memory_table::MemoryTable;
use super::read::Table;
use super::table_error::TableError;
use crate::tabular::Fault;

/// The number of rows in a batch.
const BATCH: usize = 65_536;

impl Table {
    /// The table in memory, in full, as it was when it was written.
    ///
    /// # Errors
    /// Returns an error if a file is damaged or differs from the one that was written.
    pub fn in_memory(&self) -> Result<MemoryTable, TableError> {
        let mut schema = None;
        let mut batches = Vec::new();
        for (path, rows) in &self.parts {
            let refuse = |fault| TableError::new(path, None, fault);
            let part = self.open_part(path, *rows)?;
            let own = part.written_schema().map_err(refuse)?;
            let all: Vec<usize> = (0..own.fields().len()).collect();
            let mut read = Vec::new();
            for batch in part.batches(&all, &own).map_err(refuse)? {
                read.push(batch.map_err(refuse)?);
                let rows: usize = read.iter().map(RecordBatch::num_rows).sum();
                if rows >= BATCH {
                    batches.push(joined(&own, &read).map_err(refuse)?);
                    read.clear();
                }
            }
            if !read.is_empty() {
                batches.push(joined(&own, &read).map_err(refuse)?);
            }
            schema.get_or_insert(own);
        }
        // An open table has at least one part.
        let schema = schema.unwrap_or_else(|| Arc::new(Schema::empty()));
        MemoryTable::new(schema, batches).map_err(|error| {
            let problem = "the parts of this table have different columns";
            let file = self.parts.first().map_or(Path::new(""), |(path, _)| path);
            TableError::new(
                file,
                None,
                Fault::new(problem, error.to_string(), "the files that were written"),
            )
        })
    }
}

/// Concatenates batches, and adds the column metadata of the file.
fn joined(schema: &SchemaRef, batches: &[RecordBatch]) -> Result<RecordBatch, Fault> {
    concat_batches(schema, batches).map_err(|error| Fault::damaged(&error.to_string()))
}
