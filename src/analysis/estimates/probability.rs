//! Probabilities of rest by a time, and of an amplitude above a limit, and the median time to rest.
//!
//! The results of failed runs are unknown: the lower end of the interval of a probability counts all of them as failures,
//! the upper end as successes, as in `points.parquet`; the value counts them as failures. The standard error is half of the
//! interval of the other runs, divided by the normal quantile 1.96: unlike `√(p (1 - p) / n)` it is not zero if all
//! runs have the same result.

use super::estimate::{Estimate, RunResult, Sample};
use super::sample_quantile::{CumulativeFraction, standard_error};
use crate::analysis::{
    StratifiedCells, SurvivalCurve, SurvivalStep, ValueCounts, Z_95, rest_or_stop_time, wilson,
    wilson_with_failures,
};
use crate::classification::Label;

/// How much earlier than a time a run may have been stopped and counts as observed until then, over the time: the time
/// observed in a stage is a difference, and has a rounding error.
const ROUNDING: f64 = 1e-9;

const NO_RUN: &str = "all runs failed";

/// Estimates the probability that a run's amplitude is above a limit. A run without an amplitude counts as failed.
pub fn above(sample: &Sample, limit: f64) -> Estimate {
    fraction(sample, |run| (!run.failed()).then_some(run.amplitude? > limit))
}

/// Estimates the probability of rest by a time, s. Runs on a limit cycle never rest. If a moving run was stopped
/// before that time, returns the Kaplan-Meier estimate.
pub fn at_rest_by(sample: &Sample, time_s: f64) -> Estimate {
    let censored = |run: &RunResult| {
        let open = matches!(run.label, Label::Undecided | Label::Irregular);
        open && run.end_time_s.is_some_and(|end| ends_before(end, time_s))
    };
    if sample.runs.iter().any(censored) {
        return kaplan_meier(sample, time_s);
    }
    fraction(sample, |run| {
        (!run.failed()).then_some(run.time_to_rest_s.is_some_and(|time| time <= time_s))
    })
}

/// Returns whether a run that was stopped at `end_s` was stopped before a time.
fn ends_before(end_s: f64, time_s: f64) -> bool {
    end_s < (1.0 - ROUNDING) * time_s
}

/// Estimates the fraction of runs that succeed; unknown results count as failures.
fn fraction(sample: &Sample, succeeds: impl Fn(&RunResult) -> Option<bool>) -> Estimate {
    let mut cells = sample.cells.map(StratifiedCells::new).unwrap_or_default();
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
    let value = cells.fraction().unwrap_or(successes as f64 / all as f64);
    Estimate::known(value, (to - from) / (2.0 * Z_95), [low, high])
}

/// Returns the times at which runs came to rest or were stopped while moving, without failed runs.
pub(super) fn times(sample: &Sample) -> ValueCounts {
    let mut times = ValueCounts::default();
    for run in sample.runs.iter().filter(|run| !run.failed()) {
        if let Some((time, kind)) = rest_or_stop_time(run.label, run.time_to_rest_s, run.end_time_s)
        {
            times.add(time, kind);
        }
    }
    times
}

fn kaplan_meier(sample: &Sample, time_s: f64) -> Estimate {
    let times = times(sample);
    let curve = SurvivalCurve::new(times.groups());
    let (all, failures) = (sample.runs.len() as f64, sample.failed() as f64);
    // The curve ends at the last observed time.
    if times.groups().last().is_none_or(|(last, _)| ends_before(last, time_s)) {
        return Estimate::unknown("all moving runs were stopped before this time");
    }
    let step = curve.steps.iter().rfind(|step| step.time_s <= time_s);
    let (moving, (low, high)) =
        step.map_or((1.0, curve.interval_before()), |step| (step.moving, step.interval));
    let known = (all - failures) / all;
    let ends = [(1.0 - high) * known, (1.0 - low) * known + (1.0 - known)];
    Estimate::known((1.0 - moving) * known, (high - low) / (2.0 * Z_95), ends)
}

/// Estimates the time by which half of the runs have come to rest, s (Kaplan-Meier, with the interval of Brookmeyer
/// and Crowley, see [`SurvivalCurve`], and the bootstrap's standard error). Failed runs are excluded.
pub fn median_time_to_rest(sample: &Sample) -> Estimate {
    let curve = SurvivalCurve::new(times(sample).groups());
    if curve.steps.is_empty() {
        return Estimate::unknown("no run came to rest");
    }
    let [low, high] = curve.time_to_rest_interval(0.5);
    let Some(value) = curve.time_to_rest_quantile(0.5) else {
        return Estimate {
            low,
            high,
            ..Estimate::unknown("less than half of the runs come to rest")
        };
    };
    let error = standard_error(curve.steps.iter().map(cumulative), 0.5);
    let too_few = "too few runs at rest for both ends of the interval";
    Estimate::with_interval(value, error, [low, high], too_few)
}

/// Returns the fraction at rest after a step, and the number of independent runs for which the binomial variance equals
/// Greenwood's variance.
fn cumulative(step: &SurvivalStep) -> CumulativeFraction {
    let (moving, rest) = (step.moving, 1.0 - step.moving);
    // Without moving runs the number does not matter.
    let effective = |error: f64| moving * rest / (error * error);
    let runs = step.standard_error().map_or(step.at_risk as f64, effective);
    CumulativeFraction { value: step.time_s, proportion: rest, runs }
}
