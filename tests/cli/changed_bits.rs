//! Every displayed file is verified: a file with a single changed bit is named and refused,
//! wherever the bit is.

use std::fs;

use serde_json::{Value, json};

use super::evaluate::BLOCK;
use super::summary::finished;
use super::support::{Scratch, assert_has};

/// Changes bits of a file, one at a time, over its whole length; calls `look` with each, and
/// restores the file.
fn with_other_bits(scratch: &Scratch, name: &str, places: usize, look: impl Fn(usize)) {
    let right = scratch.bytes(name);
    let bits = right.len() * 8;
    for sample in 0..places {
        // Even distances, with an offset that covers all bits of bytes.
        let bit = (sample * bits / places + sample * 7).min(bits - 1);
        let mut wrong = right.clone();
        wrong[bit / 8] ^= 1 << (bit % 8);
        scratch.write(name, wrong);
        look(bit);
    }
    scratch.write(name, right);
}

#[track_caller]
fn refused(scratch: &Scratch, command: &str, name: &str, bit: usize) {
    let ended = scratch.stickslip(command);
    let seen = (ended.code, ended.out.as_str());
    assert_eq!(seen, (Some(2), ""), "{command}, bit {bit}: {}", ended.err);
    assert_has(&ended.err, &[name, "allowed: "]);
}

#[test]
fn of_results() {
    let (scratch, _) = finished();
    for (command, name, said) in [
        ("summary out", "points.parquet", "points.parquet: this is not the file"),
        ("summary out", "study.yaml", "study"),
        ("report out", "points.parquet", "points.parquet"),
        ("report out", "runs.parquet", "runs.parquet"),
        ("report out", "time_to_rest.parquet", "time_to_rest.parquet"),
        ("report out", "cycles.parquet", "cycles.parquet"),
        ("replay out 1", "runs.parquet", "runs.parquet: this is not the file"),
    ] {
        with_other_bits(&scratch, &format!("out/{name}"), 3, |bit| {
            refused(&scratch, command, said, bit);
        });
    }
    scratch.well("summary out");
    scratch.well("report out");
}

/// Inconsistent numbers of runs in a manifest are refused.
#[test]
fn of_a_manifest() {
    let (scratch, _) = finished();
    let text = scratch.text("out/manifest.json");
    for (key, other) in
        [("\"runs_finished\": 60", "\"runs_finished\": 61"), ("failed\": ", "failed\": 1")]
    {
        assert!(text.contains(key));
        scratch.write("out/manifest.json", text.replacen(key, other, 1));
        refused(&scratch, "summary out", "manifest.json is damaged", 0);
    }
}

#[test]
fn of_a_search() {
    let scratch = Scratch::new();
    scratch.write("block.yaml", format!("{BLOCK}optimize: {{minimize: stop, designs: 12}}\n"));
    scratch.well("optimize block.yaml --out search -q");
    let name = "search/evaluations.parquet";
    for (command, file) in [
        ("optimize block.yaml --out search", "evaluations.parquet"),
        ("report search", "evaluations.parquet"),
        ("report search", "finalists.parquet"),
        ("report search", "optimum.json"),
    ] {
        let said = format!("{file}: this is not the file that was written");
        with_other_bits(&scratch, &format!("search/{file}"), 3, |bit| {
            refused(&scratch, command, &said, bit);
        });
    }
    // A changed list is either unreadable, reports a different table, or its change affects nothing
    // that is used.
    let best = scratch.bytes("search/optimum.json");
    with_other_bits(&scratch, "search/files.json", 30, |bit| {
        let before = scratch.bytes(name);
        let ended = scratch.stickslip("optimize block.yaml --out search -q");
        assert!([Some(0), Some(2)].contains(&ended.code), "bit {bit}: {}", ended.err);
        assert_eq!(scratch.bytes(name), before);
        assert_eq!(scratch.bytes("search/optimum.json"), best);
    });
    // Killed before the next table got its name: the search continues from the previous one.
    let list = scratch.text("search/files.json");
    let mut list: Value = serde_json::from_str(&list).unwrap();
    list["replaced"] = json!({"evaluations.parquet": list["files"]["evaluations.parquet"]});
    list["files"]["evaluations.parquet"]["sha256"] = "0".repeat(64).into();
    scratch.write("search/files.json", list.to_string());
    scratch.well("optimize block.yaml --out search -q");
    // Without the list the directory is not recognised; without the table the search starts again
    // and ends with the same result.
    let evaluations = scratch.bytes(name);
    fs::remove_file(scratch.path("search/files.json")).unwrap();
    scratch.refused("optimize block.yaml --out search", &["this file cannot be verified"]);
    fs::remove_file(scratch.path(name)).unwrap();
    scratch.well("optimize block.yaml --out search -q");
    assert_eq!(scratch.bytes(name), evaluations);
    assert_eq!(scratch.bytes("search/optimum.json"), best);
    // Files that are not reused are made again, with a message.
    scratch.write("search/optimum.json", "{}");
    let said = ["optimum.json has been changed since it was written"];
    scratch.tells("optimize block.yaml --out search -q", 0, &said);
    assert_eq!(scratch.bytes("search/optimum.json"), best);
}
