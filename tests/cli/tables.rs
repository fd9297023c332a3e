//! Tables beside the study file and elsewhere: the option `--tables` of every command that reads a
//! study.

use std::fs;

use super::support::{AT_ONCE, Scratch, study_text};

/// A study in `studies/` with its table in `tables/`.
fn scratch() -> Scratch {
    let scratch = Scratch::new();
    fs::create_dir(scratch.path("studies")).unwrap();
    fs::create_dir(scratch.path("tables")).unwrap();
    scratch.write("tables/speeds.csv", "speed_rad_s\n-160\n-200\n");
    let sweep = "sweep: [{table: ../tables/speeds.csv}]\n";
    let expect = "expect: [{equilibrium_fraction: [0, 1]}]\n";
    let text = study_text("a", "{monte_carlo: {samples: 2}}", AT_ONCE, &format!("{sweep}{expect}"));
    scratch.write("studies/a.yaml", text);
    scratch
}

#[test]
fn every_command_that_reads_a_study_has_the_option() {
    let scratch = scratch();
    let study = "studies/a.yaml";
    for command in ["run", "check", "expand", "verify", "equilibria"] {
        let outside = [
            "studies/a.yaml:7:17: `sweep[0].table`: the table cannot be read: the table lies outside",
            "\n  found:   ../tables/speeds.csv",
            "\n  allowed: a file in the study file's directory or a subdirectory, or the option --tables DIR",
        ];
        scratch.refused(&format!("{command} {study}"), &outside);
        scratch.refused(
            &format!("{command} {study} --tables studies"),
            &["the directories given with --tables"],
        );
        scratch.refused(&format!("{command} {study} --tables none"), &["none: No such file"]);
    }
    scratch.well("check studies/a.yaml --tables studies --tables tables");
    scratch.well("expand studies/a.yaml --tables tables");
    scratch.well("verify studies/a.yaml --tables tables");
    scratch.well("equilibria studies/a.yaml --tables . --out sets --no-set --grid 16");
}

#[test]
fn manifests_do_not_lead_out_of_their_directory() {
    let scratch = scratch();
    scratch.well("run studies/a.yaml --tables tables --out out");
    scratch.write("secret.parquet", "a file elsewhere");
    let right = scratch.text("out/manifest.json");
    let absolute = scratch.path("secret.parquet").display().to_string();
    for name in ["../secret.parquet", "..", ".", "", "a/../../secret.parquet", &absolute] {
        let wrong = right.replace("\"runs.parquet\"", &format!("{name:?}"));
        assert_ne!(wrong, right);
        scratch.write("out/manifest.json", wrong);
        let refused = ["out: ", "names a file outside of its directory"];
        scratch.refused("run studies/a.yaml --tables tables --out out", &refused);
    }
}

#[cfg(unix)]
#[test]
fn special_files_in_place_of_a_manifest_are_not_read() {
    let scratch = scratch();
    fs::create_dir(scratch.path("out")).unwrap();
    let run = "run studies/a.yaml --tables tables --out out";
    std::os::unix::fs::symlink("/dev/zero", scratch.path("out/manifest.json")).unwrap();
    scratch.tells(run, 2, &["not a regular file"]);
    fs::remove_file(scratch.path("out/manifest.json")).unwrap();
    let made = std::process::Command::new("mkfifo").arg(scratch.path("out/manifest.json")).status();
    assert!(made.unwrap().success());
    let ended = scratch.stickslip(run);
    assert!(ended.code == Some(2) && ended.err.contains("not a regular file"), "{}", ended.err);
}

/// Chunks in a list may be huge, endless, or have the highest possible number.
#[cfg(unix)]
#[test]
fn lists_of_chunks_are_not_trusted() {
    let scratch = scratch();
    let run = "run studies/a.yaml --tables tables --out out";
    scratch.well(&format!("{run} --quiet"));
    let whole = scratch.data("out");
    let folder = scratch.chunks("out");
    let line = |chunk: u64, bytes: u64| {
        format!(
            "{{\"chunk\":{chunk},\"first_run\":0,\"last_run\":3,\"runs\":4,\"bytes\":{bytes},\
             \"sha256\":\"00\"}}\n"
        )
    };
    let again = |list: String| {
        fs::remove_dir_all(scratch.path("out")).unwrap();
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("manifest.jsonl"), list).unwrap();
    };
    // The highest possible number; the next one would overflow.
    again(line(u64::MAX, 100));
    scratch.well(run);
    assert_eq!(scratch.data("out"), whole);
    // A chunk without an end, and one of a terabyte of zeros.
    again(line(7, 0));
    std::os::unix::fs::symlink("/dev/zero", folder.join("000007.chunk")).unwrap();
    scratch.well(run);
    assert_eq!(scratch.data("out"), whole);
    again(line(7, 1 << 40));
    fs::File::create(folder.join("000007.chunk")).unwrap().set_len(1 << 40).unwrap();
    scratch.well(run);
    assert_eq!(scratch.data("out"), whole);
    // Invalid lines do not cause one message each.
    again("x\n".repeat(100_000));
    let ended = scratch.stickslip(run);
    assert!(ended.code == Some(0) && ended.err.len() < 10_000, "{} bytes", ended.err.len());
    assert_eq!(scratch.data("out"), whole);
}
