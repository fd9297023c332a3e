//! `report --figures`: what it writes, and what it refuses.

use std::fs;

use crate::cli::support::{AT_ONCE, Scratch, assert_has, study_text};

fn scratch() -> Scratch {
    let scratch = Scratch::new();
    let sweep = "sweep:\n  - grid: {speed_rad_s: [-160.0, -216.3772]}\n";
    scratch.write("a.yaml", study_text("a", "{monte_carlo: {samples: 20}}", AT_ONCE, sweep));
    scratch
}

fn names(out: &str) -> Vec<&str> {
    out.lines().collect()
}

#[test]
fn equilibria_runs_and_replays_are_drawn() {
    let scratch = scratch();
    scratch.well("equilibria a.yaml --grid 8 --out sets");
    let out = scratch.well("report sets --figures svg");
    assert_eq!(names(&out), ["sets-figures/equilibrium-set.svg"]);
    scratch.well("equilibria a.yaml --grid 8 --no-set --speeds=-150:-250:11 --out speeds");
    let out = scratch.well("report speeds --figures svg --out drawn");
    assert_eq!(names(&out), ["drawn/equilibrium-set.svg", "drawn/frictionless-branches.svg"]);
    // Once more: own figures are replaced, byte by byte the same.
    let before = fs::read(scratch.path("drawn/equilibrium-set.svg")).unwrap();
    scratch.well("report speeds --figures svg --out drawn");
    assert!(fs::read(scratch.path("drawn/equilibrium-set.svg")).unwrap() == before);

    scratch.well("run a.yaml --out runs --quiet");
    let out = scratch.well("report runs --figures svg");
    assert!(out.contains("runs-figures/fractions.svg"), "{out}");
    scratch.well("replay runs 3 --out motion");
    let out = scratch.well("report motion --figures png");
    assert_eq!(names(&out), ["motion-figures/motion.png"]);
    let png = fs::read(scratch.path("motion-figures/motion.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG") && png.len() > 10_000);
}

#[test]
fn blocks_are_drawn() {
    let scratch = Scratch::new();
    let study = format!("{}/studies/block-on-belt.yaml", env!("CARGO_MANIFEST_DIR"));
    scratch.well(&format!("run {study} --out runs --quiet"));
    assert!(scratch.well("report runs --figures svg").contains("fractions.svg"));
    scratch.well("replay runs 0 --out motion");
    scratch.well("report motion --figures svg");
    let text = fs::read_to_string(scratch.path("motion-figures/motion.svg")).unwrap();
    assert_has(&text, &["sliding speed", "friction [", "made by stickslip"]);
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let scratch = scratch();
    scratch.refused("report nowhere --figures svg", &["nothing to draw", "found:", "allowed:"]);
    for folder in ["empty", "other", "damaged"] {
        fs::create_dir(scratch.path(folder)).unwrap();
    }
    scratch.refused("report empty --figures svg", &["an empty directory", "stickslip run"]);
    scratch.write("other/thesis.tex", "");
    scratch.refused("report other --figures png", &["no manifest.json"]);
    scratch.refused("report other --figures pdf", &["pdf", "svg", "png"]);
    scratch.write("damaged/frictionless.parquet", "PAR1 and no more");
    scratch.refused("report damaged --figures svg", &["frictionless.parquet", "found:"]);
}

#[test]
fn tables_of_others_are_refused() {
    let scratch = scratch();
    scratch.well("equilibria a.yaml --grid 8 --no-set --out sets");
    // A table by another name has other columns.
    fs::create_dir(scratch.path("mixed")).unwrap();
    let sets = fs::read(scratch.path("sets/sets.parquet")).unwrap();
    scratch.write("mixed/frictionless.parquet", &sets);
    let said = ["nothing says what was written", "no files.json", "allowed:"];
    scratch.refused("report mixed --figures svg", &said);
    let list = fs::read_to_string(scratch.path("sets/files.json")).unwrap();
    let list: serde_json::Value = serde_json::from_str(&list).unwrap();
    let entry = &list["files"]["sets.parquet"];
    let files = serde_json::json!({"frictionless.parquet": entry, "trajectory.parquet": entry});
    let list = serde_json::json!({"format": list["format"], "files": files});
    scratch.write("mixed/files.json", list.to_string());
    scratch.refused(
        "report mixed --figures svg",
        &["not a table of these results", "table sets", "table frictionless"],
    );
    scratch.write("mixed/trajectory.parquet", &sets);
    fs::remove_file(scratch.path("mixed/frictionless.parquet")).unwrap();
    scratch.refused("report mixed --figures svg", &["table sets", "table trajectory"]);
}

#[test]
fn nothing_of_others_is_replaced() {
    let scratch = scratch();
    scratch.well("equilibria a.yaml --grid 8 --no-set --out sets");
    fs::create_dir(scratch.path("sets-figures")).unwrap();
    scratch.write("sets-figures/equilibrium-set.svg", "<svg>years of work</svg>");
    scratch.refused(
        "report sets --figures svg",
        &["would replace something else", "has not written", "--out"],
    );
    // Another format is another file; what is not ours stays.
    scratch.well("report sets --figures png");
    let kept = fs::read_to_string(scratch.path("sets-figures/equilibrium-set.svg")).unwrap();
    assert_eq!(kept, "<svg>years of work</svg>");
    scratch.write("file", "");
    scratch.refused("report sets --figures svg --out file", &["file"]);
}
