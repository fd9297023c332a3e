//! Robustness of studies: no finished run is lost, no row is wrong, and the final bytes are the
//! same.

#![cfg(target_os = "linux")]

mod disk;
mod exclusive_directory;
mod killed;
mod panics;
mod small_faults;
mod tampering;
mod two_processes;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::cli::support::{Scratch, study_text};

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

/// Runs the program with a file size limit of `blocks` blocks of 512 bytes.
fn stopped_at(scratch: &Scratch, blocks: u32, arguments: &str) {
    let program = env!("CARGO_BIN_EXE_stickslip");
    let script = format!("ulimit -c 0; ulimit -f {blocks}; exec {program} {arguments}");
    let mut command = Command::new("sh");
    let output = command.args(["-c", &script]).current_dir(scratch.path(".")).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments}: {said}");
    assert!(said.contains("File too large"), "{arguments}: {said}");
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
