//! Tables on disk: files, their parts, and what has the name of a table at any time.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::thread;

use arrow::array::AsArray;
use arrow::datatypes::UInt64Type;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use stickslip::table::column::{Column, Columns};
use stickslip::table::{FileEntry, TableFiles, TableWriter};
use tempfile::tempdir;

/// Rows that are written at a time, and rows per row group.
const BLOCK: u64 = 4096;
const ROW_GROUP: u64 = 2 * BLOCK;

fn columns() -> Vec<Column<u64>> {
    let mut list = Columns::<u64>::new();
    list.count("row", |row| *row).meaning("number of the row");
    list.finish()
}

/// Starts a table of the rows `rows` with at most `most` rows per file.
fn begin(
    path: &Path,
    most: u64,
    rows: impl IntoIterator<Item = u64>,
) -> TableWriter<u64, TableFiles> {
    let table = TableWriter::create(path, columns(), "here").unwrap();
    let mut table = table.with_rows_per_file(most);
    rows.into_iter().for_each(|row| table.push(row).unwrap());
    table
}

/// Writes a table of the rows `0..rows`.
fn write(path: &Path, most: u64, rows: u64) -> Vec<(String, FileEntry)> {
    begin(path, most, 0..rows).finish().unwrap()
}

/// Returns the rows of a file, and how many are in each row group.
fn read_file(path: &Path) -> (Vec<u64>, Vec<i64>) {
    let reader = ParquetRecordBatchReaderBuilder::try_new(File::open(path).unwrap()).unwrap();
    let groups = reader.metadata().row_groups().iter().map(|group| group.num_rows()).collect();
    let rows = reader
        .build()
        .unwrap()
        .flat_map(|batch| batch.unwrap().column(0).as_primitive::<UInt64Type>().values().to_vec());
    (rows.collect(), groups)
}

/// Returns the rows of a table of any number of files.
fn read(path: &Path) -> Vec<u64> {
    match path.is_file() {
        true => read_file(path).0,
        false => files(path).iter().flat_map(|file| read_file(file).0).collect(),
    }
}

fn files(directory: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect();
    files.sort();
    files
}

fn entries(directory: &Path) -> usize {
    fs::read_dir(directory).unwrap().count()
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
        (2 * BLOCK, 2 * BLOCK, vec![2 * BLOCK]),
        (2 * BLOCK, 2 * BLOCK + 1, vec![2 * BLOCK, 1]),
        (BLOCK + 5, 3 * BLOCK, vec![4101, 4101, 4086]),
    ] {
        let scratch = tempdir().unwrap();
        let path = scratch.path().join("t.parquet");
        let found = write(&path, most, rows);
        let counts: Vec<u64> = found.iter().map(|(_, entry)| entry.rows.unwrap()).collect();
        assert_eq!(counts, expected, "{rows} rows in files of {most}");
        assert_eq!(path.is_file(), rows <= most, "{rows} rows in files of {most}");
        for (name, entry) in &found {
            assert_eq!(&FileEntry::of(&scratch.path().join(name), entry.rows).unwrap(), entry);
        }
        assert_eq!(read(&path), (0..rows).collect::<Vec<_>>());
        let named: Vec<PathBuf> = found.iter().map(|(name, _)| scratch.path().join(name)).collect();
        assert_eq!(files(scratch.path()), named, "these files, in this order, and no others");
    }
}

/// A part is identical to a table of its rows alone, byte for byte.
#[test]
fn a_part_is_a_table() {
    let scratch = tempdir().unwrap();
    let (most, path) = (ROW_GROUP + 7, scratch.path().join("t.parquet"));
    write(&path, most, 2 * most);
    let alone = scratch.path().join("alone.parquet");
    write(&alone, 1 << 19, most);
    let part = path.join("part-00000.parquet");
    assert_eq!(fs::read(&part).unwrap(), fs::read(alone).unwrap());
    assert_eq!(read_file(&part).1, [ROW_GROUP as i64, 7]);
}

