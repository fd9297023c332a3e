//! Writes one table as Parquet, row by row, with constant memory.

use std::fs::{self, File};
use std::io;
use std::mem;
use std::path::{Path, PathBuf};

use arrow_schema::ArrowError;
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use thiserror::Error;

use super::atomic_files::taken;
use super::column::{Column, batch, schema};
use super::file_entry::FileEntry;
use super::unfinished_table::{UnfinishedTable, part_name};

/// Rows per write. This number alone determines the boundaries of pages and row groups, so that the
/// bytes do not depend on how many runs were computed at a time.
const BLOCK: usize = 4096;
/// Rows per row group.
const ROW_GROUP: usize = 2 * BLOCK;
/// Rows per file: 64 row groups. A larger table is a directory of files, `part-00000.parquet` and
/// so on. The writer holds the footer until a file is closed, up to 40 KiB for each row group,
/// which would grow with the table (50 MB for 10^7 rows); every reader also holds it. Parts have 30
/// to 100 MB: readers distribute them over cores, and an interrupted copy continues with the next
/// part.
const ROWS_PER_FILE: u64 = 64 * ROW_GROUP as u64;

/// Why a table could not be written.
#[derive(Debug, Error)]
#[error("cannot write {}: {cause}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The cause.
    pub cause: WriteCause,
}

