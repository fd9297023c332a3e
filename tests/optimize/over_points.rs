//! The worst and the mean estimate over the points of a sweep.

use stickslip::analysis::{Estimate, LabelCounts};
use stickslip::optimize::Goal;
use stickslip::responses::Answer;
use stickslip::study::OverPoints::{self, Mean, Worst};
use stickslip::study::{Objective, Optimization, SensitivityFrom};

use crate::support::parse;

/// Returns the combination of the estimates of one response at the points of a sweep; with
/// `maximize` small values are worse.
fn combined(estimates: &[&Estimate], over_points: OverPoints, maximize: bool) -> Estimate {
    let speeds: Vec<String> =
        (0..estimates.len()).map(|point| format!("-{}", 200 + point)).collect();
    let text = format!(
        "schema: 1\nname: a\nseed: 1\nmodel: {{kind: ball_balancer}}\n\
         sweep: [{{grid: {{speed_rad_s: [{}]}}}}]\n\
         initial_conditions: {{design: {{monte_carlo: {{samples: 2}}}}}}\n",
        speeds.join(", ")
    );
    let study = parse(text);
    let optimization = Optimization {
        objectives: vec![Objective { response: 0, maximize }],
        limits: Vec::new(),
        over_points,
        start_designs: 1,
        designs: 1,
        finalists: 1,
        final_samples: 1,
        sensitivity_from: SensitivityFrom::Runs,
        sensitivity_samples: 2,
        compare_with: None,
    };
    let answer = |(point_id, estimate): (u64, &&Estimate)| Answer {
        design: 0,
        values: Vec::new(),
        point_id,
        swept: Vec::new(),
        estimates: vec![(*estimate).clone()],
        counts: LabelCounts::default(),
        discontinuous: None,
    };
    let answers: Vec<Answer> = (0..).zip(estimates).map(answer).collect();
    let [combined] = &Goal::new(&study, &optimization).estimates(&answers)[..] else {
        panic!("one objective is one quantity")
    };
    combined.clone()
}

fn estimate(value: f64, error: f64) -> Estimate {
    Estimate {
        value: Some(value),
        standard_error: Some(error),
        low: Some(value - 2.0 * error),
        high: Some(value + 2.0 * error),
        reason: None,
    }
}

#[test]
fn worst_and_mean() {
    let [a, b] = [estimate(1.0, 0.5), estimate(3.0, 0.25)];
    let worst = combined(&[&a, &b], Worst, false);
    assert_eq!((worst.value, worst.low, worst.high), (Some(3.0), Some(2.5), Some(3.5)));
    assert_eq!(worst.standard_error, Some(0.25));
    let least = combined(&[&a, &b], Worst, true);
    assert_eq!((least.value, least.low, least.high), (Some(1.0), Some(0.0), Some(2.0)));
    let mean = combined(&[&a, &b], Mean, false);
    assert_eq!((mean.value, mean.low, mean.high), (Some(2.0), Some(1.25), Some(2.75)));
    assert_eq!(mean.standard_error, Some(0.375));
}

#[test]
fn what_is_missing_at_one_point_is_missing() {
    let unknown = Estimate::unknown("all runs failed");
    let found = combined(&[&estimate(1.0, 0.1), &unknown], Worst, false);
    assert_eq!((found.value, found.reason.as_deref()), (None, Some("all runs failed")));
    let unbounded = Estimate { high: None, ..estimate(1.0, 0.1) };
    let found = combined(&[&estimate(3.0, 0.1), &unbounded], Worst, false);
    assert_eq!((found.value, found.high), (Some(3.0), None));
    let single = combined(&[&unbounded], Mean, false);
    assert_eq!(single, unbounded);
}
