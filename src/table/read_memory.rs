//! Tables of a results directory, taken into memory in full.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use arrow_schema::Schema;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::errors::ParquetError;
use parquet::file::reader::FileReader;

use super::memory::MemoryTable;
use super::read::{Table, TableError};
use crate::study::{Bounds, Fault, check_pages, guarded, said};

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
            let all: Vec<usize> =
                (0..part.reader.metadata().file_metadata().schema_descr().num_columns()).collect();
            let file = File::open(path).map_err(|error| {
                refuse(Fault::new("this file cannot be read", error.to_string(), "a readable file"))
            })?;
            check_pages(Bounds::RESULTS, &file, part.reader.metadata(), &all).map_err(refuse)?;
            let read = || -> Result<_, ParquetError> {
                let builder = ParquetRecordBatchReaderBuilder::try_new(file)?;
                let own = builder.schema().clone();
                let batches = builder.with_batch_size(BATCH).build()?;
                Ok((own, batches.collect::<Result<Vec<_>, _>>()?))
            };
            let (own, read) =
                guarded(read).map_err(refuse)?.map_err(|error| refuse(said(&error)))?;
            schema.get_or_insert(own);
            batches.extend(read);
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
