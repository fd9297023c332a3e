//! The files of a table: Parquet, written in parts with constant memory.

use std::fs::{self, File};
use std::io;
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_schema::{ArrowError, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;

use super::column::{Column, schema};
use super::durable_files::taken;
use super::file_entry::FileEntry;
use super::unfinished_table::{UnfinishedTable, part_name};
use super::writer::{BLOCK, Destination, TableWriter, WriteError};

/// Rows per row group.
const ROW_GROUP: usize = 2 * BLOCK;
/// Rows per file: 64 row groups. A larger table is a directory of files, `part-00000.parquet` and
/// so on. The writer holds the footer until a file is closed, up to 40 KiB for each row group,
/// which would grow with the table (50 MB for 10^7 rows); every reader also holds it. Parts have 30
/// to 100 MB: readers distribute them over cores, and an interrupted copy continues with the next
/// part.
const ROWS_PER_FILE: u64 = 64 * ROW_GROUP as u64;

/// The files of a table, which gets its name when it is finished.
///
/// Up to 2^19 rows, the table is a file. A larger table is a directory of files with 2^19 rows
/// each; the last file has fewer. The number of rows alone determines how they are divided.
pub struct TableFiles {
    schema: SchemaRef,
    provenance: String,
    path: PathBuf,
    /// The open part, closed before `unfinished` removes its directory, and the number of its rows.
    writer: ArrowWriter<File>,
    rows: u64,
    unfinished: UnfinishedTable,
    finished: Vec<FileEntry>,
    rows_per_file: u64,
}

impl Destination for TableFiles {
    fn write(&mut self, rows: Result<RecordBatch, ArrowError>) -> Result<(), WriteError> {
        let written = rows.map_err(io::Error::other).and_then(|rows| self.divide(&rows));
        written.map_err(|cause| WriteError { path: self.path.clone(), cause })
    }
}

impl TableFiles {
    /// Starts the table `path` with `provenance` as the value of the metadata key `stickslip`.
    pub(super) fn create(
        path: &Path,
        schema: SchemaRef,
        provenance: &str,
    ) -> Result<Self, WriteError> {
        let start = || -> io::Result<Self> {
            let unfinished = UnfinishedTable::create(path)?;
            Ok(TableFiles {
                writer: begin(&unfinished.part(0), &schema, provenance)?,
                schema,
                provenance: provenance.to_owned(),
                path: path.to_owned(),
                rows: 0,
                unfinished,
                finished: Vec::new(),
                rows_per_file: ROWS_PER_FILE,
            })
        };
        start().map_err(|cause| WriteError { path: path.to_owned(), cause })
    }

    /// Writes rows into the open part, and into further parts when it is full.
    fn divide(&mut self, rows: &RecordBatch) -> io::Result<()> {
        let mut first = 0;
        while first < rows.num_rows() {
            if self.rows == self.rows_per_file {
                let number = self.finished.len();
                let next = self.unfinished.part(number + 1);
                let next = begin(&next, &self.schema, &self.provenance)?;
                let full = mem::replace(&mut self.writer, next);
                self.finished.push(end(full, &self.unfinished.part(number), self.rows)?);
                self.rows = 0;
            }
            let room = self.rows_per_file - self.rows;
            let fitting = room.min((rows.num_rows() - first) as u64);
            self.writer.write(&rows.slice(first, fitting as usize))?;
            self.rows += fitting;
            first += fitting as usize;
        }
        Ok(())
    }

    /// Gives the table its name; `announce` gets the written files before. Unless an existing table
    /// is `replaced`, it must have the same bytes. Returns the files: the names relative to the
    /// table's directory, and their manifest entries.
    pub(super) fn finish(
        self,
        replaced: bool,
        announce: impl FnOnce(&[(String, FileEntry)]) -> io::Result<()>,
    ) -> Result<Vec<(String, FileEntry)>, WriteError> {
        let TableFiles { path, writer, rows, unfinished, mut finished, .. } = self;
        let finish = || -> io::Result<_> {
            finished.push(end(writer, &unfinished.part(finished.len()), rows)?);
            let names = unfinished.names(finished.len());
            let files: Vec<_> = names.into_iter().zip(finished).collect();
            announce(&files)?;
            match fs::symlink_metadata(&path) {
                Ok(_) if !replaced && is_table_of(&path, &files)? => {
                    unfinished.directory.close()?
                }
                Ok(_) if !replaced => return Err(taken()),
                Err(error) if !replaced && error.kind() != io::ErrorKind::NotFound => {
                    return Err(error);
                }
                _ => unfinished.publish(files.len())?,
            }
            Ok(files)
        };
        finish().map_err(|cause| WriteError { path: path.clone(), cause })
    }
}

impl<R> TableWriter<R, TableFiles> {
    /// Starts the table `path` with `provenance` as the value of the metadata key `stickslip`.
    ///
    /// # Errors
    /// Returns an error if the file cannot be created.
    pub fn create(
        path: &Path,
        columns: Vec<Column<R>>,
        provenance: &str,
    ) -> Result<Self, WriteError> {
        let files = TableFiles::create(path, schema(&columns), provenance)?;
        Ok(TableWriter::new(columns, files))
    }

    /// Changes the number of rows per file, before the first row is added.
    pub fn with_rows_per_file(mut self, rows_per_file: u64) -> Self {
        self.destination.rows_per_file = rows_per_file;
        self
    }

    /// Writes the remaining rows and gives the table its name. Returns its files: the names
    /// relative to the table's directory, and their manifest entries.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written or renamed.
    pub fn finish(self) -> Result<Vec<(String, FileEntry)>, WriteError> {
        self.close()?.finish(true, |_| Ok(()))
    }

    /// Finishes a table like [`Self::finish`], and calls `announce` with the written files before
    /// the table gets its name. If it may not be `replaced`, an existing table with the same bytes
    /// is left unchanged, and any other one is an error.
    ///
    /// # Errors
    /// Returns an error if the name is taken, if a file cannot be written or renamed, or if
    /// `announce` fails; the written files are then removed.
    pub fn finish_after(
        self,
        replaced: bool,
        announce: impl FnOnce(&[(String, FileEntry)]) -> io::Result<()>,
    ) -> Result<(), WriteError> {
        self.close()?.finish(replaced, announce).map(drop)
    }

    /// Discards all rows, and leaves an existing table unchanged.
    ///
    /// # Errors
    /// Returns an error if the written files cannot be removed.
    pub fn abandon(self) -> Result<(), WriteError> {
        let TableFiles { path, writer, unfinished, .. } = self.destination;
        drop(writer);
        unfinished.directory.close().map_err(|cause| WriteError { path, cause })
    }
}

/// Starts a file.
fn begin(path: &Path, schema: &SchemaRef, provenance: &str) -> io::Result<ArrowWriter<File>> {
    let provenance = KeyValue::new("stickslip".to_owned(), provenance.to_owned());
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_max_row_group_row_count(Some(ROW_GROUP))
        .set_created_by(concat!("stickslip ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(vec![provenance]))
        .build();
    let file = File::create_new(path)?;
    ArrowWriter::try_new(file, Arc::clone(schema), Some(properties)).map_err(io::Error::other)
}

/// Writes the footer and syncs the file.
fn end(writer: ArrowWriter<File>, path: &Path, rows: u64) -> io::Result<FileEntry> {
    writer.into_inner()?.sync_all()?;
    FileEntry::of(path, Some(rows))
}

/// Returns whether a table on disk consists of exactly these parts, byte for byte.
fn is_table_of(path: &Path, parts: &[(String, FileEntry)]) -> io::Result<bool> {
    if let [(_, part)] = parts {
        return part.is_at(path);
    }
    if !fs::symlink_metadata(path)?.is_dir() || fs::read_dir(path)?.count() != parts.len() {
        return Ok(false);
    }
    for (number, (_, part)) in parts.iter().enumerate() {
        match part.is_at(&path.join(part_name(number))) {
            Ok(true) => {}
            Ok(false) => return Ok(false),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(error),
        }
    }
    Ok(true)
}
