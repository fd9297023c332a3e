//! Interrupted studies continue and end in the same bytes.

use std::fs;
use std::path::PathBuf;

use stickslip::classification::MODEL_VERSION;

use super::support::{Scratch, assert_has, of_older_model, study_text};

/// Runs of about a tenth of a millisecond.
fn study(seed_and_more: &str) -> String {
    let sweep = "sweep: [{grid: {speed_rad_s: [-160.0, -216.0]}}]\n";
    study_text("short", "{monte_carlo: {samples: 300}}", 0.1, sweep)
        .replace("seed: 5\n", seed_and_more)
}

/// A study that was interrupted before its last chunk, and the whole of it in `whole`.
fn stopped() -> Scratch {
    let scratch = Scratch::with(study("seed: 5\n"));
    scratch.well("run a.yaml --out whole --chunk 50");
    // As after a kill: finished chunks, their list, the initial manifest.
    scratch.well("run a.yaml --out out --chunk 50 --threads 1");
    let folder = scratch.chunks("out");
    let list = fs::read_to_string(folder.join("manifest.jsonl")).unwrap();
    let lines: Vec<&str> = list.lines().collect();
    assert_eq!(lines.len(), 12);
    fs::write(folder.join("manifest.jsonl"), lines[..8].join("\n") + "\n").unwrap();
    for number in 8..12 {
        fs::remove_file(folder.join(format!("{number:06}.chunk"))).unwrap();
    }
    for name in super::support::DATA_FILES.into_iter().filter(|name| *name != "study.yaml") {
        fs::remove_file(scratch.path("out").join(name)).unwrap();
    }
    let mut manifest = scratch.manifest("out");
    manifest["complete"] = false.into();
    manifest["files"] = serde_json::json!({});
    scratch.write("out/manifest.json", manifest.to_string());
    scratch
}

#[test]
fn finished_runs_are_not_computed_again() {
    for command in [
        "resume out",
        "resume out --threads 1 --chunk 7",
        "resume out --threads 3 --chunk 100000",
        "run a.yaml --out out",
    ] {
        let scratch = stopped();
        let said = ["continuing this study", "400 finished earlier, 200 computed"];
        scratch.tells(command, 0, &said);
        assert_eq!(scratch.data("out"), scratch.data("whole"), "{command}");
        assert_eq!(scratch.manifest("out")["runs_kept"], 400);
        let again = scratch.stickslip(command);
        assert_has(&again.err, &["out already holds all 600 runs of this study: nothing to do"]);
        assert_eq!(again.code, Some(0));
    }
}

/// The directory suffices: the study file and the table that it names may be missing.
#[test]
fn the_directory_is_enough() {
    let scratch = Scratch::new();
    let sweep = "sweep: [{table: speeds.csv}]\n";
    scratch.write("speeds.csv", "speed_rad_s\n-160.0\n-216.0\n");
    scratch.write("a.yaml", study_text("short", "{monte_carlo: {samples: 20}}", 0.1, sweep));
    scratch.well("run a.yaml --out whole");
    assert_eq!(scratch.stickslip("run a.yaml --out out --max-seconds 0").code, Some(130));
    fs::remove_file(scratch.path("a.yaml")).unwrap();
    fs::remove_file(scratch.path("speeds.csv")).unwrap();
    scratch.well("resume out");
    assert_eq!(scratch.data("out"), scratch.data("whole"));
}

