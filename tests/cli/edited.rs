//! An edited study in its old directory: unchanged runs are not computed again.

use std::fs;

use super::support::{Scratch, assert_has, study_text};

const DESIGN: &str = "{stratified: {parts_per_axis: 2, samples_per_cell: 1}}";

/// Returns a study over these speeds; `change` edits its text.
fn study(speeds: &str, change: impl Fn(String) -> String) -> String {
    let sweep = format!("sweep: [{{grid: {{speed_rad_s: {speeds}}}}}]\n");
    change(study_text("edited", DESIGN, 0.02, &sweep))
}

/// Runs a study of 512 runs into `out`, then the edited one, which must reuse `used` of its runs
/// and equal an independent computation.
fn edited(text: String, used: u64, all: u64) {
    let scratch = Scratch::ran(study("[-160.0, -216.0]", |text| text));
    let before = scratch.data("out");
    scratch.write("a.yaml", text);
    let ended = scratch.ended("run a.yaml --out out", 0);
    let runs = format!("{all} runs: {used} finished earlier, {} computed", all - used);
    assert_has(&ended.err, &["earlier results moved to out/earlier/1", &runs]);
    scratch.well("run a.yaml --out alone");
    assert_eq!(scratch.data("out"), scratch.data("alone"));
    // No earlier result is lost.
    assert_eq!(scratch.data("out/earlier/1"), before);
    // Restoring the old study computes nothing.
    scratch.write("a.yaml", study("[-160.0, -216.0]", |text| text));
    let back = scratch.stickslip("run a.yaml --out out");
    assert_has(&back.err, &["512 runs: 512 finished earlier, 0 computed"]);
    assert_eq!(scratch.data("out"), before);
}

/// What is replaced in the study of 512 runs, by what, and the used ones of all runs.
#[test]
fn an_edited_study_costs_what_is_new() {
    for (old, new, used, all) in [
        ("[-160.0, -216.0]", "[-160.0, -180.0, -216.0, -250.0]", 512, 1024),
        ("[-160.0, -216.0]", "[-216.0]", 256, 256),
        ("samples_per_cell: 1", "samples_per_cell: 3", 512, 1536),
        ("-216.0]}}", "-216.0], friction_coefficient: [2.75e-3, 1.0e-3]}}", 512, 1024),
    ] {
        edited(study("[-160.0, -216.0]", |text| text.replace(old, new)), used, all);
    }
}

/// An audit computes its selected runs a second time; these runs are not finished without the
/// audit.
#[test]
fn an_audit_costs_what_it_chooses() {
    let scratch = Scratch::ran(study("[-160.0]", |text| text));
    let audited = study("[-160.0]", |text| text + "audit: {fraction: 0.25}\n");
    scratch.write("a.yaml", audited);
    scratch.ended("run a.yaml --out out", 0);
    scratch.well("run a.yaml --out alone");
    assert_eq!(scratch.data("out"), scratch.data("alone"));
    let kept = scratch.manifest("out")["runs_kept"].as_u64().unwrap();
    assert!((150..240).contains(&kept), "{kept}");
}

/// If no run can be reused, nothing is computed without a request, and the differences are listed.
#[test]
fn what_cannot_be_used_again_is_refused_with_the_difference() {
    let scratch = Scratch::ran(study("[-160.0]", |text| text));
    let before = scratch.data("out");
    let other = |text: String| {
        text.replace("seed: 5", "seed: 6").replace("2e-2", "3e-2").replace("edited", "other")
    };
    scratch.write("b.yaml", study("[-160.0]", other));
    let refused = [
        "out: this directory contains the results of another study, and none of its runs can be reused",
        "\n  found:   study edited; it differs in\n    name: \"edited\" -> \"other\"\n    seed: 5 -> 6\n",
        "simulation.end_time_s: 0.02 -> 0.03",
        "allowed: another directory, with --out DIR; or --recompute",
    ];
    scratch.refused("run b.yaml --out out", &refused);
    let part = ["another shard", "shard 1/1 (this one", "shard 1/2)", "allowed: "];
    scratch.refused("run a.yaml --out out --shard 1/2", &part);
    scratch.well("run b.yaml --out out --recompute");
    scratch.well("run b.yaml --out alone");
    assert_eq!(scratch.data("out"), scratch.data("alone"));
    assert_eq!(scratch.bytes("out/earlier/1/runs.parquet"), before[0]);
}

/// An interrupted run of an edited study continues like any other.
#[test]
fn an_interrupted_edit_goes_on() {
    let scratch = Scratch::ran(study("[-160.0]", |text| text));
    scratch.write("a.yaml", study("[-160.0, -216.0]", |text| text));
    scratch.ended("run a.yaml --out out --max-seconds 0", 130);
    let ended = scratch.stickslip("resume out");
    assert_has(&ended.err, &["512 runs: 256 finished earlier, 256 computed"]);
    scratch.well("run a.yaml --out alone");
    assert_eq!(scratch.data("out"), scratch.data("alone"));
}

/// If the program is killed when it has moved all earlier results, but not yet named their folder, no table is lost.
#[test]
fn earlier_results_survive_a_kill() {
    let scratch = Scratch::ran(study("[-160.0]", |text| text));
    let first = scratch.data("out");
    fs::create_dir_all(scratch.path("out/earlier/1.partial")).expect("files of this test");
    for name in super::support::DATA_FILES.into_iter().chain(["manifest.json"]) {
        let to = scratch.path("out/earlier/1.partial").join(name);
        fs::rename(scratch.path("out").join(name), to).expect("files of this test");
    }
    scratch.write("a.yaml", study("[-160.0, -216.0]", |text| text));
    scratch.well("run a.yaml --out out");
    assert_eq!(scratch.data("out/earlier/1"), first);
}
