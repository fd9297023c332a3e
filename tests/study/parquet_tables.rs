//! Tables in Parquet files: valid ones, invalid ones, and files that claim more than they hold.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use arrow::array::{
    ArrayRef, BooleanArray, Date32Array, Float32Array, Float64Array, Int32Array, Int64Array,
    ListArray, RecordBatch, StringArray, StringDictionaryBuilder, UInt32Array,
};
use arrow::datatypes::{Float64Type, Int32Type};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding};
use parquet::file::properties::{WriterProperties, WriterVersion};
use stickslip::study::{Study, StudyError};

use super::text_with_design;

/// Returns a file with these columns.
fn file(properties: WriterProperties, columns: Vec<(&str, ArrayRef)>) -> Vec<u8> {
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let mut bytes = Vec::new();
    let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties)).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    bytes
}

fn plain(columns: Vec<(&str, ArrayRef)>) -> Vec<u8> {
    file(WriterProperties::default(), columns)
}

fn numbers(values: impl IntoIterator<Item = f64>) -> ArrayRef {
    Arc::new(Float64Array::from_iter_values(values))
}

/// Returns a study with a sweep over this table.
fn sweep(table: &[u8]) -> Result<Study, StudyError> {
    load("sweep: [{table: designs.parquet}]\n", "{monte_carlo: {samples: 10}}", table)
}

fn load(rest: &str, design: &str, table: &[u8]) -> Result<Study, StudyError> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("designs.parquet"), table).unwrap();
    let study = folder.path().join("study.yaml");
    fs::write(&study, format!("{}{rest}", text_with_design(design))).unwrap();
    Study::load(&study)
}

#[track_caller]
fn refused(table: &[u8], key: &str, problem: &str, found: &str) {
    let error = sweep(table).expect_err("refused");
    assert!(error.file().ends_with("designs.parquet"), "{error}");
    assert_eq!((error.line(), error.key()), (None, key), "{error}");
    assert!(error.problem().contains(problem), "{error}");
    assert!(error.found().unwrap_or_default().contains(found), "{error}");
    assert!(error.allowed().is_some(), "{error}");
}

/// Every supported encoding gives the same study as the rows written into it.
#[test]
fn a_right_table_is_the_same_however_it_is_written() {
    let count = 5000_i32;
    let inline: Vec<String> = (0..count)
        .map(|row| format!("[{}.5, {}, {}]", -100 - row % 700, 1 + row % 3, word(row)))
        .collect();
    let inline = format!(
        "sweep: [{{table: {{columns: [speed_rad_s, damping_n_s_m, normal_force], rows: [{}]}}}}]\n",
        inline.join(", ")
    );
    let expected = load(&inline, "{monte_carlo: {samples: 10}}", b"").unwrap();
    let speeds = || numbers((0..count).map(|row| f64::from(-100 - row % 700) - 0.5));
    let dampings = || -> [ArrayRef; 3] {
        let values = || (0..count).map(|row| 1 + row % 3);
        [
            Arc::new(Int32Array::from_iter_values(values())),
            Arc::new(Int64Array::from_iter_values(values().map(i64::from))),
            Arc::new(Float32Array::from_iter_values(values().map(|value| value as f32))),
        ]
    };
    let words = || -> [ArrayRef; 2] {
        let mut coded = StringDictionaryBuilder::<Int32Type>::new();
        (0..count).for_each(|row| coded.append_value(word(row)));
        [Arc::new(StringArray::from_iter_values((0..count).map(word))), Arc::new(coded.finish())]
    };
    for version in [WriterVersion::PARQUET_1_0, WriterVersion::PARQUET_2_0] {
        for compression in [Compression::UNCOMPRESSED, Compression::SNAPPY] {
            for (dictionary, group, damping, word) in
                [(true, 1000, 0, 0), (false, 10_000, 1, 1), (true, 777, 2, 1)]
            {
                let mut properties = WriterProperties::builder()
                    .set_writer_version(version)
                    .set_compression(compression)
                    .set_dictionary_enabled(dictionary)
                    .set_data_page_row_count_limit(300)
                    .set_write_batch_size(100)
                    .set_max_row_group_row_count(Some(group));
                if !dictionary {
                    properties = properties.set_encoding(Encoding::PLAIN);
                }
                let columns = vec![
                    ("speed_rad_s", speeds()),
                    ("damping_n_s_m", dampings()[damping].clone()),
                    ("normal_force", words()[word].clone()),
                ];
                let study = sweep(&file(properties.build(), columns)).unwrap_or_else(|error| {
                    panic!("{version:?}, {compression}, {dictionary}, {group}: {error}")
                });
                assert_eq!(study.resolved_yaml(), expected.resolved_yaml());
            }
        }
    }
}

