//! The probability of being at rest over time, as at most a thousand table rows.

use super::survival::SurvivalCurve;

/// One row: the state at one time.
///
/// `at_risk - came_to_rest - censored` is `at_risk` of the next row, and 0 in the last row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestStep {
    /// The time, s.
    pub time_s: f64,
    /// Runs at risk (moving and observed) just before; in a thinned curve, before the first run
    /// that came to rest after the previous row.
    pub at_risk: u64,
    /// Runs that came to rest since the previous row, up to and including this time.
    pub came_to_rest: u64,
    /// Runs stopped while moving, from this time (in a thinned curve, from the first rest after the
    /// previous row) until the next row.
    pub censored: u64,
    /// Probability of being at rest by this time.
    pub probability: f64,
    /// 95 % interval of the probability.
    pub interval: (f64, f64),
}

/// Largest number of rows at which runs come to rest.
const MOST_STEPS: usize = 998;

/// Returns the rows of a curve; no rows if there are no runs.
///
/// The first row is at time 0, and one row follows for each time at which runs came to rest. Runs
/// still moving after the last of these, undecided or on a limit cycle, are censored in a last row
/// at the end time. If runs are continued to a later end time, the second of `end_times_s`, the
/// runs that are not continued have a row before it.
///
/// Above 998 times (997 with that additional row), only the times at which the probability passes
/// equal steps of 1/998 of its greatest value get a row; the values in these rows are unchanged.
pub fn rest_curve(curve: &SurvivalCurve, end_times_s: [f64; 2]) -> Vec<RestStep> {
    let mut rows = Vec::new();
    if curve.runs == 0 {
        return rows;
    }
    let stops = last_stops(curve, end_times_s);
    let most_steps = MOST_STEPS - stops.len().saturating_sub(1);
    let at_rest = |(low, high): (f64, f64)| (1.0 - high, 1.0 - low);
    let mut last = RestStep {
        time_s: 0.0,
        at_risk: curve.runs,
        came_to_rest: 0,
        censored: curve.stopped_before,
        probability: 0.0,
        interval: at_rest(curve.interval_before()),
    };
    if curve.steps.first().is_none_or(|step| step.time_s > 0.0) {
        rows.push(last);
    }
    let greatest = curve.steps.last().map_or(1.0, |step| 1.0 - step.moving);
    let (mut came_to_rest, mut censored, mut at_risk) = (0, 0, None);
    for (index, step) in curve.steps.iter().enumerate() {
        at_risk.get_or_insert(step.at_risk);
        came_to_rest += step.rests;
        censored += step.stopped;
        let level = |moving: f64| ((1.0 - moving) / greatest * most_steps as f64).ceil();
        let next = curve.steps.get(index + 1);
        let has_row = curve.steps.len() <= most_steps
            || next.is_none_or(|next| level(next.moving) > level(step.moving));
        if has_row {
            last = RestStep {
                time_s: step.time_s,
                at_risk: at_risk.take().unwrap_or(step.at_risk),
                came_to_rest: std::mem::take(&mut came_to_rest),
                censored: std::mem::take(&mut censored),
                probability: 1.0 - step.moving,
                interval: at_rest(step.interval),
            };
            rows.push(last);
        }
    }
    // All remaining runs are censored at the end.
    let mut remaining = stops.iter().map(|(_, runs)| runs).sum();
    if let Some(row) = rows.last_mut() {
        row.censored -= remaining;
    }
    for (end_time_s, censored) in stops {
        let (time_s, at_risk) = (end_time_s.max(last.time_s), remaining);
        rows.push(RestStep { time_s, at_risk, came_to_rest: 0, censored, ..last });
        remaining -= censored;
    }
    rows
}

/// Returns the runs stopped after the last rest, each with the end time at which it was stopped.
fn last_stops(curve: &SurvivalCurve, [first, later]: [f64; 2]) -> Vec<(f64, u64)> {
    // The recorded times may differ from the end times by rounding, but no run is stopped in
    // between.
    let between = if first < later { 0.5 * (first + later) } else { 0.0 };
    let mut stops = [(first, 0), (later, 0)];
    for (time, runs) in &curve.stopped_after {
        stops[usize::from(*time >= between)].1 += runs;
    }
    stops.into_iter().filter(|(_, runs)| *runs > 0).collect()
}
