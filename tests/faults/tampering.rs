//! Tampering with a results directory: links and pipes in it, changed or removed files.

use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;

use super::{chunks, finished, halfway, study};
use crate::cli::support::{Scratch, assert_has};

/// A complete study of a few runs, in `out`.
fn complete() -> Scratch {
    Scratch::ran(study().replace("samples: 3200", "samples: 40"))
}

/// No file outside of the directory is written through a link.
#[test]
fn links_are_not_written_through() {
    for name in ["manifest.json", "study.yaml", "runs.parquet"] {
        let name = format!("{name}.abc123.stickslip-partial");
        let scratch = complete();
        let before = scratch.data("out");
        scratch.write("victim", "precious");
        fs::remove_file(scratch.path("out/runs.parquet")).unwrap();
        symlink(scratch.path("victim"), scratch.path("out").join(&name)).unwrap();
        let ended = scratch.stickslip("resume out --quiet");
        assert_eq!(fs::read_to_string(scratch.path("victim")).unwrap(), "precious", "{name}");
        assert_eq!(ended.code, Some(0), "{}", ended.err);
        assert_eq!(scratch.data("out"), before, "{name}");
        assert!(fs::symlink_metadata(scratch.path("out").join(&name)).is_err(), "{name}");
    }
    for name in ["out/chunks", "out/earlier", "out/chunks/lock"] {
        let scratch = complete();
        fs::create_dir(scratch.path("elsewhere")).unwrap();
        fs::remove_file(scratch.path("out/runs.parquet")).unwrap();
        let path = scratch.path(name);
        if path.is_dir() {
            fs::remove_dir_all(&path).unwrap();
        } else if path.exists() {
            fs::remove_file(&path).unwrap();
        }
        symlink(scratch.path("elsewhere"), &path).unwrap();
        let ended = scratch.stickslip("resume out");
        assert_eq!(ended.code, Some(2), "{name}: {}", ended.err);
        assert_eq!(fs::read_dir(scratch.path("elsewhere")).unwrap().count(), 0, "{name}");
    }
}

