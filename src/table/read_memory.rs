//! Tables of a results directory, taken into memory in full.

use std::path::Path;
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_schema::{Schema, SchemaRef};
use arrow_select::concat::concat_batches;

use super::memory::MemoryTable;
use super::read::Table;
use super::table_error::TableError;
use crate::tabular::Fault;

/// Rows of a batch.
const BATCH: usize = 65_536;

impl Table {
    /// The table in memory, in full, as it was when it was written.
    ///
    /// # Errors
    /// A file that is damaged, or not the one that was written.
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
        // There is a part, or the table could not have been opened.
        let schema = schema.unwrap_or_else(|| Arc::new(Schema::empty()));
        MemoryTable::new(schema, batches).map_err(|error| {
            let problem = "the parts of this table do not fit together";
            let file = self.parts.first().map_or(Path::new(""), |(path, _)| path);
            TableError::new(
                file,
                None,
                Fault::new(problem, error.to_string(), "the files that were written"),
            )
        })
    }
}

/// One batch of several, with what the file says of its columns.
fn joined(schema: &SchemaRef, batches: &[RecordBatch]) -> Result<RecordBatch, Fault> {
    concat_batches(schema, batches).map_err(|error| Fault::damaged(&error.to_string()))
}
