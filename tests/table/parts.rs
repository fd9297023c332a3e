//! Large tables: directories of files, listed one by one in the manifest.

use std::fs;
use std::fs::File;

use arrow::array::AsArray;
use arrow::datatypes::UInt64Type;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use sha2::{Digest, Sha256};

use crate::cli::support::{AT_ONCE, Scratch, assert_has, study_text};

/// One row more than fits into one file.
const RUNS: u64 = (1 << 19) + 1;

#[test]
fn a_table_of_more_than_half_a_million_rows_is_a_directory() {
    let scratch = Scratch::new();
    let block = "model: {kind: block_on_spring, parameters: {mass_kg: 1, stiffness_n_m: 100, \
                 normal_force_n: 10, friction_coefficient: 0.1}}\n";
    let text = study_text("a", &format!("{{monte_carlo: {{samples: {RUNS}}}}}"), AT_ONCE, block)
        .replace("initial_conditions: {", "initial_conditions: {box: {position_m: [-0.1, 0.1]}, ");
    scratch.write("a.yaml", text);
    scratch.well("run a.yaml --out out --quiet");
    let files = scratch.manifest("out")["files"].as_object().unwrap().clone();
    let parts: Vec<(&String, u64)> = files
        .iter()
        .filter(|(name, _)| name.starts_with("runs.parquet"))
        .map(|(name, entry)| (name, entry["rows"].as_u64().unwrap()))
        .collect();
    let [(first, first_rows), (second, second_rows)] = parts[..] else { panic!("{parts:?}") };
    assert_eq!((first.as_str(), first_rows), ("runs.parquet/part-00000.parquet", RUNS - 1));
    assert_eq!((second.as_str(), second_rows), ("runs.parquet/part-00001.parquet", 1));
    assert_eq!(fs::read_dir(scratch.path("out/runs.parquet")).unwrap().count(), 2);

    let mut next = 0;
    for name in [first, second] {
        let path = scratch.path("out").join(name);
        let content = fs::read(&path).unwrap();
        let digest: String =
            Sha256::digest(&content).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(files[name]["sha256"], digest);
        assert_eq!(files[name]["bytes"], content.len());
        let reader = ParquetRecordBatchReaderBuilder::try_new(File::open(path).unwrap()).unwrap();
        let groups = reader.metadata().row_groups().iter().map(|group| group.num_rows());
        assert!(groups.max().unwrap() <= 8192);
        let run_id = ProjectionMask::columns(reader.parquet_schema(), ["run_id"]);
        for batch in reader.with_projection(run_id).build().unwrap() {
            for id in batch.unwrap().column(0).as_primitive::<UInt64Type>().values() {
                assert_eq!(*id, next);
                next += 1;
            }
        }
    }
    assert_eq!(next, RUNS);

    // A part is checked like any other file: a missing one is made again.
    assert!(scratch.stickslip("run a.yaml --out out").err.contains("nothing to do"));
    let content = fs::read(scratch.path("out").join(second)).unwrap();
    fs::remove_file(scratch.path("out").join(second)).unwrap();
    let ended = scratch.ended("run a.yaml --out out", 0);
    let said = [
        "changed since they were written: runs.parquet/part-00001.parquet is missing",
        " 0 computed",
    ];
    assert_has(&ended.err, &said);
    assert_eq!(fs::read(scratch.path("out").join(second)).unwrap(), content);
    assert_eq!(fs::read_dir(scratch.path("out/earlier/1/runs.parquet")).unwrap().count(), 1);
}
