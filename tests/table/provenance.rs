//! Provenance: every data file has the input that determines the data, and the manifest has the
//! rest.

use std::fs;
use std::fs::File;
use std::time::{SystemTime, UNIX_EPOCH};

use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use serde_json::Value;
use sha2::{Digest, Sha256};
use stickslip::study::Study;

use crate::cli::support::{AT_ONCE, DATA_FILES, Scratch, parse, study_text};

fn text() -> String {
    study_text("a", "{monte_carlo: {samples: 5}}", AT_ONCE, "")
}

/// Returns the value of the metadata key `stickslip` of a table.
fn provenance(scratch: &Scratch, file: &str) -> Value {
    let file = File::open(scratch.path(file)).unwrap();
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
    let metadata = reader.metadata().file_metadata().key_value_metadata().unwrap().clone();
    let ours = metadata.into_iter().find(|entry| entry.key == "stickslip").unwrap();
    serde_json::from_str(&ours.value.unwrap()).unwrap()
}

#[test]
fn every_table_says_where_it_comes_from() {
    let scratch = Scratch::ran(text());
    scratch.well("expand a.yaml --out cases.parquet");
    let study = parse(text());
    for (file, table) in [
        ("out/runs.parquet", "runs"),
        ("out/points.parquet", "points"),
        ("out/time_to_rest.parquet", "time_to_rest"),
        ("out/cycles.parquet", "cycles"),
        ("out/equilibria.parquet", "equilibria"),
        ("out/equilibrium_histogram.parquet", "equilibrium_histogram"),
        ("cases.parquet", "cases"),
    ] {
        let found = provenance(&scratch, file);
        let expected = [
            ("format", stickslip::table::FORMAT.into()),
            ("table", table.into()),
            ("program", "stickslip".into()),
            ("version", env!("CARGO_PKG_VERSION").into()),
            ("commit", stickslip::table::COMMIT.into()),
            ("study", "a".into()),
            ("study_hash", study.hash().into()),
            ("seed", Value::from(5)),
        ];
        for (key, value) in expected {
            assert_eq!(found[key], value, "{file}: {key}");
        }
        // The study can be recovered from any of its tables.
        let again =
            Study::parse("b.yaml".as_ref(), found["study_yaml"].as_str().unwrap().to_owned());
        assert_eq!(again.unwrap().hash(), study.hash());
    }
    let resolved = fs::read_to_string(scratch.path("out/study.yaml")).unwrap();
    assert_eq!(resolved, study.resolved_yaml());
}

#[test]
fn time_and_host_are_in_the_manifest_only() {
    let scratch = Scratch::with(text());
    let now = || SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs_f64();
    let before = now();
    scratch.well("run a.yaml --out out --threads 3");
    let manifest = scratch.manifest("out");
    let started = manifest["started_unix_s"].as_f64().unwrap();
    assert!((before..=now()).contains(&started), "{started}");
    assert!(manifest["wall_s"].as_f64().unwrap() >= 0.0);
    assert_eq!(manifest["threads"], 3);
    assert_eq!((&manifest["complete"], &manifest["shard"]), (&true.into(), &"1/1".into()));
    assert_eq!(manifest["labels"]["undecided"], 5);
    let host = manifest["host"].as_str().unwrap();
    assert!(!host.is_empty());
    for name in DATA_FILES {
        let content = fs::read(scratch.path("out").join(name)).unwrap();
        let entry = &manifest["files"][name];
        assert_eq!(entry["bytes"], content.len());
        let digest: String =
            Sha256::digest(&content).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(entry["sha256"], digest);
        // Short host names occur by chance.
        if host.len() > 5 {
            let holds = content.windows(host.len()).any(|part| part == host.as_bytes());
            assert!(!holds, "{name} holds the host's name");
        }
    }
    let rows = ["runs", "points", "time_to_rest", "cycles", "equilibria", "equilibrium_histogram"]
        .map(|name| manifest["files"][format!("{name}.parquet")]["rows"].clone());
    assert_eq!(rows, [5, 1, 2, 0, 0, 0]);
    assert_eq!(manifest["files"]["study.yaml"]["rows"], Value::Null);
}
