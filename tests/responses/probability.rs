//! Probabilities of rest and of large amplitudes, with failed and censored runs.

use stickslip::analysis::{RunResult, Sample, above, at_rest_by};
use stickslip::analysis::{Z_95, wilson};
use stickslip::classification::Label;

fn run(label: Label, time_to_rest_s: Option<f64>, end: f64) -> RunResult {
    let amplitude = (label != Label::Failed).then_some(end);
    RunResult { cell: 0, label, amplitude, time_to_rest_s, end_time_s: Some(end) }
}

fn sample(runs: Vec<RunResult>) -> Sample {
    Sample { cells: None, runs }
}

#[test]
fn fractions_by_hand() {
    let mut runs = vec![run(Label::Equilibrium, Some(1.0), 1.0); 6];
    runs.extend(vec![run(Label::Equilibrium, Some(3.0), 4.0); 2]);
    runs.extend(vec![run(Label::Undecided, None, 9.0); 1]);
    runs.extend(vec![run(Label::LimitCycle, None, 1.5); 1]);
    let found = at_rest_by(&sample(runs.clone()), 2.0);
    assert_eq!(found.value, Some(0.6));
    let (low, high) = wilson(6, 10, Z_95);
    assert_eq!((found.low, found.high), (Some(low), Some(high)));
    assert_eq!(at_rest_by(&sample(runs.clone()), 9.0).value, Some(0.8));
    assert_eq!(above(&sample(runs.clone()), 3.9).value, Some(0.3));
    // Two failed runs: 6 of 12 to 8 of 12.
    runs.extend(vec![run(Label::Failed, None, 0.0); 2]);
    let with = at_rest_by(&sample(runs), 2.0);
    assert_eq!(with.value, Some(0.5));
    let ends = (wilson(6, 12, Z_95).0, wilson(8, 12, Z_95).1);
    assert_eq!((with.low, with.high), (Some(ends.0), Some(ends.1)));
    let failed = at_rest_by(&sample(vec![run(Label::Failed, None, 0.0); 3]), 2.0);
    assert_eq!((failed.value, failed.reason.as_deref()), (None, Some("all runs failed")));
    // Equal results are not certainty.
    let equal = at_rest_by(&sample(vec![run(Label::Equilibrium, Some(1.0), 1.0); 10]), 2.0);
    assert_eq!((equal.value, equal.high), (Some(1.0), Some(1.0)));
    assert!(equal.low < Some(0.75) && equal.standard_error > Some(0.05));
}

/// The 6-MP group (Blood 21 (1963) 699): 0.8067 still in remission at 9 weeks, Greenwood's interval 0.5631 to 0.9228;
/// unknown after the last observation.
#[test]
fn stopped_runs_are_censored() {
    let mut runs: Vec<RunResult> = [6.0, 6.0, 6.0, 7.0, 10.0, 13.0, 16.0, 22.0, 23.0]
        .map(|time| run(Label::Equilibrium, Some(time), time))
        .to_vec();
    let stopped = [6.0, 9.0, 10.0, 11.0, 17.0, 19.0, 20.0, 25.0, 32.0, 32.0, 34.0, 35.0];
    runs.extend(stopped.map(|time| run(Label::Undecided, None, time)));
    let near = |found: Option<f64>, printed: f64| {
        assert!((found.unwrap() - printed).abs() < 5.01e-5, "{found:?} {printed}");
    };
    let found = at_rest_by(&sample(runs.clone()), 9.0);
    near(found.value, 1.0 - 0.8067);
    near(found.low, 1.0 - 0.9228);
    near(found.high, 1.0 - 0.5631);
    assert!(at_rest_by(&sample(runs.clone()), 36.0).reason.is_some());
    // The last runs were stopped at 35 s; a rounding error of that time does not matter.
    assert!(at_rest_by(&sample(runs.clone()), 35.0 * (1.0 + 2.0 * f64::EPSILON)).value.is_some());
    // Seven failed of 28: three quarters of the probability are known.
    runs.extend(vec![run(Label::Failed, None, 0.0); 7]);
    let with = at_rest_by(&sample(runs), 9.0);
    near(with.value, 0.75 * (1.0 - 0.8067));
    near(with.high, 0.75 * (1.0 - 0.5631) + 0.25);
}

/// A stage of 5 s that begins at 11.49216 s ends at 16.49216 s, whose difference is less than 5 s by rounding.
#[test]
fn runs_are_observed_until_the_end_of_a_stage() {
    let observed = (11.49216 + 5.0) - 11.49216;
    assert!(observed < 5.0);
    let mut runs = vec![run(Label::Equilibrium, Some(4.0), 4.0); 3];
    runs.extend(vec![run(Label::Undecided, None, observed); 1]);
    assert_eq!(at_rest_by(&sample(runs), 5.0).value, Some(0.75));
}
