//! Summaries of points with runs of all labels.

use stickslip::analysis::{Observed, PointAccumulator};
use stickslip::classification::{ClosedOrbit, Evidence, Outcome, Rest};

fn add(point: &mut PointAccumulator, outcome: &Outcome) {
    point.add(Observed { cell: 0, case: None, outcome, audit: None });
}

fn rest_since(time_s: f64) -> Evidence {
    Evidence::RestCertified(Rest { since_s: Some(time_s), friction_margin: None })
}

#[test]
fn cycles_never_rest_and_failures_are_not_counted() {
    let run = |evidence| Outcome { end_time_s: Some(16.5), ..Outcome::of(evidence) };
    let mut point = PointAccumulator::default();
    for time in [1.0, 2.0, 3.0] {
        add(&mut point, &run(rest_since(time)));
    }
    add(&mut point, &run(Evidence::ClosedOrbit(ClosedOrbit::default())));
    add(&mut point, &run(Evidence::Panic(String::new())));
    // The cycle was shown at 16.5 s and stays at risk until the end, 20 s.
    let rows = point.detail([20.0; 2]).rest;
    let counts: Vec<(f64, u64, u64, u64)> =
        rows.iter().map(|row| (row.time_s, row.at_risk, row.came_to_rest, row.censored)).collect();
    let expected = [(0.0, 4, 0, 0), (1.0, 4, 1, 0), (2.0, 3, 1, 0), (3.0, 2, 1, 0)];
    assert_eq!(counts[..4], expected);
    assert_eq!(counts[4..], [(20.0, 1, 0, 1)]);
    assert_eq!(rows[4].probability, 0.75);
    let summary = point.summary();
    assert_eq!(summary.equilibrium_fraction, 0.6);
    assert_eq!(summary.time_to_rest_s, [Some(1.0), Some(2.0), Some(3.0), None]);
    assert_eq!(summary.median_interval_s, [Some(1.0), None]);
    assert_eq!(summary.escape, None);
}

/// If runs come to rest at a rate of 0.5 while others find limit cycles at the same rate, the
/// escape rate is 0.5, whatever the fraction that never comes to rest.
#[test]
fn runs_that_find_cycles_leave_the_exposure() {
    let mut point = PointAccumulator::default();
    let runs = 2000;
    for i in 0..runs {
        // Ascending times at a total rate of 1; every second run ends on a cycle.
        let time = -(1.0 - (f64::from(i) + 0.5) / f64::from(runs)).ln();
        let evidence = match i % 2 {
            0 => rest_since(time),
            _ => Evidence::ClosedOrbit(ClosedOrbit::default()),
        };
        add(&mut point, &Outcome { end_time_s: Some(time), ..Outcome::of(evidence) });
    }
    let escape = point.summary().escape.expect("an exponential tail");
    assert_eq!(escape.from_s, 0.0);
    assert!((escape.rate_per_s - 0.5).abs() < 1e-3, "{escape:?}");
}
