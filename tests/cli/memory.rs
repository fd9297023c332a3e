//! Memory does not grow with the number of runs.

#![cfg(target_os = "linux")]

use std::fs;
use std::thread;
use std::time::Duration;

use super::support::{AT_ONCE, Scratch, study_text};

/// Returns the peak memory of the program, in KiB, over a study of this many runs.
fn peak_kib(text: &str, runs: u64) -> u64 {
    let scratch = Scratch::with(text);
    let mut child = scratch.command("run a.yaml --quiet --out out --threads 2").spawn().unwrap();
    let mut peak = 0;
    // The mark only rises; polling it occasionally is enough.
    while child.try_wait().unwrap().is_none() {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let mark = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let mark = mark.and_then(|mark| mark.trim().strip_suffix(" kB")?.parse().ok());
        peak = mark.unwrap_or(peak);
        thread::sleep(Duration::from_millis(1));
    }
    assert!(child.wait().unwrap().success());
    let manifest = scratch.manifest("out");
    assert_eq!(manifest["runs_finished"], runs);
    assert!(manifest["files"]["time_to_rest.parquet"]["rows"].as_u64().unwrap() <= 1000);
    peak
}

/// Runs that stop immediately, at this many points with this many runs each.
fn stopped_peak_kib(points: u32, runs: u32) -> u64 {
    let speeds: Vec<String> = (0..points).map(|point| format!("-{}", 150 + point)).collect();
    let rest = format!("sweep: [{{grid: {{speed_rad_s: [{}]}}}}]\n", speeds.join(", "));
    let design = format!("{{monte_carlo: {{samples: {runs}}}}}");
    peak_kib(&study_text("a", &design, AT_ONCE, &rest), u64::from(points) * u64::from(runs))
}

/// Runs at one point that come to rest at different times.
fn rested_peak_kib(runs: u64) -> u64 {
    let start_box = "position_m: [-0.1, 0.1], velocity_m_s: [-1, 1]";
    let design = format!("{{monte_carlo: {{samples: {runs}}}}}, box: {{{start_box}}}");
    let model = "model: {kind: block_on_spring, parameters: {friction_coefficient: 0.2}}\n";
    peak_kib(&study_text("a", &design, 30.0, model), runs)
}

/// Allowance above a study of 10,000 runs: 40 KiB of footer for each row group of 8192 rows, at
/// most 65,536 different times and amplitudes of a point, and the data in flight: two chunks of
/// records of up to 1 KiB and a row group of each table, which a short study may not reach
/// (measured: 31 to 35 MiB for 10,000 runs, 36 to 45 MiB for 200,000, and no more for 1,000,000).
/// Storing anything per run would take far more: the records alone take 70 MiB for 90,000 runs.
const ALLOWED_KIB: u64 = 24 * 1024;

#[test]
fn a_study_of_100_000_runs_takes_the_memory_of_one_of_10_000() {
    let small = stopped_peak_kib(2, 5000);
    let (many_points, one_point) = (stopped_peak_kib(20, 5000), stopped_peak_kib(1, 100_000));
    println!("10,000 runs: {small} KiB; 100,000: {many_points} KiB, at one point {one_point} KiB");
    assert!(small > 1024 && many_points.max(one_point) < small + ALLOWED_KIB);
}

#[test]
fn more_times_to_rest_than_are_kept_apart_take_no_more() {
    let (small, large) = (rested_peak_kib(5000), rested_peak_kib(100_000));
    println!("times to rest: 5,000 runs: {small} KiB; 100,000: {large} KiB");
    assert!(small > 1024 && large < small + ALLOWED_KIB);
}