fn word(row: i32) -> &'static str {
    if row % 2 == 0 { "newton" } else { "lagrange" }
}

/// Files with the default encodings of other programs are read (Polars with
/// `compression="snappy"`).
#[test]
fn files_of_pandas_polars_and_duckdb_are_read() {
    let rows: Vec<String> =
        (0..20).map(|row| format!("[{}.5, {}, {}]", -100 - row, 1 + row % 3, word(row))).collect();
    let inline = format!(
        "sweep: [{{table: {{columns: [speed_rad_s, damping_n_s_m, normal_force], rows: [{}]}}}}]\n",
        rows.join(", ")
    );
    let expected = load(&inline, "{monte_carlo: {samples: 10}}", b"").unwrap();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/parquet_table");
    for name in ["pandas", "polars", "duckdb"] {
        let table = fs::read(folder.join(name).with_extension("parquet")).unwrap();
        let study = sweep(&table).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(study.resolved_yaml(), expected.resolved_yaml(), "{name}");
    }
}

#[test]
fn unsigned_numbers_are_not_negative() {
    let table = plain(vec![("stiffness_n_m", Arc::new(UInt32Array::from(vec![u32::MAX])))]);
    assert_eq!(super::machine_at(&sweep(&table).unwrap(), 0).stiffness_n_m, 4_294_967_295.0);
}

