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
        let place = |moving: f64| ((1.0 - moving) / greatest * most_steps as f64).ceil();
        let next = curve.steps.get(index + 1);
        let kept = curve.steps.len() <= most_steps
            || next.is_none_or(|next| place(next.moving) > place(step.moving));
        if kept {
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
    let mut left = stops.iter().map(|(_, runs)| runs).sum();
    if let Some(row) = rows.last_mut() {
        row.censored -= left;
    }
    for (end_time_s, censored) in stops {
        let (time_s, at_risk) = (end_time_s.max(last.time_s), left);
        rows.push(RestStep { time_s, at_risk, came_to_rest: 0, censored, ..last });
        left -= censored;
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

#[cfg(test)]
mod tests {
    use super::{RestStep, rest_curve};
    use crate::analysis::{SurvivalCurve, ValueCounts};

    fn rows(rests: &[f64], stopped: &[f64]) -> (SurvivalCurve, Vec<RestStep>) {
        let mut times = ValueCounts::default();
        rests.iter().for_each(|time| times.add(*time, 0));
        stopped.iter().for_each(|time| times.add(*time, 1));
        let curve = SurvivalCurve::new(times.groups());
        let rows = rest_curve(&curve, [16.5; 2]);
        adds_up(&rows, rests.len() + stopped.len());
        (curve, rows)
    }

    /// Returns time, at risk, come to rest and censored for runs continued from 16.5 s to 66 s.
    fn extended(rests: &[f64], stopped: &[f64]) -> Vec<(f64, u64, u64, u64)> {
        let (curve, _) = rows(rests, stopped);
        let rows = rest_curve(&curve, [16.5, 66.0]);
        adds_up(&rows, rests.len() + stopped.len());
        rows.iter().map(|row| (row.time_s, row.at_risk, row.came_to_rest, row.censored)).collect()
    }

    fn adds_up(rows: &[RestStep], runs: usize) {
        let mut left = runs as u64;
        for row in rows {
            assert_eq!(row.at_risk, left, "{row:?}");
            left -= row.came_to_rest + row.censored;
            assert!(row.interval.0 <= row.probability && row.probability <= row.interval.1);
        }
        assert_eq!(left, 0);
    }

    #[test]
    fn each_rest_time_has_a_row_and_the_remaining_runs_one_at_the_end() {
        let (_, rows) = rows(&[2.0, 1.0, 2.0], &[0.5, 1.5, 16.5, f64::INFINITY]);
        let found: Vec<(f64, u64, u64, u64)> = rows
            .iter()
            .map(|row| (row.time_s, row.at_risk, row.came_to_rest, row.censored))
            .collect();
        assert_eq!(found, [(0.0, 7, 0, 1), (1.0, 6, 1, 1), (2.0, 4, 2, 0), (16.5, 2, 0, 2)]);
        assert!((rows[1].probability - 1.0 / 6.0).abs() < 1e-15);
        assert!((rows[2].probability - 7.0 / 12.0).abs() < 1e-15);
        assert_eq!(rows[3].probability, rows[2].probability);
        assert_eq!(rows[3].interval, rows[2].interval);
    }

    /// Runs that are not continued are censored at their own end time, whether the last rest is
    /// before or after it, and the probability is the Kaplan-Meier product over the runs at risk.
    #[test]
    fn runs_are_censored_at_their_own_end_time() {
        let (early, late, never) = (16.5 * (1.0 - 1e-15), 66.0 * (1.0 + 1e-15), f64::INFINITY);
        let found = extended(&[2.0], &[early, early, late, never]);
        let expected = [(0.0, 5, 0, 0), (2.0, 5, 1, 0), (16.5, 4, 0, 2), (66.0, 2, 0, 2)];
        assert_eq!(found, expected);
        let found = extended(&[2.0, 20.0], &[early, early, late]);
        let expected = [(0.0, 5, 0, 0), (2.0, 5, 1, 2), (20.0, 2, 1, 0), (66.0, 1, 0, 1)];
        assert_eq!(found, expected);
        let (curve, _) = rows(&[2.0, 20.0], &[early, early, late]);
        assert!((1.0 - curve.steps[1].moving - (1.0 - 0.8 * 0.5)).abs() < 1e-15);
        assert_eq!(extended(&[], &[early]), [(0.0, 1, 0, 0), (16.5, 1, 0, 1)]);
        assert_eq!(extended(&[], &[late]), [(0.0, 1, 0, 0), (66.0, 1, 0, 1)]);
        assert_eq!(extended(&[20.0], &[]), [(0.0, 1, 0, 0), (20.0, 1, 1, 0)]);
        // A thinned curve has room for both rows.
        let rests: Vec<f64> = (1..=5000).map(|i| f64::from(i) / 1000.0).collect();
        let found = extended(&rests, &[early, late]);
        assert_eq!(found[found.len() - 2..], [(16.5, 2, 0, 1), (66.0, 1, 0, 1)]);
        assert!(found.len() <= 1000 && found.len() > 900, "{}", found.len());
    }

    #[test]
    fn curves_with_rests_only_stops_only_and_no_runs() {
        let (_, all) = rows(&[0.0, 3.0], &[]);
        assert_eq!(all.len(), 2);
        assert_eq!((all[0].time_s, all[0].probability, all[0].came_to_rest), (0.0, 0.5, 1));
        assert_eq!((all[1].probability, all[1].interval.1), (1.0, 1.0));
        let (_, none) = rows(&[], &[16.5; 10]);
        assert_eq!(none.len(), 2);
        for row in &none {
            assert_eq!((row.probability, row.interval.0), (0.0, 0.0));
            assert!((row.interval.1 - (1.0 - 0.025_f64.powf(0.1))).abs() < 1e-12);
        }
        assert!(rows(&[], &[]).1.is_empty());
    }

    /// A thinned curve consists of rows of the full one, at distances of at most one step of
    /// probability.
    #[test]
    fn long_curves_are_thinned_without_changing_their_values() {
        for count in [998, 999, 1500, 20_000] {
            let rests: Vec<f64> = (1..=count).map(|i| f64::from(i).sqrt() / 10.0).collect();
            let stopped: Vec<f64> = (1..=count / 3).map(|i| f64::from(i).cbrt()).collect();
            let (curve, thinned) = rows(&rests, &stopped);
            assert!(thinned.len() <= 1000, "{count}: {}", thinned.len());
            assert!(thinned.len() > 490);
            let greatest = 1.0 - curve.steps.last().unwrap().moving;
            for pair in thinned.windows(2) {
                assert!(pair[1].probability - pair[0].probability < 2.01 * greatest / 998.0);
            }
            for row in thinned.iter().filter(|row| row.came_to_rest > 0) {
                let whole = curve.steps.iter().find(|step| step.time_s == row.time_s).unwrap();
                assert_eq!(row.probability, 1.0 - whole.moving);
                assert_eq!(row.interval, (1.0 - whole.interval.1, 1.0 - whole.interval.0));
            }
        }
    }
}
