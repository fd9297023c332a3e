//! Output directories: filled once, nothing in them ever lost, and only by studies that are theirs.

use std::fs;

use super::support::{AT_ONCE, DATA_FILES, Scratch, assert_has, study_text};

/// Four short runs at each of two speeds.
fn small(seed_and_more: &str) -> String {
    let sweep = "sweep: [{grid: {speed_rad_s: [-160.0, -200.0]}}]\n";
    study_text("small", "{monte_carlo: {samples: 4}}", AT_ONCE, sweep)
        .replace("seed: 5\n", seed_and_more)
}

#[test]
fn a_study_fills_its_directory_once() {
    let scratch = Scratch::new();
    scratch.write("a.yaml", small("seed: 5\n"));
    let ended = scratch.stickslip("run a.yaml --out deep/down");
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    let header = "point  speed_rad_s  runs  equilibria  fraction     95 % interval  median rest";
    assert_has(&ended.out, &[header, "    0         -160     4", "    1         -200     4"]);
    assert_eq!(ended.out.lines().count(), 3, "{}", ended.out);
    assert_has(&ended.err, &["8 runs in ", "tables in deep/down"]);
    let mut names: Vec<String> = fs::read_dir(scratch.path("deep/down"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let mut expected = DATA_FILES.to_vec();
    expected.extend(["manifest.json", "chunks"]);
    expected.sort_unstable();
    assert_eq!(names, expected);

    let before = scratch.files();
    let again = scratch.stickslip("run a.yaml --out deep/down --threads 1");
    assert_eq!((again.code, &again.out), (Some(0), &ended.out));
    assert_has(&again.err, &["deep/down already holds all 8 runs of this study: nothing to do"]);
    // Only what decides the runs counts, not the file's name, form and comments.
    scratch.write("b.yaml", format!("# another comment\n{}", small("seed:   5\n")));
    assert_eq!(scratch.stickslip("run b.yaml --out deep/down").code, Some(0));
    fs::remove_file(scratch.path("b.yaml")).unwrap();
    assert_eq!(scratch.files(), before);
}

#[test]
fn without_out_the_tables_go_into_results() {
    let scratch = Scratch::new();
    scratch.write("a.yaml", small("seed: 5\n"));
    scratch.well("run a.yaml");
    assert!(scratch.path("results/small/manifest.json").exists());
}

#[test]
fn an_empty_directory_is_used() {
    let scratch = Scratch::new();
    scratch.write("a.yaml", small("seed: 5\n"));
    fs::create_dir(scratch.path("out")).unwrap();
    scratch.well("run a.yaml --out out");
    assert_eq!(scratch.table("out", "runs").num_rows(), 8);
}

#[test]
fn another_study_is_refused() {
    let scratch = Scratch::new();
    scratch.write("a.yaml", small("seed: 5\n"));
    scratch.write("other.yaml", small("seed: 6\n").replace("small", "other"));
    scratch.well("run a.yaml --out out");
    let refused = [
        "out: this directory holds the results of another study, of which no run can be used",
        "\n  found:   study small; it differs in\n    name: \"small\" -> \"other\"\n    seed: 5 -> 6",
        "\n  allowed: another directory, with --out DIR",
    ];
    scratch.refused("run other.yaml --out out", &refused);
    let part = ["another shard", "shard 1/1 (this one", "shard 1/2)", "allowed: "];
    scratch.refused("run a.yaml --out out --shard 1/2", &part);
}

#[test]
fn foreign_files_are_left_alone() {
    let scratch = Scratch::new();
    scratch.write("a.yaml", small("seed: 5\n"));
    fs::create_dir(scratch.path("home")).unwrap();
    scratch.write("home/thesis.tex", "years of work");
    let foreign = ["home: this directory is not empty", "found:   files without a manifest.json"];
    scratch.refused("run a.yaml --out home", &foreign);
    scratch.refused("verify smoke.yaml --out home", &["smoke.yaml"]);
    scratch.write("home/manifest.json", "{\"name\": \"a web application\"}");
    scratch.refused(
        "run a.yaml --out home",
        &["home: manifest.json is damaged, or no manifest of ours", "found: ", "allowed: "],
    );
}

/// Tests may run as root, whom no permission stops: a path below a file cannot be made by anyone.
#[test]
fn directories_that_cannot_be_made() {
    let scratch = Scratch::new();
    scratch.write("a.yaml", small("seed: 5\n"));
    for out in ["a.yaml", "a.yaml/out", "a.yaml/further/down"] {
        let message = [out, ": cannot be used as output directory\n  found: ", "allowed: "];
        scratch.refused(&format!("run a.yaml --out {out}"), &message);
    }
}