/// A table replaces any other table, also a directory a file and the reverse. The name belongs to
/// the old table until the new one is finished.
#[test]
fn a_table_takes_the_place_of_any_other() {
    for before in [7, 12, 35] {
        for after in [0, 7, 12, 41] {
            let scratch = tempdir().unwrap();
            let path = scratch.path().join("t.parquet");
            write(&path, 10, before);
            // An unfinished table has more parts than the next one.
            drop(begin(&path, 10, 0..99));
            let new = begin(&path, 10, 100..100 + after);
            assert_eq!(read(&path), (0..before).collect::<Vec<_>>());
            let found = new.finish().unwrap();
            assert_eq!(read(&path), (100..100 + after).collect::<Vec<_>>(), "after {before} rows");
            assert_eq!(files(scratch.path()).len(), found.len());
            assert_eq!(entries(scratch.path()), 1, "only the table");
        }
    }
}

/// Neither process disturbs the other, and the last one gives the name, for any kinds of tables.
#[test]
fn two_that_write_the_same_table() {
    for first in [5, 15] {
        for last in [6, 16] {
            let scratch = tempdir().unwrap();
            let path = scratch.path().join("t.parquet");
            let (earlier, later) = (begin(&path, 10, 0..first), begin(&path, 10, 0..last));
            earlier.finish().expect("finishes");
            assert_eq!(read(&path).len() as u64, first);
            later.finish().expect("finishes");
            assert_eq!(read(&path).len() as u64, last);
            assert_eq!(entries(scratch.path()), 1, "only the table");
        }
    }
}

/// Many processes at the same time: the table of the last one is complete.
#[test]
fn many_that_write_the_same_table() {
    let scratch = tempdir().unwrap();
    let path = scratch.path().join("t.parquet");
    thread::scope(|scope| {
        for writer in 0..4 {
            let path = &path;
            scope.spawn(move || {
                (0..50).for_each(|_| drop(begin(path, 1, [writer, writer]).finish().unwrap()));
            });
        }
    });
    let table = read(&path);
    assert!(table.len() == 2 && table[0] == table[1], "{table:?}");
    assert_eq!(entries(scratch.path()), 1, "only the table");
}

#[test]
fn nothing_is_left_of_an_unfinished_table() {
    let scratch = tempdir().unwrap();
    let path = scratch.path().join("t.parquet");
    drop(begin(&path, 10, 0..15));
    begin(&path, 10, 0..15).abandon().unwrap();
    begin(&path, 10, 0..15)
        .finish_after(true, |_| Err(std::io::Error::other("stopped")))
        .unwrap_err();
    assert_eq!(entries(scratch.path()), 0);
}

/// Files and directories of the user are never touched.
#[test]
fn a_directory_that_is_no_table_is_left_alone() {
    let scratch = tempdir().unwrap();
    let (partial, mine) = (scratch.path().join("t.parquet.partial"), scratch.path().join("mine"));
    fs::write(&partial, "years of work").unwrap();
    write(&scratch.path().join("t.parquet"), 10, 1);
    assert_eq!(fs::read_to_string(&partial).unwrap(), "years of work");
    fs::create_dir(&mine).unwrap();
    fs::write(mine.join("thesis.tex"), "years of work").unwrap();
    let error = begin(&mine, 10, 0..1).finish().unwrap_err().to_string();
    assert!(error.contains("in the way: it holds thesis.tex"), "{error}");
    assert_eq!(fs::read_to_string(mine.join("thesis.tex")).unwrap(), "years of work");
    assert_eq!(entries(scratch.path()), 3);
}

/// Writing identical bytes again changes nothing, and a file with other content is not replaced.
#[test]
fn a_table_that_is_written_once_replaces_nothing() {
    let again = |path: &Path, rows: u64| begin(path, 10, 0..rows).finish_after(false, |_| Ok(()));
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
        assert!(content(scratch.path()).eq(before), "{rows} rows");
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
