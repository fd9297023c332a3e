//! Ctrl-C and SIGTERM: finished runs are stored, and nothing else is claimed.

#![cfg(target_os = "linux")]

use std::fs;
use std::process::{Child, Command};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use arrow::array::{RecordBatch, UInt64Array};
use arrow::compute::take_record_batch;
use rayon::prelude::*;
use stickslip::classification::simulate;
use stickslip::engine::compute;
use stickslip::table::column::batch;
use stickslip::table::{RunRecord, run_columns};

use super::support::{Ended, Scratch, assert_has, counts, json_lines, parse, study_text};

/// Hours of work, in runs of milliseconds.
fn long() -> String {
    let rest = "sweep: [{grid: {speed_rad_s: [-160.0, -216.0]}}]\n";
    study_text("long", "{monte_carlo: {samples: 2000000}}", 2.0, rest)
}

pub fn wait_until(what: &str, holds: impl Fn() -> bool) {
    let started = Instant::now();
    while !holds() {
        assert!(started.elapsed() < Duration::from_secs(60), "waited in vain until {what}");
        thread::yield_now();
    }
}

/// Returns a line of /proc/PID/status.
fn status(child: &Child, key: &str) -> Option<String> {
    let text = fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    Some(line.trim_start_matches(':').trim().to_owned())
}

/// Returns whether a child has a handler for a signal.
pub fn catches(child: &Child, signal: u32) -> bool {
    let mask = status(child, "SigCgt").and_then(|mask| u64::from_str_radix(&mask, 16).ok());
    mask.is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
}

/// Returns the processor time of a child, in ticks of usually 10 ms.
pub fn ticks(child: &Child) -> u64 {
    let text = fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap_or_default();
    let after_name = text.rsplit(") ").next().unwrap_or_default();
    let field = |index: usize| after_name.split(' ').nth(index)?.parse::<u64>().ok();
    field(11).unwrap_or(0) + field(12).unwrap_or(0)
}

pub fn send(child: &Child, signal: &str) {
    let kill = format!("kill -{signal} {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
}

/// Returns the selected rows of a table.
fn rows(table: &RecordBatch, places: Vec<u64>) -> RecordBatch {
    take_record_batch(table, &UInt64Array::from(places)).unwrap()
}

#[test]
fn ctrl_c_and_termination_keep_what_is_finished() {
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        let scratch = Scratch::new();
        scratch.write("long.yaml", long());
        // About one chunk per round of workers: interruptions within a chunk and between chunks.
        let child = scratch
            .command("run long.yaml --out out --threads 2 --chunk 64")
            .spawn()
            .expect("starts");
        wait_until("the program catches signals", || catches(&child, number));
        wait_until("some runs are finished", || ticks(&child) >= 50);
        send(&child, signal);
        let ended = Ended::of(child.wait_with_output().expect("ends"));
        assert_eq!(ended.code, Some(130), "{}", ended.err);

        let table = scratch.table("out", "runs");
        let finished = table.num_rows() as u64;
        assert!(finished > 10, "{finished}");
        let message =
            format!("interrupted after {finished} of 4000000 runs; finished runs are saved");
        assert!(ended.err.contains(&message), "{}", ended.err);
        let manifest = scratch.manifest("out");
        assert_eq!(manifest["complete"], false);
        assert_eq!(
            (&manifest["runs_finished"], &manifest["runs_planned"]),
            (&finished.into(), &4_000_000.into())
        );
        assert_eq!(manifest["files"]["runs.parquet"]["rows"], finished);
        let points = scratch.table("out", "points");
        assert_eq!(counts(&points, "runs").iter().sum::<u64>(), finished);
        let at_rest = counts(&points, "equilibrium_runs").iter().sum::<u64>();
        assert_eq!(scratch.table("out", "equilibria").num_rows() as u64, at_rest);
        let names = scratch.names("out");
        assert!(!names.iter().any(|name| name.contains("partial")), "{names:?}");

        // The rows are those of the whole study.
        let ids = counts(&table, "run_id");
        assert!(ids.is_sorted_by(|a, b| a < b));
        let study = parse(long());
        let records: Vec<RunRecord> =
            ids.par_iter().map(|&run_id| compute(&study, run_id, simulate)).collect();
        let expected = batch(&run_columns(&study), &records).expect("columns");
        for place in 0..finished {
            let (found, expected) = (rows(&table, vec![place]), rows(&expected, vec![place]));
            let columns = found.columns().iter().zip(expected.columns());
            for ((found, expected), field) in columns.zip(table.schema().fields()) {
                let text = |array: &Arc<dyn arrow::array::Array>| {
                    arrow::util::display::array_value_to_string(array, 0).expect("a text")
                };
                assert_eq!(
                    text(found),
                    text(expected),
                    "run {}: {}",
                    ids[place as usize],
                    field.name()
                );
            }
        }

        // The same command continues: finished runs are available first.
        let again = scratch.ended("run long.yaml --out out --threads 2 --max-seconds 0", 130);
        let going_on =
            format!("out: continuing this study; up to {finished} of its runs are finished");
        assert_has(
            &again.err,
            &[&going_on, &format!("out of time (--max-seconds) after {finished} of 4000000 runs")],
        );
        let list =
            fs::read_to_string(scratch.chunks("out").join("manifest.jsonl")).expect("a list");
        let runs =
            json_lines(&list).into_iter().map(|line| line["runs"].as_u64().expect("a number"));
        assert_eq!(runs.sum::<u64>(), finished);
    }
}

/// For runs of minutes, the first signal waits a second, the second does not.
#[test]
fn the_second_signal_stops_at_once() {
    let scratch = Scratch::new();
    scratch.write("slow.yaml", study_text("slow", "{monte_carlo: {samples: 2}}", 1.0e5,
        "model: {kind: ball_balancer, parameters: {speed_rad_s: -191.6372, friction_coefficient: 1.0e-5}}\n"));
    let mut child = scratch.command("run slow.yaml --out out --threads 2").spawn().unwrap();
    wait_until("the program catches signals", || catches(&child, 2));
    send(&child, "INT");
    // The first signal has arrived when it is no longer pending; it must not end the program.
    wait_until("the first signal has arrived", || {
        status(&child, "ShdPnd").is_some_and(|mask| mask.bytes().all(|digit| digit == b'0'))
    });
    assert!(child.try_wait().unwrap().is_none());
    wait_until("the second signal has ended it", || {
        send(&child, "INT");
        fs::read_to_string(format!("/proc/{}/stat", child.id()))
            .is_ok_and(|stat| stat.contains(") Z "))
    });
    assert_eq!(child.wait().unwrap().code(), Some(130));
}
