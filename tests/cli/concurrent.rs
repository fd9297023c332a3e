//! Concurrent writers of one table, and files of the user beside it.

#![cfg(unix)]

use std::fs;
use std::process::{Child, Command};

use super::support::{AT_ONCE, Ended, Scratch, study_text, table};

/// Returns the temporary names in a directory.
fn temporaries(scratch: &Scratch) -> Vec<String> {
    let names = fs::read_dir(scratch.path(".")).unwrap().map(|entry| entry.unwrap().file_name());
    let names = names.map(|name| name.into_string().unwrap());
    names.filter(|name| name.ends_with("partial")).collect()
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// Starts a program, suspends it after it has begun its table, runs a second one to its end, and
/// resumes the first. Both succeed, and after each the table is complete and its own.
fn both_end_well(scratch: &Scratch, first: &str, second: &str, rows: [usize; 2]) {
    let rows_now = || table(&scratch.path("r.parquet")).num_rows();
    let mut held = scratch.command(first).spawn().unwrap();
    while temporaries(scratch).is_empty() {
        assert!(held.try_wait().unwrap().is_none(), "it has ended before it was held");
        std::thread::yield_now();
    }
    signal(&held, "-STOP");
    let ended = scratch.stickslip(second);
    let now = if ended.code == Some(0) { rows_now() } else { 0 };
    signal(&held, "-CONT");
    assert_eq!((ended.code, now), (Some(0), rows[1]), "{}", ended.err);
    let ended = Ended::of(held.wait_with_output().unwrap());
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    assert_eq!(rows_now(), rows[0]);
    assert_eq!(temporaries(scratch), [""; 0]);
}

#[test]
fn two_expansions() {
    let scratch = Scratch::new();
    scratch.write("many.yaml", study_text("many", "{monte_carlo: {samples: 600000}}", AT_ONCE, ""));
    scratch.write("few.yaml", study_text("few", "{monte_carlo: {samples: 7}}", AT_ONCE, ""));
    let command = |study| format!("expand {study} --out r.parquet");
    both_end_well(&scratch, &command("many.yaml"), &command("few.yaml"), [600_000, 7]);
}

/// A directory that a process is filling is refused to another one, so that their files are not
/// mixed.
#[test]
fn a_replay_has_exclusive_use_of_its_directory() {
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 3}}", 0.02, ""));
    fs::create_dir(scratch.path("motion")).unwrap();
    let unfinished = fs::File::create(scratch.path("motion/unfinished")).unwrap();
    unfinished.lock().unwrap();
    let said = ["another process is writing into this directory"];
    scratch.tells("replay out 1 --out motion", 1, &said);
    unfinished.unlock().unwrap();
    scratch.well("replay out 1 --out motion");
    let mut names: Vec<_> = scratch.files().into_keys().collect();
    names.retain(|path| path.parent() == Some(&scratch.path("motion")));
    assert_eq!(names.len(), 4, "{names:?}");
}

/// Leftovers of killed processes in a results directory, and nothing else, are removed by the next
/// process.
#[test]
fn leftovers_in_results_do_not_accumulate() {
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 3}}", AT_ONCE, ""));
    fs::create_dir_all(scratch.path("out/runs.parquet.abc123.stickslip-partial/table")).unwrap();
    scratch.write("out/study.yaml.XYZ987.stickslip-partial", "half");
    scratch.well("run a.yaml --out out -q");
    scratch.well("run a.yaml --out alone -q");
    let names = |directory: &str| {
        let entries = fs::read_dir(scratch.path(directory)).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    assert_eq!(names("out"), names("alone"));
    // In a directory without results, files with such names are the user's.
    fs::create_dir(scratch.path("other")).unwrap();
    scratch.write("other/runs.parquet.partial", "mine");
    scratch.refused("run a.yaml --out other", &["other: this directory is not empty"]);
}