/// No file is written through links below the directory: in place of a chunk folder of this or
/// another study, of the chunk list, or of earlier results that are being moved.
#[test]
fn links_below_are_not_written_through() {
    let names =
        ["OWN", "0123456789abcdef", "OWN/manifest.jsonl"].map(|name| format!("chunks/{name}"));
    for name in
        names.into_iter().chain(["earlier/1.partial".to_owned(), "earlier/3.partial".to_owned()])
    {
        for command in ["resume out", "run a.yaml --out out", "run edited.yaml --out out"] {
            let scratch = complete();
            let edited = study().replace("samples: 3200", "samples: 41");
            scratch.write("edited.yaml", edited);
            fs::remove_file(scratch.path("out/runs.parquet")).unwrap();
            let folder = chunks(&scratch.path("out")).expect("a folder");
            let name =
                name.replace("OWN", folder.file_name().expect("a name").to_str().expect("ASCII"));
            let path = scratch.path("out").join(&name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            // The contents are moved to the link's target, so that nothing is missing.
            let elsewhere = scratch.path("elsewhere");
            if path.exists() {
                fs::rename(&path, &elsewhere).unwrap();
            } else {
                fs::create_dir(&elsewhere).unwrap();
            }
            symlink(&elsewhere, &path).unwrap();
            let before = scratch.files();
            let ended = scratch.stickslip(command);
            assert_eq!(ended.code, Some(2), "{command} with {name}: {}", ended.err);
            assert_has(&ended.err, &["cannot be used as output directory", "allowed: "]);
            assert_eq!(scratch.files(), before, "{command} with {name}");
        }
    }
}

/// The target of a link is not accepted as a chunk or table.
#[test]
fn links_are_not_read_through() {
    let scratch = complete();
    let before = scratch.data("out");
    let chunk = chunks(&scratch.path("out")).expect("a folder").join("000000.chunk");
    for path in [chunk, scratch.path("out/runs.parquet")] {
        fs::rename(&path, scratch.path("elsewhere")).unwrap();
        symlink(scratch.path("elsewhere"), &path).unwrap();
    }
    let ended = scratch.ended("resume out", 0);
    let told =
        ["runs.parquet: not a regular file", "000000.chunk: not a regular file", "\n80 runs in "];
    assert_has(&ended.err, &told);
    assert_eq!(scratch.data("out"), before);

    // In an interrupted study with a table of many parts, the link itself is moved aside.
    let scratch = complete();
    assert_eq!(scratch.stickslip("run a.yaml --out new --max-seconds 0").code, Some(130));
    fs::create_dir(scratch.path("elsewhere")).unwrap();
    fs::remove_file(scratch.path("new/runs.parquet")).unwrap();
    symlink(scratch.path("elsewhere"), scratch.path("new/runs.parquet")).unwrap();
    scratch.well("resume new");
    assert_eq!(fs::read_dir(scratch.path("elsewhere")).unwrap().count(), 0);
    assert!(scratch.path("new/earlier/1/runs.parquet").is_symlink());
    assert_eq!(scratch.data("new"), before);
}

/// Pipes in place of files do not block the program.
#[test]
fn pipes_do_not_hang() {
    for name in ["chunks/lock", "manifest.json.abc123.stickslip-partial"] {
        let scratch = complete();
        let pipe = scratch.path("out").join(name);
        fs::remove_file(scratch.path("out/runs.parquet")).unwrap();
        let _ = fs::remove_file(&pipe);
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let ended = scratch.stickslip("resume out");
        assert!([Some(0), Some(2)].contains(&ended.code), "{name}: {}", ended.err);
    }
}

/// If the lock of a running study is removed, the study does not claim tables that another process
/// may have written.
#[test]
fn a_lost_lock_is_noticed() {
    let scratch = Scratch::with(study());
    scratch.well("run a.yaml --out whole");
    let child = scratch.command("run a.yaml --out out --chunk 64").spawn().unwrap();
    while finished(&scratch.path("out")).len() < 2 {
        std::thread::yield_now();
    }
    fs::remove_file(scratch.path("out/chunks/lock")).unwrap();
    let ended = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(ended.status.code(), Some(1), "{said}");
    assert_has(
        &said,
        &["out: this process lost its lock on the directory", "allowed: no other process"],
    );
    assert_eq!(scratch.manifest("out")["complete"], false);
    scratch.well("resume out");
    assert_eq!(scratch.data("out"), scratch.data("whole"));
}

/// Tables are identified by their content, not their size; a study with another name has another
/// study.yaml.
#[test]
fn changed_content_is_made_again() {
    let scratch = complete();
    let before = scratch.data("out");
    let mut changed = before[0].clone();
    let middle = changed.len() / 2;
    changed[middle] ^= 1;
    for (number, (content, what)) in [
        (&changed[..], "the content of runs.parquet"),
        (&changed[..100], "runs.parquet of 100 bytes"),
    ]
    .into_iter()
    .enumerate()
    {
        scratch.write("out/runs.parquet", content);
        let (aside, changes) =
            (format!("earlier/{}", number + 1), format!("changed since they were written: {what}"));
        scratch.tells("run a.yaml --out out", 0, &[&*changes, &aside, " 0 computed"]);
        assert_eq!(scratch.data("out"), before);
        assert_eq!(scratch.bytes(&format!("out/{aside}/runs.parquet")), content);
    }

    let renamed =
        fs::read_to_string(scratch.path("a.yaml")).unwrap().replace("bad-day", "good-day");
    scratch.write("b.yaml", renamed);
    let ended = scratch.stickslip("run b.yaml --out out");
    assert_has(&ended.err, &["study.yaml, by another name", " 0 computed"]);
    scratch.well("run b.yaml --out alone");
    assert_eq!(scratch.data("out"), scratch.data("alone"));
}

/// A shard whose chunks were removed is computed again by `merge`, with a message; and a damaged
/// chunk never replaces one that was moved aside before.
#[test]
fn removed_chunks_are_reported() {
    let scratch = complete();
    for part in ["1", "2"] {
        scratch.well(&format!("run a.yaml --shard {part}/2 --out part{part}"));
    }
    fs::remove_file(chunks(&scratch.path("part2")).unwrap().join("manifest.jsonl")).unwrap();
    let ended = scratch.stickslip("merge part1 part2 --out merged");
    assert_has(&ended.err, &["part2: only 0 of its 40 finished runs are listed in chunks/"]);
    assert_eq!(scratch.data("merged"), scratch.data("out"));

    let scratch = Scratch::new();
    halfway(&scratch);
    let folder = chunks(&scratch.path("out")).expect("a folder");
    fs::write(folder.join("000003.chunk.damaged"), "put aside before").unwrap();
    fs::write(folder.join("000003.chunk"), "damaged").unwrap();
    scratch.well("resume out");
    let content = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    assert_eq!(content("000003.chunk.damaged"), "put aside before");
    assert_eq!(content("000003.chunk.damaged-2"), "damaged");
    assert_eq!(scratch.data("out"), scratch.data("whole"));
}
