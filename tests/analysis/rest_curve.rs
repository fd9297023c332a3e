//! Rows of the probability of rest over time.

use stickslip::analysis::{RestStep, SurvivalCurve, ValueCounts, rest_curve};

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
    let found: Vec<(f64, u64, u64, u64)> =
        rows.iter().map(|row| (row.time_s, row.at_risk, row.came_to_rest, row.censored)).collect();
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
