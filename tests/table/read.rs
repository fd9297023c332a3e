//! Reading tables of results: every type of column, and damaged files.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::json;
use stickslip::table::column::{Column, Columns};
use stickslip::table::{
    ColumnValues, FORMAT, FileEntry, Kind, Manifest, Table, TableError, TableWriter, manifest_of,
};
use tempfile::{TempDir, tempdir};

use crate::cli::support::{AT_ONCE, Scratch, study_text};

const HASH: &str = "0123456789abcdef";

/// Returns the value in row `n`; every seventh value is missing.
fn there(n: u64) -> Option<u64> {
    (!n.is_multiple_of(7)).then_some(n)
}

fn number(n: u64) -> Option<f64> {
    there(n).map(|n| (n as f64).sqrt() / 3.0 - 40.0)
}

fn list(n: u64) -> Option<Vec<f64>> {
    there(n).map(|n| (0..n % 4).map(|k| k as f64 + n as f64 * 0.1).collect())
}

const WORDS: [&str; 3] = ["coulomb", "stribeck", "Reibung ü"];

fn columns() -> Vec<Column<u64>> {
    let mut list = Columns::<u64>::new();
    list.number("number", "m", |n| number(*n));
    list.count("count", |n| there(*n).map(|n| u64::MAX - n));
    list.small_count("small_count", |n| there(*n).map(|n| (n % 256) as u8));
    list.integer("integer", |n| there(*n).map(|n| 5 - n as i32));
    list.boolean("truth", |n| there(*n).map(|n| n % 3 == 0));
    list.word("word", |n| there(*n).map(|n| WORDS[n as usize % 3]));
    list.text("text", |n| there(*n).map(|n| format!("run {n}")));
    list.numbers("list", "rad", |n| self::list(*n));
    list.finish()
}

fn all_kinds() -> [(&'static str, Kind); 8] {
    [
        ("number", Kind::Number),
        ("count", Kind::Count),
        ("small_count", Kind::Count),
        ("integer", Kind::Integer),
        ("truth", Kind::Boolean),
        ("word", Kind::Text),
        ("text", Kind::Text),
        ("list", Kind::Numbers),
    ]
}

fn provenance(format: u32, table: &str, hash: &str) -> String {
    json!({"format": format, "table": table, "study": "s", "study_hash": hash}).to_string()
}

/// Returns the manifest of a small study, with these files instead of its own.
fn manifest(files: impl IntoIterator<Item = (String, FileEntry)>) -> Manifest {
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 1}}", AT_ONCE, ""));
    let read = manifest_of(&scratch.path("out")).unwrap().unwrap();
    Manifest {
        files: files.into_iter().collect::<BTreeMap<_, _>>(),
        study_hash: HASH.into(),
        ..read
    }
}

/// Writes a table of these rows under this name, and returns its manifest entry.
fn write(path: &Path, rows: std::ops::Range<u64>, provenance: &str) -> FileEntry {
    let mut writer = TableWriter::create(path, columns(), provenance).unwrap();
    rows.for_each(|n| writer.push(n).unwrap());
    writer.finish().unwrap().remove(0).1
}

fn one_table(rows: u64, provenance: &str) -> (TempDir, Manifest) {
    let folder = tempdir().unwrap();
    let entry = write(&folder.path().join("t.parquet"), 0..rows, provenance);
    let manifest = manifest([("t.parquet".to_owned(), entry)]);
    (folder, manifest)
}

fn right() -> String {
    provenance(FORMAT, "t", HASH)
}

