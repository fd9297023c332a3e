//! Large tables: directories of files, listed one by one in the manifest.

use std::fs;

use crate::cli::support::{AT_ONCE, Scratch, assert_has, counts, study_text};

/// One row more than fits into one file.
const RUNS: u64 = (1 << 19) + 1;

#[test]
fn a_table_of_more_than_half_a_million_rows_is_a_directory() {
    let block = "model: {kind: block_on_spring, parameters: {mass_kg: 1, stiffness_n_m: 100, \
                 normal_force_n: 10, friction_coefficient: 0.1}}\n";
    let text = study_text("a", &format!("{{monte_carlo: {{samples: {RUNS}}}}}"), AT_ONCE, block)
        .replace("initial_conditions: {", "initial_conditions: {box: {position_m: [-0.1, 0.1]}, ");
    let scratch = Scratch::with(text);
    scratch.well("run a.yaml --out out --quiet");
    let files = scratch.manifest("out")["files"].as_object().unwrap().clone();
    let parts: Vec<(&String, u64)> = files
        .iter()
        .filter(|(name, _)| name.starts_with("runs.parquet"))
        .map(|(name, entry)| (name, entry["rows"].as_u64().unwrap()))
        .collect();
    let [first, (second, 1)] = parts[..] else { panic!("{parts:?}") };
    assert_eq!((first.0.as_str(), first.1), ("runs.parquet/part-00000.parquet", RUNS - 1));
    assert_eq!(second, "runs.parquet/part-00001.parquet");
    assert_eq!(fs::read_dir(scratch.path("out/runs.parquet")).unwrap().count(), 2);

    assert!(counts(&scratch.table("out", "runs"), "run_id").into_iter().eq(0..RUNS));

    // The manifest has the sizes and hashes of the parts. A part is checked like any other file: a missing one is made again.
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
