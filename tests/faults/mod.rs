//! Robustness of studies: no finished run is lost, no row is wrong, and the final bytes are the
//! same.

#![cfg(target_os = "linux")]

mod disk;
mod exclusive_directory;
mod killed;
mod panics;
mod small_faults;
mod tampering;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::cli::support::{Ended, Scratch, study_text};

/// 6400 runs of about a twentieth of a millisecond, in a hundred chunks of 64.
pub const CHUNKS: u64 = 100;

fn study() -> String {
    let sweep = "sweep: [{grid: {speed_rad_s: [-160.0, -216.0]}}]\n";
    study_text("bad-day", "{monte_carlo: {samples: 3200}}", 0.05, sweep)
}

/// Returns the chunk folder of the single study in a results directory, if there is one.
fn chunks(directory: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(directory.join("chunks")).ok()?;
    entries.map(|entry| entry.unwrap().path()).find(|path| path.is_dir())
}

/// Returns the finished chunks of a results directory: the lines of their list.
fn finished(directory: &Path) -> Vec<String> {
    let list = chunks(directory).map(|folder| folder.join("manifest.jsonl"));
    let text = list.and_then(|list| fs::read_to_string(list).ok()).unwrap_or_default();
    text.lines().map(str::to_owned).collect()
}

/// Runs a shell script in which `$s` is the program.
fn shell(scratch: &Scratch, script: &str) -> Ended {
    let script = format!("s={}\n{script}", env!("CARGO_BIN_EXE_stickslip"));
    let mut command = Command::new("sh");
    command.args(["-c", &script]).current_dir(scratch.path("."));
    Ended::of(command.output().expect("a shell"))
}

/// Runs the program with a file size limit of `blocks` blocks of 512 bytes.
fn stopped_at(scratch: &Scratch, blocks: u32, arguments: &str) {
    let script = format!("ulimit -c 0; ulimit -f {blocks}; exec $s {arguments}");
    let ended = shell(scratch, &script);
    assert_eq!(ended.code, Some(1), "{arguments}: {}", ended.err);
    assert!(ended.err.contains("File too large"), "{arguments}: {}", ended.err);
}

/// An interrupted study in `out`, and the complete one in `whole`.
fn halfway(scratch: &Scratch) {
    scratch.write("a.yaml", study());
    scratch.well("run a.yaml --out whole --chunk 64");
    let mut child = scratch.command("run a.yaml --out out --chunk 64").spawn().unwrap();
    while finished(&scratch.path("out")).len() < 20 {
        assert!(child.try_wait().unwrap().is_none(), "it has ended before it could be killed");
        std::thread::yield_now();
    }
    child.kill().unwrap();
    child.wait().unwrap();
}
