//! Reads the seed files in `fuzz/corpus`, and writes the binary ones.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use arrow::array::{ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::properties::{WriterProperties, WriterVersion};

use crate::targets::{HEAD, RUN_HEAD, genuine};

fn folder(target: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target)
}

/// Returns the seed files of a target, ordered by name; for studies, also the shipped studies.
pub fn read(target: &str) -> Vec<Vec<u8>> {
    let mut folders = vec![folder(target)];
    if target == "study" {
        folders.push(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("studies"));
    }
    let entries = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap());
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.is_file());
    paths.sort();
    assert!(!paths.is_empty(), "no corpus for {target}");
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// Rewrites the binary seed files.
pub fn write() {
    let put = |target: &str, name: &str, bytes: Vec<u8>| {
        fs::create_dir_all(folder(target)).unwrap();
        fs::write(folder(target).join(name), bytes).unwrap();
    };
    for (name, bytes) in tables() {
        put("parquet_table", name, bytes);
    }
    let scratch = tempfile::tempdir().unwrap();
    let chunk = genuine(scratch.path());
    let with = |first: u8, rest: &[u8]| [&[first], rest].concat();
    put("finished_runs", "chunk", with(0, &chunk));
    put("finished_runs", "list", with(1, b"RIGHT\nRIGHT\n"));
    put("finished_runs", "undecided", with(2, &pieces(&chunk).join([255, 255].as_slice())));
}

/// Returns the outcomes of the runs in a chunk.
fn pieces(chunk: &[u8]) -> Vec<Vec<u8>> {
    let mut runs = &chunk[HEAD..];
    let mut pieces = Vec::new();
    while let Some(run_head) = runs.first_chunk::<RUN_HEAD>() {
        let length: [u8; 4] = run_head[24..].try_into().expect("four bytes");
        let end = RUN_HEAD + u32::from_le_bytes(length) as usize;
        pieces.push(runs[RUN_HEAD..end].to_vec());
        runs = &runs[end..];
    }
    pieces
}

fn tables() -> Vec<(&'static str, Vec<u8>)> {
    let numbers = |count: i32| -> ArrayRef {
        Arc::new(Float64Array::from_iter_values((0..count).map(|row| f64::from(-100 - row % 9))))
    };
    let words: ArrayRef =
        Arc::new(StringArray::from_iter_values((0..40).map(|row| ["newton", "lagrange"][row % 2])));
    let whole: ArrayRef = Arc::new(Int64Array::from_iter_values((0..40).map(|row| 1 + row % 3)));
    let names = ["x", "y", "beta_1", "beta_2", "x_dot", "y_dot", "beta_dot_1", "beta_dot_2"];
    let old = WriterProperties::builder().set_dictionary_enabled(false).build();
    let new = WriterProperties::builder()
        .set_writer_version(WriterVersion::PARQUET_2_0)
        .set_dictionary_enabled(true)
        .set_compression(Compression::SNAPPY)
        .set_data_page_row_count_limit(16)
        .set_write_batch_size(8)
        .set_max_row_group_row_count(Some(24))
        .build();
    let packed = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    vec![
        ("one.parquet", file(old.clone(), vec![("speed_rad_s", numbers(2))])),
        (
            "three.parquet",
            file(
                new,
                vec![
                    ("speed_rad_s", numbers(40)),
                    ("damping_n_s_m", whole),
                    ("normal_force", words),
                ],
            ),
        ),
        ("starts.parquet", file(old, names.map(|name| (name, numbers(3))).to_vec())),
        ("packed.parquet", file(packed, vec![("speed_rad_s", numbers(3000))])),
    ]
}

fn file(properties: WriterProperties, columns: Vec<(&str, ArrayRef)>) -> Vec<u8> {
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let mut bytes = Vec::new();
    let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties)).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    bytes
}
