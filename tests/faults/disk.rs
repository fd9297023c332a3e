//! Full disks and directories without write permission.

use std::fs;
use std::process::{Command, Output};

use super::{finished, halfway, shell, study};
use crate::cli::support::{Ended, Scratch, assert_has};

/// Runs a script in a mount namespace of its own, whose file systems vanish when it ends.
fn with_mounts(scratch: &Scratch, script: &str) -> Output {
    let script = format!("set -e\nstickslip={}\n{script}", env!("CARGO_BIN_EXE_stickslip"));
    let mut command = Command::new("unshare");
    command.args(["--user", "--map-root-user", "--mount", "sh", "-c", &script]);
    command.current_dir(scratch.path(".")).output().expect("unshare, of util-linux")
}

/// On a disk of 200 kB the program reports that it is full and keeps the finished runs; on a larger
/// one the study continues.
#[test]
fn a_full_disk_loses_nothing() {
    let scratch = Scratch::with(study());
    scratch.well("run a.yaml --out whole");
    fs::create_dir(scratch.path("small")).unwrap();
    let output = with_mounts(
        &scratch,
        "mount -t tmpfs -o size=200k none small\n\
         code=0; $stickslip run a.yaml --out small/out --chunk 64 --threads 2 || code=$?\n\
         cp -r small/out out\nexit $code",
    );
    let ended = Ended::of(output);
    assert_eq!(ended.code, Some(1), "{}", ended.err);
    assert!(ended.err.contains("No space left on device"), "{}", ended.err);
    let kept = finished(&scratch.path("out"));
    assert!((2..90).contains(&kept.len()), "{}", kept.len());
    scratch.ended("resume out", 0);
    assert_eq!(finished(&scratch.path("out"))[..kept.len() - 1], kept[..kept.len() - 1]);
    assert_eq!(scratch.data("out"), scratch.data("whole"));
    let runs_kept = scratch.manifest("out")["runs_kept"].as_u64().unwrap();
    // The last line of the list may belong to a chunk for which there was no space.
    assert!(runs_kept >= (kept.len() as u64 - 1) * 64, "{runs_kept} of {} chunks", kept.len());
}

/// A directory that cannot be written to is refused, for any user.
#[test]
fn a_read_only_directory_is_refused() {
    let scratch = Scratch::new();
    halfway(&scratch);
    let before = scratch.files();
    let output = with_mounts(
        &scratch,
        "mount --bind out out\nmount -o remount,bind,ro out\n\
         code=0; $stickslip resume out || code=$?\n\
         test $code = 2\n$stickslip run a.yaml --out out/new",
    );
    let ended = Ended::of(output);
    assert_eq!(ended.code, Some(2), "{}", ended.err);
    assert_eq!(ended.err.matches("cannot be used as output directory").count(), 2, "{}", ended.err);
    assert_eq!(ended.err.matches("Read-only file system").count(), 2, "{}", ended.err);
    assert_eq!(scratch.files(), before);
    scratch.well("resume out");
    assert_eq!(scratch.data("out"), scratch.data("whole"));
}

/// A file size limit is reported as an error with the file's name instead of ending the program
/// silently.
#[test]
fn a_limit_of_the_size_of_files_is_told_with_the_file() {
    let scratch = Scratch::with(study());
    scratch.well("run a.yaml --out whole");
    // At most one block of 512 or 1024 bytes in a file.
    for (arguments, file) in
        [("run a.yaml --out out", "out"), ("report whole --out page.html", "page.html")]
    {
        let ended = shell(&scratch, &format!("ulimit -f 1; exec $s {arguments}"));
        assert!(matches!(ended.code, Some(1 | 2)), "{arguments}: {:?} {}", ended.code, ended.err);
        assert_has(&ended.err, &["File too large", file]);
    }
    scratch.ended("run a.yaml --out out", 0);
    assert_eq!(scratch.data("out"), scratch.data("whole"));
}
