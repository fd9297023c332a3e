//! Probabilities of rest by a time, and of an amplitude above a limit.
//!
//! The results of failed runs are unknown: the lower end of the interval counts all of them as failures, the upper
//! end as successes, as in `points.parquet`; the value counts them as failures. The standard error is half of the
//! interval of the other runs, divided by the normal quantile 1.96: unlike `√(p (1 - p) / n)` it is not zero if all
//! runs have the same result.

use super::estimate::{Estimate, Sample, Seen};
use crate::analysis::{Cells, SurvivalCurve, ValueCounts, Z_95, wilson, wilson_with_failures};
use crate::classification::Label;

const NO_RUN: &str = "all runs failed";

/// Estimates the probability that a run's amplitude is above a limit. A run without an amplitude counts as failed.
pub fn above(sample: &Sample, limit: f64) -> Estimate {
    fraction(sample, |run| (!run.failed()).then_some(run.amplitude? > limit))
}

/// Estimates the probability of rest by a time, s. Runs on a limit cycle never rest. If a moving run was stopped
/// before that time, returns the Kaplan-Meier estimate.
pub fn at_rest_by(sample: &Sample, time_s: f64) -> Estimate {
    let censored = |run: &Seen| {
        let open = matches!(run.label, Label::Undecided | Label::Irregular);
        open && run.end_time_s.is_some_and(|end| end < time_s)
    };
    if sample.runs.iter().any(censored) {
        return kaplan_meier(sample, time_s);
    }
    fraction(sample, |run| {
        (!run.failed()).then_some(run.time_to_rest_s.is_some_and(|time| time <= time_s))
    })
}

/// Estimates the fraction of runs that succeed; unknown results count as failures.
fn fraction(sample: &Sample, succeeds: impl Fn(&Seen) -> Option<bool>) -> Estimate {
    let mut cells = sample.cells.map(Cells::new).unwrap_or_default();
    let mut known_cells = cells.clone();
    let (mut successes, mut failures) = (0, 0);
    for run in &sample.runs {
        let known = succeeds(run);
        let (success, failure) = (known == Some(true), known.is_none());
        successes += u64::from(success);
        failures += u64::from(failure);
        cells.add(run.cell, success, failure);
        if !failure {
            known_cells.add(run.cell, success, false);
        }
    }
    let all = sample.runs.len() as u64;
    if failures == all {
        return Estimate::unknown(NO_RUN);
    }
    let (low, high) =
        cells.interval().unwrap_or_else(|| wilson_with_failures(successes, failures, all, Z_95));
    let (from, to) =
        known_cells.interval().unwrap_or_else(|| wilson(successes, all - failures, Z_95));
    Estimate {
        value: Some(cells.fraction().unwrap_or(successes as f64 / all as f64)),
        standard_error: Some((to - from) / (2.0 * Z_95)),
        low: Some(low),
        high: Some(high),
        reason: None,
    }
}

/// Returns the times at which runs came to rest (kind 0) or were stopped while moving (kind 1).
pub(super) fn times(sample: &Sample) -> ValueCounts {
    let mut times = ValueCounts::default();
    for run in sample.runs.iter().filter(|run| !run.failed()) {
        match (run.time_to_rest_s, run.end_time_s) {
            (Some(time), _) => times.add(time, 0),
            (None, _) if run.label == Label::LimitCycle => times.add(f64::INFINITY, 1),
            (None, end) => end.into_iter().for_each(|end| times.add(end, 1)),
        }
    }
    times
}

fn kaplan_meier(sample: &Sample, time_s: f64) -> Estimate {
    let times = times(sample);
    let curve = SurvivalCurve::new(times.groups());
    let (all, failures) = (sample.runs.len() as f64, sample.failed() as f64);
    // The curve ends at the last observed time.
    if times.groups().last().is_none_or(|(last, _)| last < time_s) {
        return Estimate::unknown("all moving runs were stopped before this time");
    }
    let step = curve.steps.iter().rfind(|step| step.time_s <= time_s);
    let (moving, (low, high)) =
        step.map_or((1.0, curve.interval_before()), |step| (step.moving, step.interval));
    let known = (all - failures) / all;
    Estimate {
        value: Some((1.0 - moving) * known),
        standard_error: Some((high - low) / (2.0 * Z_95)),
        low: Some((1.0 - high) * known),
        high: Some((1.0 - low) * known + (1.0 - known)),
        reason: None,
    }
}

#[cfg(test)]
mod tests {
    use super::{above, at_rest_by};
    use crate::analysis::{Z_95, wilson};
    use crate::classification::Label;
    use crate::responses::{Sample, Seen};

    fn run(label: Label, time_to_rest_s: Option<f64>, end: f64) -> Seen {
        let amplitude = (label != Label::Failed).then_some(end);
        Seen { cell: 0, label, amplitude, time_to_rest_s, end_time_s: Some(end) }
    }

    fn sample(runs: Vec<Seen>) -> Sample {
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
        let alike = at_rest_by(&sample(vec![run(Label::Equilibrium, Some(1.0), 1.0); 10]), 2.0);
        assert_eq!((alike.value, alike.high), (Some(1.0), Some(1.0)));
        assert!(alike.low < Some(0.75) && alike.standard_error > Some(0.05));
    }

    /// The 6-MP group (Blood 21 (1963) 699): 0.8067 still in remission at 9 weeks, Greenwood's interval 0.5631 to 0.9228;
    /// unknown after the last observation.
    #[test]
    fn stopped_runs_are_censored() {
        let mut runs: Vec<Seen> = [6.0, 6.0, 6.0, 7.0, 10.0, 13.0, 16.0, 22.0, 23.0]
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
        // Seven failed of 28: three quarters of the probability are known.
        runs.extend(vec![run(Label::Failed, None, 0.0); 7]);
        let with = at_rest_by(&sample(runs), 9.0);
        near(with.value, 0.75 * (1.0 - 0.8067));
        near(with.high, 0.75 * (1.0 - 0.5631) + 0.25);
    }
}