/// For each kind of damage to a chunk or the list, only the runs of the chunk are recomputed, the damaged
/// file is renamed and not deleted, and the tables are identical.
#[test]
fn what_is_damaged_is_named_and_computed_again() {
    type Change = (&'static str, fn(&PathBuf));
    let changes: [Change; 7] = [
        ("000003.chunk: its content has been changed", |folder| {
            let path = folder.join("000003.chunk");
            let mut bytes = fs::read(&path).unwrap();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            fs::write(path, bytes).unwrap();
        }),
        ("000003.chunk: 1000 bytes, ", |folder| {
            let path = folder.join("000003.chunk");
            let bytes = fs::read(&path).unwrap();
            fs::write(path, &bytes[..1000]).unwrap();
        }),
        ("000003.chunk: 0 bytes, ", |folder| {
            fs::write(folder.join("000003.chunk"), "").unwrap();
        }),
        ("000003.chunk: missing file", |folder| {
            fs::remove_file(folder.join("000003.chunk")).unwrap();
        }),
        ("000003.chunk: ", |folder| {
            let [left, right] = ["000003.chunk", "000004.chunk"].map(|name| folder.join(name));
            let content = fs::read(&left).unwrap();
            fs::rename(&right, &left).unwrap();
            fs::write(right, content).unwrap();
        }),
        ("manifest.jsonl: line 8 is damaged", |folder| {
            let path = folder.join("manifest.jsonl");
            let list = fs::read_to_string(&path).unwrap();
            fs::write(path, &list[..list.len() - 40]).unwrap();
        }),
        ("not the chunk on the list", |folder| {
            let path = folder.join("manifest.jsonl");
            let list = fs::read_to_string(&path).unwrap();
            assert!(list.contains("\"first_run\":150"));
            fs::write(path, list.replace("\"first_run\":150", "\"first_run\":151")).unwrap();
        }),
    ];
    for (said, change) in changes {
        let scratch = stopped();
        let folder = scratch.chunks("out");
        change(&folder);
        scratch.tells("resume out --threads 2", 0, &[said, "computed again"]);
        assert_eq!(scratch.data("out"), scratch.data("whole"), "{said}");
        let kept = scratch.manifest("out")["runs_kept"].as_u64().unwrap();
        assert!((300..400).contains(&kept), "{said}: {kept}");
        let damaged = folder.join("000003.chunk.damaged").exists();
        assert_eq!(
            damaged,
            said.starts_with("0") && !said.contains("missing") || said.starts_with("not the chunk"),
            "{said}"
        );
    }
}

/// A chunk that is on the list but does not have its final name, as after a crash, is found.
#[test]
fn a_chunk_without_its_name_is_found() {
    let scratch = stopped();
    let folder = scratch.chunks("out");
    fs::rename(folder.join("000007.chunk"), folder.join("000007.chunk.partial")).unwrap();
    let ended = scratch.stickslip("resume out");
    assert_has(&ended.err, &["400 finished earlier, 200 computed"]);
    assert!(folder.join("000007.chunk").exists());
    assert_eq!(scratch.data("out"), scratch.data("whole"));
}

/// A chunk with another case under one of its run numbers is refused, even if its hash matches.
#[test]
fn a_run_of_another_case_is_not_taken() {
    let scratch = stopped();
    scratch.write("b.yaml", study("seed: 6\n"));
    scratch.well("run b.yaml --out other --chunk 50 --threads 1");
    let [ours, other] = ["out", "other"].map(|directory| scratch.chunks(directory));
    // The other study's runs with our study's hash in front.
    let mut bytes = fs::read(other.join("000000.chunk")).unwrap();
    let right = fs::read(ours.join("000000.chunk")).expect("a chunk");
    bytes[..88].copy_from_slice(&right[..88]);
    fs::write(ours.join("000000.chunk"), &bytes).unwrap();
    let list = fs::read_to_string(ours.join("manifest.jsonl")).unwrap();
    let mut lines: Vec<String> = list.lines().map(str::to_owned).collect();
    let mut entry: serde_json::Value = serde_json::from_str(&lines[0]).unwrap();
    entry["bytes"] = bytes.len().into();
    let digest = <sha2::Sha256 as sha2::Digest>::digest(&bytes);
    entry["sha256"] = digest.iter().map(|byte| format!("{byte:02x}")).collect::<String>().into();
    lines[0] = entry.to_string();
    fs::write(ours.join("manifest.jsonl"), lines.join("\n") + "\n").unwrap();
    scratch.tells("resume out", 0, &["350 finished earlier, 250 computed"]);
    assert_eq!(scratch.data("out"), scratch.data("whole"));
}

#[test]
fn what_cannot_be_resumed_is_refused() {
    let scratch = stopped();
    let manifest = scratch.text("out/manifest.json");
    scratch.write("out/manifest.json", &manifest[..200]);
    scratch.refused("resume out", &["manifest.json", "damaged", "allowed: "]);
    let damaged = ["out: manifest.json is damaged", "allowed: ", "remove manifest.json"];
    scratch.refused("run a.yaml --out out", &damaged);
    // The message is true.
    fs::remove_file(scratch.path("out/manifest.json")).unwrap();
    let ended = scratch.stickslip("run a.yaml --out out");
    assert_has(&ended.err, &["400 finished earlier"]);
    assert_eq!(scratch.data("out"), scratch.data("whole"));

    let scratch = stopped();
    scratch.write("out/study.yaml", study("seed: 6\n"));
    let edited = ["the study has been edited since the run", "found:   a study.yaml", "allowed: "];
    scratch.refused("resume out", &edited);
}

/// Runs of another version of the model are not mixed with those of this one.
#[test]
fn runs_of_another_version_are_not_used() {
    let scratch = stopped();
    let folder = scratch.chunks("out");
    let list = folder.join("manifest.jsonl");
    for path in [list.clone(), scratch.path("out/manifest.json")] {
        fs::write(&path, of_older_model(&fs::read_to_string(&path).unwrap())).unwrap();
    }
    let versions = format!("version of the model: 0 -> {MODEL_VERSION}");
    let version = ["none of its runs can be reused", &versions, "--recompute"];
    scratch.refused("run a.yaml --out out", &version);
    let ended = scratch.ended("run a.yaml --out out --recompute --chunk 50", 0);
    assert!(
        !ended.err.contains("damaged") && ended.err.contains("\n600 runs in "),
        "{}",
        ended.err
    );
    assert_eq!(scratch.data("out"), scratch.data("whole"));
    // The chunks of the older model are not deleted.
    assert_eq!(fs::read_to_string(list).unwrap().lines().count(), 8 + 12);
    assert!(folder.join("000007.chunk").exists());
}