/// Reads a whole table, compares every value, and returns the number of rows.
#[track_caller]
fn compare(table: &Table) -> u64 {
    let mut next = 0;
    for batch in table.read(&all_kinds()).unwrap() {
        let batch = batch.unwrap();
        assert_eq!(batch.first_row, next);
        assert!(batch.rows <= 1024);
        let read: Vec<_> = batch.columns.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(read, all_kinds().map(|(name, _)| name));
        let rows = || next..next + batch.rows as u64;
        let whole = |value: fn(u64) -> u64| {
            ColumnValues::Count(rows().map(|n| there(n).map(value)).collect())
        };
        let text = |value: fn(u64) -> String| {
            ColumnValues::Text(rows().map(|n| there(n).map(value)).collect())
        };
        let expected = [
            ColumnValues::Number(rows().map(number).collect()),
            whole(|n| u64::MAX - n),
            whole(|n| n % 256),
            ColumnValues::Integer(rows().map(|n| there(n).map(|n| 5 - n as i64)).collect()),
            ColumnValues::Boolean(rows().map(|n| there(n).map(|n| n % 3 == 0)).collect()),
            text(|n| WORDS[n as usize % 3].to_owned()),
            text(|n| format!("run {n}")),
            ColumnValues::Numbers(rows().map(list).collect()),
        ];
        for ((name, values), expected) in batch.columns.iter().zip(&expected) {
            assert_eq!(values, expected, "{name}");
        }
        next += batch.rows as u64;
    }
    assert_eq!(next, table.rows());
    next
}

/// Values of every type are read back across batches, row groups and files.
#[test]
fn values_of_every_kind_are_read_back() {
    for rows in [0, 1, 1024, 1025, 20_000] {
        let (folder, manifest) = one_table(rows, &right());
        let table = Table::open(folder.path(), &manifest, "t").expect("a table");
        assert_eq!(compare(&table), rows);
        let kinds: Vec<_> = table
            .columns
            .iter()
            .map(|(name, kind)| (name.as_str(), kind.expect("a kind")))
            .collect();
        assert_eq!(kinds, all_kinds());
    }
    let folder = tempdir().unwrap();
    fs::create_dir(folder.path().join("t.parquet")).unwrap();
    let parts = [0..9000, 9000..9001, 9001..12_000].into_iter().enumerate().map(|(part, rows)| {
        let name = format!("t.parquet/part-{part:05}.parquet");
        let entry = write(&folder.path().join(&name), rows, &right());
        (name, entry)
    });
    let manifest = manifest(parts);
    assert_eq!(compare(&Table::open(folder.path(), &manifest, "t").unwrap()), 12_000);
}

/// Pages of equal values take a few bytes, however many they announce.
#[test]
fn more_list_values_than_the_limit_are_refused() {
    for (length, read) in [(1024, true), (1025, false)] {
        let folder = tempdir().expect("a folder");
        let mut list = Columns::<u64>::new();
        list.numbers("list", "rad", |length| Some(vec![0.5; *length as usize]));
        let path = folder.path().join("t.parquet");
        let mut writer = TableWriter::create(&path, list.finish(), &right()).expect("a new table");
        writer.push(length).expect("a row");
        let entry = writer.finish().expect("a finished table").remove(0).1;
        let manifest = manifest([("t.parquet".to_owned(), entry)]);
        let table = Table::open(folder.path(), &manifest, "t").expect("a table");
        let batch =
            table.read(&[("list", Kind::Numbers)]).expect("its column").next().expect("a batch");
        match read {
            true => assert_eq!(batch.expect("a batch that can be read").rows, 1),
            false => refused(batch, &["not a readable Parquet file", "more values than rows"]),
        }
    }
}

#[track_caller]
fn refused<T>(result: Result<T, TableError>, parts: &[&str]) {
    let message = result.err().expect("refused").to_string();
    for part in parts.iter().chain(&["found: ", "allowed: "]) {
        assert!(message.contains(part), "no {part:?} in\n{message}");
    }
}

