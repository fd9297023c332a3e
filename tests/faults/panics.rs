//! Panics in selected runs: their rows say so, and a retry gives the correct rows.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use stickslip::classification::{Label, Outcome, simulate};
use stickslip::engine::{EngineOptions, Progress, Store, run_study_with};
use stickslip::model::Case;
use stickslip::study::Study;

use crate::cli::support::{Scratch, parse};
use crate::engine::in_memory::Kept;

fn run_in_directory(
    study: &Study,
    directory: &Path,
    retry_failed: bool,
    simulate: impl Fn(&Case) -> Outcome + Sync,
) -> Kept {
    let mut store = Store::open(directory, study).unwrap();
    let options = EngineOptions { threads: 2, chunk: 50, retry_failed, ..EngineOptions::default() };
    let mut kept = Kept::default();
    let stop = AtomicBool::new(false);
    let progress = Progress::new(study.run_count(), true);
    run_study_with(study, options, simulate, &stop, &progress, Some(&mut store), &mut kept)
        .unwrap();
    kept
}

#[test]
fn panics_are_rows_that_can_be_tried_again() {
    let scratch = Scratch::new();
    let study = parse(super::study().replace("samples: 3200", "samples: 200"));
    let whole = run_in_directory(&study, &scratch.path("whole"), false, simulate);
    let out = scratch.path("out");
    let bad = |case: &Case| case.start.0[0] > 0.02;
    let first = run_in_directory(&study, &out, false, |case| {
        assert!(!bad(case), "injected");
        simulate(case)
    });
    let mut panics = 0;
    for (run, right) in first.runs.iter().zip(&whole.runs) {
        assert_eq!(run.planned, right.planned);
        let failed = run.outcome.label() == Label::Failed;
        assert_eq!(failed, bad(run.planned.case.as_ref().unwrap()));
        panics += u32::from(failed);
        assert!(failed || run == right);
    }
    assert!((50..200).contains(&panics), "{panics}");
    // Runs that panicked are finished: nothing is computed again without a request.
    let again = run_in_directory(&study, &out, false, |_| unreachable!("all runs are finished"));
    assert_eq!(again.runs, first.runs);
    // A retry computes only them, from the same start states and parameters.
    let retried = run_in_directory(&study, &out, true, |case| {
        assert!(bad(case), "a run that had not failed");
        simulate(case)
    });
    assert_eq!(retried.runs, whole.runs);
    assert_eq!(retried.points, whole.points);
    // The better outcome is stored.
    let last = run_in_directory(&study, &out, true, |_| unreachable!("no run has failed any more"));
    assert_eq!(last.runs, whole.runs);
}
