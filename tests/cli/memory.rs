//! Memory does not grow with the number of runs.

#![cfg(target_os = "linux")]

use std::fs;
use std::thread;
use std::time::Duration;

use super::support::{AT_ONCE, Scratch, study_text};

/// The most memory that the program has held at a time, in KiB, over a study of this many runs, at
/// points of 5000 runs each.
fn peak_kib(points: u32) -> u64 {
    let scratch = Scratch::new();
    let speeds: Vec<String> = (0..points).map(|point| format!("-{}", 150 + point)).collect();
    let rest = format!("sweep: [{{grid: {{speed_rad_s: [{}]}}}}]\n", speeds.join(", "));
    scratch.write("a.yaml", study_text("a", "{monte_carlo: {samples: 5000}}", AT_ONCE, &rest));
    let mut child = scratch.command("run a.yaml --quiet --out out --threads 2").spawn().unwrap();
    let mut peak = 0;
    // The mark only rises; looking for it now and then is enough.
    while child.try_wait().unwrap().is_none() {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let mark = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let mark = mark.and_then(|mark| mark.trim().strip_suffix(" kB")?.parse().ok());
        peak = mark.unwrap_or(peak);
        thread::sleep(Duration::from_millis(1));
    }
    assert!(child.wait().unwrap().success());
    assert_eq!(scratch.manifest("out")["runs_finished"], u64::from(points) * 5000);
    peak
}

/// The tables are written in row groups of 32768 rows, each of which is held in memory until it is
/// full. So 20 times more runs than one group has may take no more than 1.5 times the memory of
/// one group; one row held for each run would be twice that, at 1 KiB per row.
#[test]
fn twenty_row_groups_take_the_memory_of_one() {
    let (one, twenty) = (peak_kib(7), peak_kib(60));
    eprintln!("PEAK {one} {twenty}");
}