/// The cause of a failed write.
#[derive(Debug, Error)]
pub enum WriteCause {
    /// An error of the operating system.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// An error of the Parquet library, usually caused by the operating system.
    #[error("{0}")]
    Parquet(#[from] ParquetError),
    /// An error of the Arrow library.
    #[error("{0}")]
    Arrow(#[from] ArrowError),
}

/// Writes a table, which gets its name when it is finished.
///
/// Up to 2^19 rows, the table is a file. A larger table is a directory of files with 2^19 rows
/// each; the last file has fewer. The number of rows alone determines how they are divided.
pub struct TableWriter<R> {
    columns: Vec<Column<R>>,
    provenance: String,
    path: PathBuf,
    rows: Vec<R>,
    // Closed before `unfinished` removes its directory.
    part: OpenPart,
    unfinished: UnfinishedTable,
    finished: Vec<FileEntry>,
    rows_per_file: u64,
}

/// The file that is being written.
struct OpenPart {
    writer: ArrowWriter<File>,
    rows: u64,
}

impl<R> TableWriter<R> {
    /// Starts the table `path` with `provenance` as the value of the metadata key `stickslip`.
    ///
    /// # Errors
    /// Returns an error if the file cannot be created.
    pub fn create(
        path: &Path,
        columns: Vec<Column<R>>,
        provenance: &str,
    ) -> Result<Self, WriteError> {
        let start = || -> Result<(UnfinishedTable, OpenPart), WriteCause> {
            let unfinished = UnfinishedTable::create(path)?;
            let part = OpenPart::create(&unfinished.part(0), &columns, provenance)?;
            Ok((unfinished, part))
        };
        let (unfinished, part) =
            start().map_err(|cause| WriteError { path: path.to_owned(), cause })?;
        Ok(TableWriter {
            columns,
            provenance: provenance.to_owned(),
            path: path.to_owned(),
            rows: Vec::with_capacity(BLOCK),
            part,
            unfinished,
            finished: Vec::new(),
            rows_per_file: ROWS_PER_FILE,
        })
    }

    /// Changes the number of rows per file, before the first row is added.
    pub fn with_rows_per_file(self, rows_per_file: u64) -> Self {
        TableWriter { rows_per_file, ..self }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn push(&mut self, row: R) -> Result<(), WriteError> {
        if self.part.rows + self.rows.len() as u64 == self.rows_per_file {
            self.flush().and_then(|()| self.next_part()).map_err(|cause| self.error(cause))?;
        }
        self.rows.push(row);
        if self.rows.len() < BLOCK {
            return Ok(());
        }
        self.flush().map_err(|cause| self.error(cause))
    }

    /// Finishes a table like [`Self::finish_after`], but never replaces anything: an existing table
    /// with the same bytes is left unchanged.
    ///
    /// # Errors
    /// Returns an error if the name is taken, if a file cannot be written or renamed, or if
    /// `announce` fails.
    pub fn finish_once(
        self,
        announce: impl FnOnce(&[(String, FileEntry)]) -> io::Result<()>,
    ) -> Result<(), WriteError> {
        self.finish_by(announce, |path, unfinished, files| match fs::symlink_metadata(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                unfinished.publish(files.len())
            }
            Err(error) => Err(error),
            Ok(_) if is_table_of(path, files)? => unfinished.directory.close(),
            Ok(_) => Err(taken()),
        })?;
        Ok(())
    }

    /// Discards all rows, and leaves an existing table unchanged.
    ///
    /// # Errors
    /// Returns an error if the written files cannot be removed.
    pub fn abandon(self) -> Result<(), WriteError> {
        let TableWriter { path, part, unfinished, .. } = self;
        drop(part);
        unfinished.directory.close().map_err(|error| WriteError { path, cause: error.into() })
    }

    fn error(&self, cause: WriteCause) -> WriteError {
        WriteError { path: self.path.clone(), cause }
    }

    fn flush(&mut self) -> Result<(), WriteCause> {
        self.part.writer.write(&batch(&self.columns, &self.rows)?)?;
        self.part.rows += self.rows.len() as u64;
        self.rows.clear();
        Ok(())
    }

    fn next_part(&mut self) -> Result<(), WriteCause> {
        let number = self.finished.len();
        let next =
            OpenPart::create(&self.unfinished.part(number + 1), &self.columns, &self.provenance)?;
        let full = mem::replace(&mut self.part, next);
        self.finished.push(full.close(&self.unfinished.part(number))?);
        Ok(())
    }

    /// Writes the remaining rows and gives the table its name. Returns its files: the names
    /// relative to the table's directory, and their manifest entries.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written or renamed.
    pub fn finish(self) -> Result<Vec<(String, FileEntry)>, WriteError> {
        self.finish_after(|_| Ok(()))
    }

    /// Finishes a table like [`Self::finish`], and calls `announce` with the written files before
    /// the table gets its name.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written or renamed, or if `announce` fails; the table
    /// is then removed.
    pub fn finish_after(
        self,
        announce: impl FnOnce(&[(String, FileEntry)]) -> io::Result<()>,
    ) -> Result<Vec<(String, FileEntry)>, WriteError> {
        self.finish_by(announce, |_, unfinished, files| unfinished.publish(files.len()))
    }

    fn finish_by(
        mut self,
        announce: impl FnOnce(&[(String, FileEntry)]) -> io::Result<()>,
        publish: impl FnOnce(&Path, UnfinishedTable, &[(String, FileEntry)]) -> io::Result<()>,
    ) -> Result<Vec<(String, FileEntry)>, WriteError> {
        self.flush().map_err(|cause| self.error(cause))?;
        let TableWriter { path, part, unfinished, mut finished, .. } = self;
        let finish = || -> Result<_, WriteCause> {
            finished.push(part.close(&unfinished.part(finished.len()))?);
            let names = unfinished.names(finished.len());
            let files: Vec<_> = names.into_iter().zip(finished).collect();
            announce(&files)?;
            publish(&path, unfinished, &files)?;
            Ok(files)
        };
        finish().map_err(|cause| WriteError { path: path.clone(), cause })
    }
}

/// Returns whether a table on disk consists of exactly these parts, byte for byte.
fn is_table_of(path: &Path, parts: &[(String, FileEntry)]) -> io::Result<bool> {
    let is_part = |path: &Path, part: &FileEntry| -> io::Result<bool> {
        let found = fs::symlink_metadata(path)?;
        Ok(found.is_file() && found.len() == part.bytes && FileEntry::of(path, part.rows)? == *part)
    };
    if let [(_, part)] = parts {
        return is_part(path, part);
    }
    if !fs::symlink_metadata(path)?.is_dir() || fs::read_dir(path)?.count() != parts.len() {
        return Ok(false);
    }
    for (number, (_, part)) in parts.iter().enumerate() {
        match is_part(&path.join(part_name(number)), part) {
            Ok(true) => {}
            Ok(false) => return Ok(false),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(error),
        }
    }
    Ok(true)
}

impl OpenPart {
    fn create<R>(path: &Path, columns: &[Column<R>], provenance: &str) -> Result<Self, WriteCause> {
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_max_row_group_row_count(Some(ROW_GROUP))
            .set_created_by(concat!("stickslip ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(vec![KeyValue::new(
                "stickslip".to_owned(),
                provenance.to_owned(),
            )]))
            .build();
        let file = File::create_new(path)?;
        Ok(OpenPart {
            writer: ArrowWriter::try_new(file, schema(columns), Some(properties))?,
            rows: 0,
        })
    }

    /// Writes the footer and syncs the file.
    fn close(self, path: &Path) -> Result<FileEntry, WriteCause> {
        self.writer.into_inner()?.sync_all()?;
        Ok(FileEntry::of(path, Some(self.rows))?)
    }
}
