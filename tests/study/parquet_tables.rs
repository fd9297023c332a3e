//! Tables in Parquet files: right ones, wrong ones, and files that claim more than they hold.

use std::fs;
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

/// A file with these columns.
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

/// A study with a sweep over this table.
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
    let error = sweep(table).err().expect("refused");
    assert!(error.file().ends_with("designs.parquet"), "{error}");
    assert_eq!((error.line(), error.key()), (None, key), "{error}");
    assert!(error.problem().contains(problem), "{error}");
    assert!(error.found().unwrap_or_default().contains(found), "{error}");
    assert!(error.allowed().is_some(), "{error}");
}

/// Every way of writing that is supported gives the same study as the rows written into it.
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
    // In the second group of rows, rows are counted on.
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

/// Not a file of this kind at all, and every file that is cut off or has one byte changed: refused or
/// read, in no time and with no panic.
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
    // Names of programs, statistics and the like do not matter.
    assert!(read > 0 && (read as usize) < right.len());
}

/// Replaces bytes that occur once by others of the same length.
#[track_caller]
fn replaced(bytes: &[u8], old: &[u8], new: &[u8]) -> Vec<u8> {
    assert_eq!(old.len(), new.len());
    let places: Vec<usize> =
        (0..bytes.len() - old.len()).filter(|&at| bytes[at..].starts_with(old)).collect();
    assert_eq!(places.len(), 1, "{places:?}");
    let mut bytes = bytes.to_vec();
    bytes[places[0]..places[0] + new.len()].copy_from_slice(new);
    bytes
}
