//! Memory does not grow with the number of runs.

#![cfg(target_os = "linux")]

use std::fs;
use std::thread;
use std::time::Duration;

use super::support::{AT_ONCE, Scratch, study_text};

/// The most memory that the program has held at a time, in KiB, over a study of this many points with
/// this many runs each.
fn peak_kib(points: u32, runs: u32) -> u64 {
    let scratch = Scratch::new();
    let speeds: Vec<String> = (0..points).map(|point| format!("-{}", 150 + point)).collect();
    let rest = format!("sweep: [{{grid: {{speed_rad_s: [{}]}}}}]\n", speeds.join(", "));
    scratch.write(
        "a.yaml",
        study_text("a", &format!("{{monte_carlo: {{samples: {runs}}}}}"), AT_ONCE, &rest),
    );
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
    assert_eq!(scratch.manifest("out")["runs_finished"], u64::from(points) * u64::from(runs));
    peak
}

/// What a study may take above one of 10,000 runs: 35 KiB of footer for each row group of 8192 rows,
/// and at most 65,536 different times and amplitudes of a point. Anything kept of every run would
/// take far more: a record of a run alone takes half a KiB, 95 MiB for 190,000 runs.
const ALLOWED_KIB: u64 = 12 * 1024;

#[test]
fn a_study_of_200_000_runs_takes_the_memory_of_one_of_10_000() {
    let small = peak_kib(2, 5000);
    let (many_points, one_point) = (peak_kib(40, 5000), peak_kib(1, 200_000));
    println!("10,000 runs: {small} KiB; 200,000: {many_points} KiB, at one point {one_point} KiB");
    assert!(small > 1024 && many_points.max(one_point) < small + ALLOWED_KIB);
}
