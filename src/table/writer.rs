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

use super::column::{Column, batch, schema};
use super::file_entry::FileEntry;
use super::staging::{Staging, part_name};
use super::temporary::taken;

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
const PART: u64 = 64 * ROW_GROUP as u64;

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
    // Closed before `staging` removes its directory.
    part: OpenPart,
    staging: Staging,
    finished: Vec<FileEntry>,
    most_rows: u64,
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
        Self::with_parts_of(PART, path, columns, provenance)
    }

    fn with_parts_of(
        most_rows: u64,
        path: &Path,
        columns: Vec<Column<R>>,
        provenance: &str,
    ) -> Result<Self, WriteError> {
        let start = || -> Result<(Staging, OpenPart), WriteCause> {
            let staging = Staging::create(path)?;
            let part = OpenPart::create(&staging.part(0), &columns, provenance)?;
            Ok((staging, part))
        };
        let (staging, part) =
            start().map_err(|cause| WriteError { path: path.to_owned(), cause })?;
        Ok(TableWriter {
            columns,
            provenance: provenance.to_owned(),
            path: path.to_owned(),
            rows: Vec::with_capacity(BLOCK),
            part,
            staging,
            finished: Vec::new(),
            most_rows,
        })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn push(&mut self, row: R) -> Result<(), WriteError> {
        if self.part.rows + self.rows.len() as u64 == self.most_rows {
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
        self.settle(announce, |path, staging, files| match fs::symlink_metadata(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => staging.settle(files.len()),
            Err(error) => Err(error),
            Ok(_) if is_table_of(path, files)? => staging.clear(),
            Ok(_) => Err(taken()),
        })?;
        Ok(())
    }

    /// Discards all rows, and leaves an existing table unchanged.
    ///
    /// # Errors
    /// Returns an error if the written files cannot be removed.
    pub fn abandon(self) -> Result<(), WriteError> {
        let TableWriter { path, part, staging, .. } = self;
        drop(part);
        staging.clear().map_err(|error| WriteError { path, cause: error.into() })
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
            OpenPart::create(&self.staging.part(number + 1), &self.columns, &self.provenance)?;
        let full = mem::replace(&mut self.part, next);
        self.finished.push(full.close(&self.staging.part(number))?);
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
        self.settle(announce, |_, staging, files| staging.settle(files.len()))
    }

    fn settle(
        mut self,
        announce: impl FnOnce(&[(String, FileEntry)]) -> io::Result<()>,
        take_name: impl FnOnce(&Path, Staging, &[(String, FileEntry)]) -> io::Result<()>,
    ) -> Result<Vec<(String, FileEntry)>, WriteError> {
        self.flush().map_err(|cause| self.error(cause))?;
        let TableWriter { path, part, staging, mut finished, .. } = self;
        let settle = || -> Result<_, WriteCause> {
            finished.push(part.close(&staging.part(finished.len()))?);
            let names = staging.names(finished.len());
            let files: Vec<_> = names.into_iter().zip(finished).collect();
            announce(&files)?;
            take_name(&path, staging, &files)?;
            Ok(files)
        };
        settle().map_err(|cause| WriteError { path: path.clone(), cause })
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

#[cfg(test)]
mod tests {
    use std::fs::{self, File};
    use std::path::{Path, PathBuf};

    use arrow_array::cast::AsArray;
    use arrow_array::types::UInt64Type;
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
    use tempfile::tempdir;

    use super::{BLOCK, Column, FileEntry, PART, ROW_GROUP, TableWriter};

    fn columns() -> Vec<Column<u64>> {
        vec![Column::count("row", "number of the row", |row: &u64| Some(*row))]
    }

    /// Writes a table of the rows `0..rows` in parts of at most `most` rows.
    fn write(path: &Path, most: u64, rows: u64) -> Vec<(String, FileEntry)> {
        let mut table = TableWriter::with_parts_of(most, path, columns(), "here").unwrap();
        (0..rows).for_each(|row| table.push(row).unwrap());
        table.finish().unwrap()
    }

    /// The rows of a file, and how many are in each row group.
    fn read(path: &Path) -> (Vec<u64>, Vec<i64>) {
        let reader = ParquetRecordBatchReaderBuilder::try_new(File::open(path).unwrap()).unwrap();
        let groups = reader.metadata().row_groups().iter().map(|group| group.num_rows()).collect();
        let rows = reader.build().unwrap().flat_map(|batch| {
            batch.unwrap().column(0).as_primitive::<UInt64Type>().values().to_vec()
        });
        (rows.collect(), groups)
    }

    /// The files below a directory.
    fn files(directory: &Path) -> Vec<PathBuf> {
        let entries = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
        let mut files: Vec<PathBuf> = entries
            .flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] })
            .collect();
        files.sort();
        files
    }

    #[test]
    fn rows_are_divided_by_their_number_alone() {
        for (most, rows, expected) in [
            (10, 0, vec![0]),
            (10, 1, vec![1]),
            (10, 10, vec![10]),
            (10, 11, vec![10, 1]),
            (10, 30, vec![10, 10, 10]),
            (10, 31, vec![10, 10, 10, 1]),
            (2 * BLOCK as u64, 2 * BLOCK as u64, vec![2 * BLOCK as u64]),
            (2 * BLOCK as u64, 2 * BLOCK as u64 + 1, vec![2 * BLOCK as u64, 1]),
            (BLOCK as u64 + 5, 3 * BLOCK as u64, vec![4101, 4101, 4086]),
        ] {
            let scratch = tempdir().unwrap();
            let path = scratch.path().join("t.parquet");
            let found = write(&path, most, rows);
            let counts: Vec<u64> = found.iter().map(|(_, entry)| entry.rows.unwrap()).collect();
            assert_eq!(counts, expected, "{rows} rows in parts of {most}");
            assert_eq!(path.is_file(), rows <= most, "{rows} rows in parts of {most}");
            let mut all = Vec::new();
            for (name, entry) in &found {
                let part = scratch.path().join(name);
                assert_eq!(&FileEntry::of(&part, entry.rows).unwrap(), entry);
                all.extend(read(&part).0);
            }
            assert_eq!(all, (0..rows).collect::<Vec<_>>());
            let named: Vec<PathBuf> =
                found.iter().map(|(name, _)| scratch.path().join(name)).collect();
            assert_eq!(files(scratch.path()), named, "these files, in this order, and no others");
        }
    }

    /// A part is identical to a table of its rows alone, byte for byte.
    #[test]
    fn a_part_is_a_table() {
        let scratch = tempdir().unwrap();
        let (most, path) = (ROW_GROUP as u64 + 7, scratch.path().join("t.parquet"));
        write(&path, most, 2 * most);
        let alone = scratch.path().join("alone.parquet");
        write(&alone, PART, most);
        let part = path.join("part-00000.parquet");
        assert_eq!(fs::read(&part).unwrap(), fs::read(alone).unwrap());
        assert_eq!(read(&part).1, [ROW_GROUP as i64, 7]);
    }

    /// A table in parts replaces a table in one file, and the reverse.
    #[test]
    fn nothing_of_an_earlier_table_is_left() {
        let scratch = tempdir().unwrap();
        let path = scratch.path().join("t.parquet");
        for rows in [35, 12, 7, 41, 0] {
            // An unfinished table has more parts than the next one.
            let mut broken = TableWriter::with_parts_of(10, &path, columns(), "here").unwrap();
            (0..99).for_each(|row| broken.push(row).unwrap());
            drop(broken);
            let found = write(&path, 10, rows);
            assert_eq!(found.len(), files(scratch.path()).len(), "{rows} rows");
        }
    }

    /// Writing identical bytes again changes nothing, and a file with other content is not replaced.
    #[test]
    fn a_table_that_is_written_once_replaces_nothing() {
        let again = |path: &Path, rows: u64| {
            let mut table = TableWriter::with_parts_of(10, path, columns(), "here").unwrap();
            (0..rows).for_each(|row| table.push(row).unwrap());
            table.finish_once(|_| Ok(()))
        };
        let content = |path: &Path| files(path).into_iter().map(|file| fs::read(file).unwrap());
        for rows in [7, 35] {
            let scratch = tempdir().unwrap();
            let path = scratch.path().join("t.parquet");
            again(&path, rows).unwrap();
            let before: Vec<_> = content(scratch.path()).collect();
            again(&path, rows).unwrap();
            assert!(content(scratch.path()).eq(before.iter().cloned()), "{rows} rows");
            let other = [1, 6, 8, 34, 36].map(|rows| again(&path, rows).unwrap_err().to_string());
            assert!(other.iter().all(|error| error.contains("is not replaced")), "{other:?}");
            let mut kept = content(scratch.path());
            assert!(before.iter().all(|file| kept.any(|other| other == *file)), "{rows} rows");
        }
        // With several parts: a changed part, an additional part, and a missing part.
        type Change = fn(&Path);
        let changes: [Change; 3] = [
            |path| fs::write(path.join("part-00001.parquet"), "mine").unwrap(),
            |path| fs::write(path.join("mine"), "mine").unwrap(),
            |path| fs::remove_file(path.join("part-00003.parquet")).unwrap(),
        ];
        for change in changes {
            let scratch = tempdir().unwrap();
            let path = scratch.path().join("t.parquet");
            again(&path, 35).unwrap();
            change(&path);
            let before: Vec<_> = content(&path).collect();
            again(&path, 35).unwrap_err();
            assert!(content(&path).eq(before));
        }
    }

    #[test]
    fn a_part_is_half_a_million_rows_in_whole_row_groups() {
        assert_eq!((PART, PART % ROW_GROUP as u64), (524_288, 0));
    }
}