#[test]
fn start_states() {
    let names = ["x", "y", "beta_1", "beta_2", "x_dot", "y_dot", "beta_dot_1", "beta_dot_2"];
    let columns = names.iter().zip(1..).map(|(name, value)| (*name, numbers([f64::from(value)])));
    let study = load("", "{table: designs.parquet}", &plain(columns.collect())).unwrap();
    assert_eq!(super::coordinates(&study, 0), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
}

#[test]
fn wrong_cells_are_named_by_row_and_column() {
    let key = "row 2, column speed_rad_s";
    let speeds = |values: Vec<Option<f64>>| -> Vec<u8> {
        plain(vec![("speed_rad_s", Arc::new(Float64Array::from(values)))])
    };
    refused(&speeds(vec![Some(1.0), None]), key, "an empty value", "nothing");
    refused(&speeds(vec![Some(1.0), Some(f64::NAN)]), key, "not a finite number", "NaN");
    refused(&speeds(vec![Some(1.0), Some(f64::INFINITY)]), key, "not a finite number", "inf");
    let text = |word: &str| plain(vec![("normal_force", Arc::new(StringArray::from(vec![word])))]);
    let key = "row 1, column normal_force";
    refused(&text("euler"), key, "unknown choice", "euler");
    refused(&text(""), key, "an empty value", "nothing");
    refused(&text(&"a".repeat(1000)), key, "too long a text", "1000 bytes");
    let table = plain(vec![("speed_rad_s", Arc::new(StringArray::from(vec!["fast"])))]);
    refused(&table, "row 1, column speed_rad_s", "not a number", "fast");
    refused(
        &plain(vec![("ball_mass_kg", numbers([-1.0]))]),
        "row 1, column ball_mass_kg",
        "",
        "-1",
    );
    // In the second row group, the row numbers continue.
    let groups = WriterProperties::builder().set_max_row_group_row_count(Some(2)).build();
    let values = Float64Array::from(vec![Some(1.0), Some(2.0), Some(3.0), None]);
    let table = file(groups, vec![("speed_rad_s", Arc::new(values))]);
    refused(&table, "row 4, column speed_rad_s", "an empty value", "nothing");
}

#[test]
fn wrong_columns() {
    refused(&plain(vec![("speed", numbers([1.0]))]), "column speed", "unknown column", "speed");
    let column = "column speed_rad_s";
    let truths: ArrayRef = Arc::new(BooleanArray::from(vec![true]));
    refused(&plain(vec![("speed_rad_s", truths)]), column, "wrong type", "BOOLEAN");
    let dates: ArrayRef = Arc::new(Date32Array::from(vec![1]));
    refused(&plain(vec![("speed_rad_s", dates)]), column, "wrong type", "Date");
    let lists: ArrayRef =
        Arc::new(ListArray::from_iter_primitive::<Float64Type, _, _>([Some([Some(1.0)])]));
    refused(&plain(vec![("speed_rad_s", lists)]), "", "wrong type", "lists");
    refused(&plain(vec![("speed_rad_s", numbers([]))]), "", "a table without rows", "0 rows");
    let two = vec![("speed_rad_s", numbers([1.0])), ("speed_rad_s", numbers([1.0]))];
    refused(&plain(two), column, "given twice", "speed_rad_s");
}

#[test]
fn what_is_not_supported_says_what_is() {
    let packed = WriterProperties::builder().set_dictionary_enabled(false);
    let delta = packed.set_encoding(Encoding::DELTA_BINARY_PACKED).build();
    let values: ArrayRef = Arc::new(Int64Array::from(vec![1, 2, 3]));
    let table = file(delta, vec![("speed_rad_s", values)]);
    refused(&table, "", "an encoding that is not supported", "encoding 5");
}

/// A file of another kind, truncated anywhere or with one changed byte, is refused or read, quickly
/// and without a panic.
#[test]
fn damaged_files_are_refused() {
    refused(b"", "", "not a readable Parquet file", "PAR1");
    refused(b"speed_rad_s\n1\n", "", "not a readable Parquet file", "PAR1");
    refused(b"PAR1PAR1", "", "not a readable Parquet file", "PAR1");
    refused(b"PAR1\0\0\0\0PAR1", "", "not a readable Parquet file", "footer");
    let right = plain(vec![("speed_rad_s", numbers([1.0, 2.0]))]);
    for length in (0..right.len()).step_by(7) {
        refused(&right[..length], "", "not a readable Parquet file", "PAR1");
    }
    let mut read = 0;
    for place in 0..right.len() {
        let mut wrong = right.clone();
        wrong[place] ^= 0xff;
        read += u32::from(sweep(&wrong).is_ok());
    }
    // Names of programs, statistics and similar metadata are ignored.
    assert!(read > 0 && (read as usize) < right.len());
}

/// Replaces these bytes everywhere in a part of a file.
fn replaced(bytes: &[u8], old: &[u8], new: &[u8]) -> Vec<u8> {
    let (mut made, mut rest, mut count) = (Vec::new(), bytes, 0);
    while let Some((first, others)) = rest.split_first() {
        if rest.starts_with(old) {
            made.extend(new);
            rest = &rest[old.len()..];
            count += 1;
        } else {
            made.push(*first);
            rest = others;
        }
    }
    assert!(count > 0, "no {old:x?}");
    made
}

/// Returns a file with these pages and this footer.
fn put_together(pages: &[u8], footer: &[u8]) -> Vec<u8> {
    [pages, footer, &(footer.len() as u32).to_le_bytes(), b"PAR1"].concat()
}

/// Returns the pages of a file, with its magic bytes, and its footer.
fn taken_apart(file: &[u8]) -> (&[u8], &[u8]) {
    let (rest, tail) = file.split_at(file.len() - 8);
    let length: [u8; 4] = tail[..4].try_into().unwrap();
    rest.split_at(rest.len() - u32::from_le_bytes(length) as usize)
}

/// An integer field of 32 or 64 bits in Thrift's compact protocol: 2, 2^31 - 1, 2^60.
const INT_2: [u8; 2] = [0x15, 4];
const INT_MOST: [u8; 6] = [0x15, 0xfe, 0xff, 0xff, 0xff, 0x0f];
const LONG_2: [u8; 2] = [0x16, 4];
const LONG_2_TO_60: [u8; 10] = [0x16, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x20];

fn two_rows(dictionary: bool) -> Vec<u8> {
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(dictionary);
    file(properties.build(), vec![("speed_rad_s", numbers([1.0, 2.0]))])
}

#[test]
fn more_rows_than_a_study_may_hold_are_refused_before_they_are_read() {
    let right = two_rows(false);
    let (pages, footer) = taken_apart(&right);
    let table = put_together(pages, &replaced(footer, &LONG_2, &LONG_2_TO_60));
    assert!(table.len() < 1000);
    refused(&table, "", "too many values", "1152921504606846976 rows of 1 columns");
    // Also if all rows are present.
    let table = plain(vec![("speed_rad_s", numbers((0..1_000_001).map(|_| -100.0)))]);
    refused(&table, "", "too many values", "1000001 rows of 1 columns");
}

#[test]
fn pages_that_unpack_to_too_much_are_refused_before_they_are_unpacked() {
    let right = two_rows(false);
    let (pages, footer) = taken_apart(&right);
    // The file's magic bytes and the page type precede the unpacked size, 16 bytes.
    assert_eq!(pages[4..8], [0x15, 0, 0x15, 32]);
    let claims = [&pages[..6], &INT_MOST, &pages[8..]].concat();
    refused(&put_together(&claims, footer), "", "too large when unpacked", "2147483647 bytes");
    // Texts of a hundred bytes count fully, even if all refer to one dictionary page.
    let packed = WriterProperties::builder().set_compression(Compression::SNAPPY);
    let packed = packed.set_dictionary_enabled(false).build();
    let texts: ArrayRef = Arc::new(StringArray::from_iter_values(std::iter::repeat_n(
        "0123456789".repeat(20),
        400_000,
    )));
    let table = file(packed, vec![("normal_force", texts)]);
    assert!(table.len() < 8_000_000, "{}", table.len());
    refused(&table, "", "too large when unpacked", "pages");
}

#[test]
fn dictionaries_that_claim_more_than_their_page_holds_are_refused() {
    let right = two_rows(true);
    let (pages, footer) = taken_apart(&right);
    let header = [[0x4c].as_slice(), &INT_2].concat();
    let claim = [[0x4c].as_slice(), &INT_MOST].concat();
    let table = put_together(&replaced(pages, &header, &claim), footer);
    refused(&table, "", "not a readable Parquet file", "a dictionary of more values");
}

/// Returns a footer with this schema, and no rows.
fn footer(schema: &[u8], more: &[u8]) -> Vec<u8> {
    [&[0x15, 2, 0x19], schema, &[0x16, 0, 0x19, 0x0c], more, &[0]].concat()
}

#[test]
fn footers_that_take_stack_or_time_are_refused() {
    // Each column is nested in the previous one.
    let element = [0x48, 1, b'a', 0x15, 2, 0];
    let deep = [[0xfc, 0xa0, 0x8d, 6].as_slice(), &element.repeat(100_000)].concat();
    let table = put_together(b"PAR1", &footer(&deep, &[]));
    refused(&table, "", "not a readable Parquet file", "too many parts");
    let deep = [[0xfc, 0x90, 0x4e].as_slice(), &element.repeat(10_000)].concat();
    refused(
        &put_together(b"PAR1", &footer(&deep, &[])),
        "",
        "wrong type",
        "columns within columns",
    );
    // Two thousand million booleans, which take no bytes, in an unknown field; five missing columns
    // of one byte each.
    let one = [0x1c, 0x48, 1, b'a', 0x15, 0, 0];
    let truths = [0x09, 0xc8, 1, 0xf1, 0xff, 0xff, 0xff, 0xff, 7];
    let table = put_together(b"PAR1", &footer(&one, &truths));
    refused(&table, "", "not a readable Parquet file", "footer");
    // A number in the place of a name: parsers may disagree about its type.
    let confused = [0x1c, 0x45, 2, 0x15, 0, 0];
    refused(&put_together(b"PAR1", &footer(&confused, &[])), "", "not a readable", "footer");
}
