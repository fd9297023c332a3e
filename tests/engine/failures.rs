//! A failed run is a row and does not affect other runs.

use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::json;
use stickslip::analysis::{Z_95, wilson};
use stickslip::classification::{Evidence, Label, Outcome, simulate};
use stickslip::study::Study;

use super::in_memory::{Kept, run_in_memory};
use crate::cli::support::{AT_ONCE, Scratch, counts, numbers, parse, study_text, words};

fn study() -> Study {
    let sweep = "sweep: [{grid: {speed_rad_s: [-160.0, -200.0]}}]\n";
    parse(study_text("a", "{monte_carlo: {samples: 20}}", AT_ONCE, sweep))
}

#[test]
fn a_panic_is_a_row() {
    let study = study();
    let go = AtomicBool::new(false);
    let mut sound = Kept::default();
    run_in_memory(&study, &mut sound, &go, simulate).unwrap();
    let mut kept = Kept::default();
    // Half of the start states have their ring to the left.
    let totals = run_in_memory(&study, &mut kept, &go, |case| {
        assert!(case.start.0[0] > 0.0, "the ring is at {}", case.start.0[0]);
        simulate(case)
    })
    .unwrap();
    assert!(!totals.interrupted());
    // Runs come in order, and points when they are full.
    assert!(kept.runs.iter().map(|record| record.planned.run_id).eq(0..40));
    let points = kept.points.iter().map(|point| (point.point_id, point.summary.counts.total()));
    assert_eq!(points.collect::<Vec<(u64, u64)>>(), [(0, 20), (1, 20)]);
    let mut panics = 0;
    for (record, sound) in kept.runs.iter().zip(&sound.runs) {
        assert_eq!(record.planned, sound.planned);
        if record.planned.start.0[0] > 0.0 {
            assert_eq!(record.outcome, sound.outcome);
        } else {
            panics += 1;
            let expected = format!(
                "the program failed in this run: the ring is at {}",
                record.planned.start.0[0]
            );
            assert_eq!(record.outcome, Outcome::of(Evidence::Panic(expected)));
            assert_eq!(record.outcome.label().name(), "failed");
        }
    }
    assert!(panics > 10 && panics < 30, "{panics}");
    assert_eq!(totals.counts.of(Label::Failed), panics);
    assert_eq!(totals.counts.total(), 40);
    for point in &kept.points {
        let failed = point.summary.counts.of(Label::Failed);
        assert!(failed > 0);
        let interval = point.summary.interval;
        assert_eq!((interval.low, interval.high), (0.0, wilson(failed, 20, Z_95).1));
    }
}

#[test]
fn stop_finishes_what_runs_and_begins_nothing() {
    let stop = AtomicBool::new(false);
    let mut kept = Kept::default();
    let totals = run_in_memory(&study(), &mut kept, &stop, |case| {
        stop.store(true, Ordering::Relaxed);
        simulate(case)
    })
    .unwrap();
    assert!(totals.interrupted());
    // At most one for each of the three threads.
    assert!((1..=3).contains(&kept.runs.len()), "{}", kept.runs.len());
    assert_eq!(totals.counts.total(), kept.runs.len() as u64);
    assert_eq!(kept.points.len(), 1);
}

#[test]
fn a_sink_that_refuses_stops_the_farm() {
    let mut kept = Kept { room: Some(10), ..Kept::default() };
    let error = run_in_memory(&study(), &mut kept, &AtomicBool::new(false), simulate).unwrap_err();
    assert_eq!(error.to_string(), "cannot write runs: the disk is full");
    assert_eq!(kept.runs.len(), 10);
}

#[test]
fn drawn_parameters_without_sense_are_rows() {
    let rest = "uncertain: {ball_mass_kg: {normal: {mean: 1.4e-4, std_dev: 1.4e-4}}}\n";
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 100}}", 5.0, rest));
    let ended = scratch.ended("run a.yaml --out out", 3);
    let runs = scratch.table("out", "runs");
    let masses = numbers(&runs, "ball_mass_kg");
    let columns = ["label", "evidence", "error"].map(|name| words(&runs, name));
    let mut failed = 0;
    for (index, mass) in masses.iter().enumerate() {
        let [label, evidence, error] =
            [0, 1, 2].map(|column: usize| columns[column][index].as_deref());
        if mass.unwrap() <= 0.0 {
            failed += 1;
            assert_eq!((label, evidence), (Some("failed"), Some("invalid_parameters")));
            assert!(error.is_some_and(|error| error.contains("mass")), "{error:?}");
            assert_eq!(numbers(&runs, "beta_1_rad")[index], None);
        } else {
            assert_ne!(label, Some("failed"));
            assert_eq!(error, None);
            assert!(numbers(&runs, "beta_1_rad")[index].is_some());
        }
    }
    assert!((5..40).contains(&failed), "{failed}");
    let line =
        format!("{failed} of 100 runs failed: {failed} invalid_parameters (see the columns ");
    assert!(ended.err.contains(&line), "{}", ended.err);
    assert_eq!(scratch.manifest("out")["failures"], json!({"invalid_parameters": failed}));
    let points = scratch.table("out", "points");
    assert_eq!(counts(&points, "failed_runs"), [failed]);
    let at_rest = counts(&points, "equilibrium_runs")[0];
    let expected = (wilson(at_rest, 100, Z_95).0, wilson(at_rest + failed, 100, Z_95).1);
    assert_eq!(numbers(&points, "ci_low"), [Some(expected.0)]);
    assert_eq!(numbers(&points, "ci_high"), [Some(expected.1)]);
}
