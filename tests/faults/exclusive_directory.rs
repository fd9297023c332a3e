//! `equilibria` and `replay` interrupted midway: the same command completes its directory, which it has to itself, and
//! replaces no file that it has not written.

use std::fs;

use super::stopped_at;
use crate::cli::support::{Scratch, assert_has, study_text};

/// The commands, without `--out`, and what they write.
const COMMANDS: [(&str, &[&str]); 2] = [
    (
        "equilibria a.yaml --grid 64",
        &[
            "equilibrium_positions.parquet",
            "equilibrium_set_summary.parquet",
            "frictionless_equilibria.parquet",
        ],
    ),
    ("replay a 1", &["trajectory.parquet", "switches.parquet", "replay.html"]),
];

/// Results of a small study in `a`.
fn scratch() -> Scratch {
    let sweep = "sweep: [{grid: {speed_rad_s: [-160.0, -200.0]}}]\n";
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 4}}", 2.0, sweep));
    scratch.well("run a.yaml --out a");
    scratch
}

/// Returns the files of a directory with their contents.
fn files(scratch: &Scratch, directory: &str) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(scratch.path(directory)).unwrap().map(|entry| entry.unwrap());
    let file = |entry: fs::DirEntry| {
        (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap_or_default())
    };
    let mut files: Vec<_> = entries.map(file).collect();
    files.sort();
    files
}

#[test]
fn a_command_that_was_stopped_goes_on_in_its_directory() {
    let scratch = scratch();
    for (command, names) in COMMANDS {
        let whole = format!("whole-{}", names[0]);
        scratch.well(&format!("{command} --out {whole}"));
        let before = files(&scratch, &whole);
        assert_eq!(before.len(), names.len() + 1, "and files.json");
        stopped_at(&scratch, 16, &format!("{command} --out out"));
        let left = files(&scratch, "out");
        assert!(left.contains(&("unfinished".to_owned(), Vec::new())), "{left:?}");
        // While a process fills the directory, another one is refused, so that their files are not mixed.
        let unfinished = fs::File::open(scratch.path("out/unfinished")).expect("the mark");
        unfinished.lock().expect("no other process");
        let said = ["another process is writing into this directory"];
        scratch.tells(&format!("{command} --out out"), 1, &said);
        unfinished.unlock().expect("its own lock");
        scratch.well(&format!("{command} --out out"));
        assert_eq!(files(&scratch, "out"), before, "{command}");
        // A complete directory is not filled again.
        let occupied = ["out: this directory is not empty", "allowed: another directory"];
        scratch.refused(&format!("{command} --out out"), &occupied);
        // Killed when some of the files had their final names.
        for finished in 0..=names.len() {
            fs::remove_dir_all(scratch.path("out")).unwrap();
            fs::create_dir(scratch.path("out")).unwrap();
            scratch.write("out/unfinished", "");
            // A partial file as a killed process leaves it.
            scratch.write(&format!("out/{}.abc123.stickslip-partial", names[0]), "half");
            for name in &names[..finished] {
                fs::copy(scratch.path(&whole).join(name), scratch.path("out").join(name)).unwrap();
            }
            scratch.well(&format!("{command} --out out"));
            assert_eq!(files(&scratch, "out"), before, "{command}: {finished} files");
        }
        fs::remove_dir_all(scratch.path("out")).unwrap();
    }
}

#[test]
fn nothing_else_is_replaced() {
    let scratch = scratch();
    for (command, names) in COMMANDS {
        // Directories that the program did not begin, or with a foreign file.
        for others in [
            &["equilibrium_set_summary.parquet"][..],
            &["trajectory.parquet"],
            &["unfinished", "notes.txt"],
        ] {
            fs::create_dir(scratch.path("out")).unwrap();
            others.iter().for_each(|name| drop(scratch.write(&format!("out/{name}"), "")));
            let occupied = ["out: this directory is not empty", "allowed: another directory"];
            scratch.refused(&format!("{command} --out out"), &occupied);
            fs::remove_dir_all(scratch.path("out")).unwrap();
        }
        fs::create_dir(scratch.path("out")).unwrap();
        scratch.write("out/unfinished", "years of work");
        scratch.refused(&format!("{command} --out out"), &["out: this directory is not empty"]);
        // A directory that the program began, with a foreign file under one of its names.
        for name in names {
            fs::remove_dir_all(scratch.path("out")).unwrap();
            fs::create_dir(scratch.path("out")).unwrap();
            scratch.write("out/unfinished", "");
            scratch.write(&format!("out/{name}"), "mine");
            let ended = scratch.stickslip(&format!("{command} --out out"));
            assert!([Some(1), Some(2)].contains(&ended.code), "{name}: {}", ended.err);
            assert_has(&ended.err, &[name, "is not replaced"]);
            assert_eq!(fs::read(scratch.path("out").join(name)).unwrap(), b"mine");
        }
        fs::remove_dir_all(scratch.path("out")).unwrap();
    }
}
