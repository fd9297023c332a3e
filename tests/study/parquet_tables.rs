//! Parquet tables of studies: valid files, damaged files, and files that claim more than they contain.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use arrow::array::{
    Array, ArrayRef, BooleanArray, Date32Array, Decimal128Array, DictionaryArray, Float32Array,
    Float64Array, Int8Array, Int16Array, Int32Array, Int64Array, LargeStringArray, ListArray,
    RecordBatch, StringArray, StringDictionaryBuilder, StringViewArray, UInt8Array, UInt16Array,
    UInt32Array, UInt64Array,
};
use arrow::datatypes::{Float64Type, Int8Type, Int32Type};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding};
use parquet::file::properties::{WriterProperties, WriterVersion};
use stickslip::model::NormalForce;
use stickslip::study::{Study, StudyError};

/// Returns a Parquet file with these columns.
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
    super::load_with("designs.parquet", table, rest, design)
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

/// Every version, compression, dictionary setting and row-group size gives the same study as the rows written inline.
#[test]
fn every_writer_setting_gives_the_same_study() {
    let count = 5000_i32;
    let expected = expected(count);
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

/// Returns the study with this number of rows inline; that of the files of other programs has 20.
fn expected(count: i32) -> Study {
    let row = |row| format!("[{}.5, {}, {}]", -100 - row % 700, 1 + row % 3, word(row));
    let rows: Vec<String> = (0..count).map(row).collect();
    let inline = format!(
        "sweep: [{{table: {{columns: [speed_rad_s, damping_n_s_m, normal_force], rows: [{}]}}}}]\n",
        rows.join(", ")
    );
    load(&inline, "{monte_carlo: {samples: 10}}", b"").unwrap()
}

fn of_other_programs(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/parquet_table");
    fs::read(folder.join(name).with_extension("parquet")).unwrap()
}

/// Reads the default files of pandas, Polars and DuckDB, DuckDB's newer format version, and pyarrow's files with each
/// compression.
#[test]
fn files_of_other_programs_are_read() {
    for name in ["pandas", "polars", "duckdb", "duckdb-v2", "zstd", "gzip", "lz4"] {
        let study =
            sweep(&of_other_programs(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(study.resolved_yaml(), expected(20).resolved_yaml(), "{name}");
    }
}

/// Reads each column in each encoding that its type supports, over several pages.
#[test]
fn every_encoding_is_read() {
    let count = 3000_i32;
    let speeds = || numbers((0..count).map(|row| -100.0 - f64::from(row) / 7.0));
    let dampings = || -> ArrayRef {
        Arc::new(Int32Array::from_iter_values((0..count).map(|row| 1 + row % 3)))
    };
    let forces = || -> ArrayRef {
        let force = |row| (row % 9 > 0 || row > 40).then(|| word(row));
        Arc::new(StringArray::from_iter((0..count).map(|row| force(row).or(Some("newton")))))
    };
    let columns = || {
        vec![("speed_rad_s", speeds()), ("damping_n_s_m", dampings()), ("normal_force", forces())]
    };
    let expected = sweep(&self::plain(columns())).expect("a valid study");
    let [plain, split] = [Encoding::PLAIN, Encoding::BYTE_STREAM_SPLIT];
    for version in [WriterVersion::PARQUET_1_0, WriterVersion::PARQUET_2_0] {
        for encodings in [
            [plain; 3],
            [split, Encoding::DELTA_BINARY_PACKED, Encoding::DELTA_LENGTH_BYTE_ARRAY],
            [split, split, Encoding::DELTA_BYTE_ARRAY],
        ] {
            let mut properties = WriterProperties::builder()
                .set_writer_version(version)
                .set_compression(Compression::SNAPPY)
                .set_dictionary_enabled(false)
                .set_data_page_row_count_limit(700)
                .set_write_batch_size(100);
            for ((name, _), encoding) in columns().iter().zip(encodings) {
                properties = properties.set_column_encoding((*name).into(), encoding);
            }
            let study = sweep(&file(properties.build(), columns()));
            let study = study.unwrap_or_else(|error| panic!("{version:?}, {encodings:?}: {error}"));
            assert_eq!(study.resolved_yaml(), expected.resolved_yaml(), "{encodings:?}");
        }
    }
}

/// Reads numbers and texts of every type; decimal numbers have the value of their digits.
#[test]
fn every_numeric_and_text_type_is_read() {
    let decimals = Decimal128Array::from(vec![1_000_000, 2_000_000]);
    let columns: [ArrayRef; 12] = [
        Arc::new(Int8Array::from(vec![1, 2])),
        Arc::new(Int16Array::from(vec![1, 2])),
        Arc::new(Int32Array::from(vec![1, 2])),
        Arc::new(Int64Array::from(vec![1, 2])),
        Arc::new(UInt8Array::from(vec![1, 2])),
        Arc::new(UInt16Array::from(vec![1, 2])),
        Arc::new(UInt32Array::from(vec![1, 2])),
        Arc::new(UInt64Array::from(vec![1, 2])),
        Arc::new(Float32Array::from(vec![1.0, 2.0])),
        numbers([1.0, 2.0]),
        Arc::new(decimals.clone().with_precision_and_scale(9, 6).unwrap()),
        Arc::new(decimals.with_precision_and_scale(38, 6).unwrap()),
    ];
    for column in columns {
        let kind = column.data_type().clone();
        let study = sweep(&plain(vec![("damping_n_s_m", column)])).unwrap();
        let dampings = [0, 1].map(|point| super::machine_at(&study, point).damping_n_s_m);
        assert_eq!(dampings, [1.0, 2.0], "{kind}");
    }
    let tenth = Decimal128Array::from(vec![1]).with_precision_and_scale(20, 1).unwrap();
    let study = sweep(&plain(vec![("damping_n_s_m", Arc::new(tenth))])).unwrap();
    assert_eq!(super::machine_at(&study, 0).damping_n_s_m, 0.1);
    let words: [ArrayRef; 3] = [
        Arc::new(LargeStringArray::from(vec!["newton"])),
        Arc::new(StringViewArray::from(vec!["newton"])),
        Arc::new(DictionaryArray::<Int8Type>::from_iter(["newton"])),
    ];
    for column in words {
        let study = sweep(&plain(vec![("normal_force", column)])).unwrap();
        assert_eq!(super::machine_at(&study, 0).normal_force, NormalForce::Newton);
    }
}

#[test]
fn large_unsigned_numbers_stay_positive() {
    let table = plain(vec![("stiffness_n_m", Arc::new(UInt32Array::from(vec![u32::MAX])))]);
    assert_eq!(super::machine_at(&sweep(&table).unwrap(), 0).stiffness_n_m, 4_294_967_295.0);
}

#[test]
fn start_states_are_read() {
    let names = ["x", "y", "beta_1", "beta_2", "x_dot", "y_dot", "beta_dot_1", "beta_dot_2"];
    let columns = names.iter().zip(1..).map(|(name, value)| (*name, numbers([f64::from(value)])));
    let study = load("", "{table: designs.parquet}", &plain(columns.collect())).unwrap();
    assert_eq!(super::coordinates(&study, 0), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
}

#[test]
fn errors_in_cells_name_the_row_and_column() {
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
    refused(&text(&"a".repeat(1000)), key, "the text is too long", "1000 bytes");
    let table = plain(vec![("speed_rad_s", Arc::new(StringArray::from(vec!["fast"])))]);
    refused(&table, "row 1, column speed_rad_s", "not a number", "fast");
    refused(
        &plain(vec![("ball_mass_kg", numbers([-1.0]))]),
        "row 1, column ball_mass_kg",
        "",
        "-1",
    );
    // Row numbers continue in the second row group.
    let groups = WriterProperties::builder().set_max_row_group_row_count(Some(2)).build();
    let values = Float64Array::from(vec![Some(1.0), Some(2.0), Some(3.0), None]);
    let table = file(groups, vec![("speed_rad_s", Arc::new(values))]);
    refused(&table, "row 4, column speed_rad_s", "an empty value", "nothing");
}

#[test]
fn invalid_columns_are_refused() {
    refused(&plain(vec![("speed", numbers([1.0]))]), "column speed", "unknown column", "speed");
    let column = "column speed_rad_s";
    let truths: ArrayRef = Arc::new(BooleanArray::from(vec![true]));
    refused(&plain(vec![("speed_rad_s", truths)]), column, "wrong type", "Boolean");
    let dates: ArrayRef = Arc::new(Date32Array::from(vec![1]));
    refused(&plain(vec![("speed_rad_s", dates)]), column, "wrong type", "Date");
    let lists: ArrayRef =
        Arc::new(ListArray::from_iter_primitive::<Float64Type, _, _>([Some([Some(1.0)])]));
    refused(&plain(vec![("speed_rad_s", lists)]), column, "wrong type", "List");
    refused(&plain(vec![("speed_rad_s", numbers([]))]), "", "a table without rows", "0 rows");
    let two = vec![("speed_rad_s", numbers([1.0])), ("speed_rad_s", numbers([1.0]))];
    refused(&plain(two), column, "given twice", "speed_rad_s");
}

#[test]
fn an_unsupported_compression_is_refused_with_the_supported_ones() {
    let error = sweep(&of_other_programs("brotli")).unwrap_err();
    assert_eq!(error.problem(), "unsupported compression");
    assert!(error.found().unwrap().contains("BROTLI"), "{error}");
    assert!(error.allowed().unwrap().contains("ZSTD, SNAPPY, GZIP, LZ4_RAW"), "{error}");
}

/// A file of another format is refused, and so is a truncated file. The test `fuzz` changes bytes.
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
}

#[test]
fn too_many_rows_are_refused_before_they_are_read() {
    let right = plain(vec![("speed_rad_s", numbers([1.0, 2.0]))]);
    let (rest, tail) = right.split_at(right.len() - 8);
    let length = u32::from_le_bytes(*tail.first_chunk().expect("four bytes"));
    let (pages, footer) = rest.split_at(rest.len() - length as usize);
    // Integer fields of 64 bits in Thrift's compact protocol, with the values 2 and 2^60; each byte is a character.
    let (two, huge) = ("\u{16}\u{4}", format!("\u{16}{}\u{20}", "\u{80}".repeat(8)));
    let footer: String = footer.iter().copied().map(char::from).collect();
    let changed = footer.replace(two, &huge).chars().map(|byte| byte as u8).collect::<Vec<u8>>();
    let table = [pages, &changed, &(changed.len() as u32).to_le_bytes(), b"PAR1"].concat();
    assert!(table.len() < 1000);
    refused(&table, "", "too many values", "1152921504606846976 rows of 1 columns");
    // They are also refused if all rows are present.
    let table = plain(vec![("speed_rad_s", numbers((0..1_000_001).map(|_| -100.0)))]);
    refused(&table, "", "too many values", "1000001 rows of 1 columns");
}
