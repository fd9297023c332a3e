//! Writes one table to a Parquet file, in rows as they come, with memory that does not grow.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use arrow::error::ArrowError;
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use thiserror::Error;

use super::column::{Column, batch, schema};

/// Rows per write. Pages and row groups begin where they do because of this number alone, so that
/// the bytes do not depend on how many runs were farmed at a time.
const BLOCK: usize = 4096;
/// Rows per row group.
const ROW_GROUP: usize = 2 * BLOCK;

/// Why a table could not be written.
#[derive(Debug, Error)]
#[error("cannot write {}: {cause}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// What went wrong.
    pub cause: WriteCause,
}

/// What went wrong when a table was written.
#[derive(Debug, Error)]
pub enum WriteCause {
    /// The operating system refused.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The Parquet library failed, mostly because the operating system refused.
    #[error("{0}")]
    Parquet(#[from] ParquetError),
    /// The Arrow library failed.
    #[error("{0}")]
    Arrow(#[from] ArrowError),
}

/// A table being written under a temporary name.
pub struct TableWriter<R> {
    columns: Vec<Column<R>>,
    path: PathBuf,
    temporary: PathBuf,
    writer: ArrowWriter<File>,
    rows: Vec<R>,
    count: u64,
}

impl<R> TableWriter<R> {
    /// Starts the table `path` with `provenance` as the value of the metadata key `stickslip`.
    ///
    /// # Errors
    /// Where the file cannot be created.
    pub fn create(
        path: &Path,
        columns: Vec<Column<R>>,
        provenance: &str,
    ) -> Result<Self, WriteError> {
        let temporary = path.with_added_extension("partial");
        let start = || -> Result<ArrowWriter<File>, WriteCause> {
            let properties = WriterProperties::builder()
                .set_compression(Compression::SNAPPY)
                .set_max_row_group_row_count(Some(ROW_GROUP))
                .set_created_by(concat!("stickslip ", env!("CARGO_PKG_VERSION")).to_owned())
                .set_key_value_metadata(Some(vec![KeyValue::new(
                    "stickslip".to_owned(),
                    provenance.to_owned(),
                )]))
                .build();
            let file = File::create(&temporary)?;
            Ok(ArrowWriter::try_new(file, schema(&columns), Some(properties))?)
        };
        let writer = start().map_err(|cause| WriteError { path: path.to_owned(), cause })?;
        let rows = Vec::with_capacity(BLOCK);
        Ok(TableWriter { path: path.to_owned(), columns, temporary, writer, rows, count: 0 })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn push(&mut self, row: R) -> Result<(), WriteError> {
        self.rows.push(row);
        self.count += 1;
        if self.rows.len() == BLOCK { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        let write = |columns: &[Column<R>], rows: &[R], writer: &mut ArrowWriter<File>| {
            writer.write(&batch(columns, rows)?)?;
            Ok(())
        };
        write(&self.columns, &self.rows, &mut self.writer)
            .map_err(|cause| WriteError { path: self.path.clone(), cause })?;
        self.rows.clear();
        Ok(())
    }

    /// Writes what is left, syncs the file and gives it its name. Returns the number of rows.
    ///
    /// # Errors
    /// Where the file cannot be written or renamed.
    pub fn finish(mut self) -> Result<u64, WriteError> {
        self.flush()?;
        let TableWriter { path, temporary, writer, count, .. } = self;
        let close = || -> Result<(), WriteCause> {
            writer.into_inner()?.sync_all()?;
            fs::rename(&temporary, &path)?;
            Ok(())
        };
        close().map_err(|cause| WriteError { path, cause })?;
        Ok(count)
    }
}