#[test]
fn errors_name_missing_columns_and_wrong_types() {
    let (folder, manifest) = one_table(10, &right());
    let table = Table::open(folder.path(), &manifest, "t").unwrap();
    let missing = ["t.parquet: column numbr: ", "columns number (did you mean this?)"];
    refused(table.read(&[("count", Kind::Count), ("numbr", Kind::Number)]), &missing);
    let wrong = ["t.parquet: column text: wrong type", "a column of text", "allowed: numbers"];
    refused(table.read(&[("text", Kind::Number)]), &wrong);
    let batch = table.read(&[("count", Kind::Count)]).unwrap().next().unwrap().unwrap();
    assert!(matches!(&batch.columns[..], [(name, ColumnValues::Count(_))] if name == "count"));
}

#[test]
fn files_that_differ_from_the_written_ones_are_refused() {
    for (provenance, found) in [
        (provenance(FORMAT + 1, "t", HASH), format!("layout {}, table t", FORMAT + 1)),
        (provenance(FORMAT, "points", HASH), "table points".to_owned()),
        (provenance(FORMAT, "t", "fedcba987654"), "hash fedcba987654".to_owned()),
        ("no JSON".to_owned(), "no key `stickslip`".to_owned()),
    ] {
        let (folder, manifest) = one_table(10, &provenance);
        let parts =
            ["t.parquet: this is not a table of these results", &found, "hash 0123456789ab"];
        refused(Table::open(folder.path(), &manifest, "t"), &parts);
    }

    let (folder, manifest) = one_table(10, &right());
    let open = |manifest: &Manifest| Table::open(folder.path(), manifest, "t");
    let path = folder.path().join("t.parquet");
    refused(Table::open(folder.path(), &manifest, "runs"), &["no table runs.parquet", "t.parquet"]);
    let mut more = manifest.clone();
    more.files.get_mut("t.parquet").unwrap().rows = Some(11);
    refused(open(&more), &["wrong number of rows", "10 rows", "11, as listed in manifest.json"]);
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    refused(open(&manifest), &["not the file that was written", "stickslip resume"]);
    fs::write(&path, vec![b'x'; bytes.len()]).unwrap();
    refused(open(&manifest), &["not the file that was written", "other content, with SHA-256"]);
    let no_table = listing(&path, &manifest);
    refused(open(&no_table), &["t.parquet: not a readable Parquet file", "PAR1"]);
    fs::remove_file(&path).unwrap();
    refused(open(&manifest), &["not the file that was written", "No such file"]);
    fs::create_dir(&path).unwrap();
    refused(open(&manifest), &["not a regular file"]);
}

/// Returns a manifest that lists the current file as a table.
fn listing(path: &Path, manifest: &Manifest) -> Manifest {
    let mut manifest = manifest.clone();
    let entry = manifest.files.get_mut("t.parquet").unwrap();
    *entry = FileEntry::of(path, entry.rows).unwrap();
    manifest
}

/// A table with a changed byte whose hash the manifest lists is read or refused without a panic.
#[test]
fn damaged_files_are_read_or_refused() {
    let (folder, manifest) = one_table(100, &right());
    let path = folder.path().join("t.parquet");
    let right = fs::read(&path).unwrap();
    let mut refusals = 0;
    for place in 0..right.len() {
        let mut bytes = right.clone();
        bytes[place] ^= 1 << (place % 8);
        fs::write(&path, &bytes).unwrap();
        let read = || -> Result<usize, TableError> {
            let table = Table::open(folder.path(), &listing(&path, &manifest), "t")?;
            let batches = table.read(&all_kinds())?;
            let rows = batches
                .map(|batch| batch.map(|batch| batch.rows))
                .sum::<Result<usize, TableError>>()?;
            assert_eq!(table.in_memory()?.rows(), rows, "byte {place}");
            Ok(rows)
        };
        match read() {
            Ok(rows) => assert_eq!(rows, 100, "byte {place}"),
            Err(error) => {
                refusals += 1;
                assert!(error.to_string().len() < 5000, "{error}");
            }
        }
    }
    assert!(refusals > 100, "{refusals}");
}
