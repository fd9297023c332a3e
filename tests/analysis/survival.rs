//! Kaplan-Meier curves against textbooks, exact limits and simulated samples.

use crate::support::TestRng;
use stickslip::analysis::{SurvivalCurve, ValueCounts};

fn curve(rests: &[f64], stopped: &[f64]) -> SurvivalCurve {
    let mut times = ValueCounts::default();
    stopped.iter().for_each(|time| times.add(*time, 1));
    rests.iter().for_each(|time| times.add(*time, 0));
    SurvivalCurve::new(times.groups())
}

/// The curve of the 6-MP group of Freireich et al. (Blood 21 (1963) 699) has the estimates,
/// Greenwood standard errors and log(-log) intervals printed in textbooks and by statistics
/// programs. The median is 23 weeks, with an interval from 13 to not reached.
#[test]
fn the_6mp_group_has_the_textbook_estimates() {
    let rests = [6.0, 6.0, 6.0, 7.0, 10.0, 13.0, 16.0, 22.0, 23.0];
    let stopped = [6.0, 9.0, 10.0, 11.0, 17.0, 19.0, 20.0, 25.0, 32.0, 32.0, 34.0, 35.0];
    let curve = curve(&rests, &stopped);
    let expected = [
        (6.0, 21, 0.8571, 0.0764, 0.6197, 0.9516),
        (7.0, 17, 0.8067, 0.0869, 0.5631, 0.9228),
        (10.0, 15, 0.7529, 0.0963, 0.5032, 0.8894),
        (13.0, 12, 0.6902, 0.1068, 0.4316, 0.8491),
        (16.0, 11, 0.6275, 0.1141, 0.3675, 0.8049),
        (22.0, 7, 0.5378, 0.1282, 0.2678, 0.7468),
        (23.0, 6, 0.4482, 0.1346, 0.1881, 0.6801),
    ];
    assert_eq!(curve.steps.len(), expected.len());
    for (step, (time, at_risk, moving, error, low, high)) in curve.steps.iter().zip(expected) {
        assert_eq!((step.time_s, step.at_risk), (time, at_risk));
        let found = [step.moving, step.standard_error().unwrap(), step.interval.0, step.interval.1];
        for (found, printed) in found.iter().zip([moving, error, low, high]) {
            assert!((found - printed).abs() < 5.01e-5, "{time}: {found} {printed}");
        }
    }
    assert_eq!(curve.time_to_rest_quantile(0.5), Some(23.0));
    assert_eq!(curve.time_to_rest_interval(0.5), [Some(13.0), None]);
    assert_eq!(curve.time_to_rest_quantile(0.75), None);
}

/// Without censoring, quantiles are sample quantiles and Greenwood's variance is the binomial
/// one, `S (1 - S) / n`.
#[test]
fn without_censoring_quantiles_are_sample_quantiles() {
    let times: Vec<f64> = (1..=100).map(f64::from).collect();
    let all = curve(&times, &[]);
    assert_eq!(all.time_to_rest_quantile(0.5), Some(50.0));
    assert_eq!(all.time_to_rest_quantile(0.95), Some(95.0));
    assert_eq!(all.time_to_rest_quantile(1.0), Some(100.0));
    for step in &all.steps[..99] {
        let binomial = (step.moving * (1.0 - step.moving) / 100.0).sqrt();
        assert!((step.standard_error().unwrap() / binomial - 1.0).abs() < 1e-12);
        assert!(step.interval.0 < step.moving && step.moving < step.interval.1);
    }
    assert_eq!(curve(&[], &[]).time_to_rest_quantile(0.5), None);
    assert_eq!(curve(&[], &[]).time_to_rest_interval(0.5), [None, None]);
}

/// With all runs at rest, none at rest, or no runs, the interval is the exact binomial one,
/// with bounds that solve `p^n = 0.025`.
#[test]
fn intervals_at_the_ends_are_exact_binomial() {
    for n in [1_u32, 2, 10, 1000] {
        let times: Vec<f64> = (1..=n).map(f64::from).collect();
        let (all, none) = (curve(&times, &[]), curve(&[], &times));
        let step = all.steps.last().unwrap();
        assert_eq!((step.moving, step.standard_error()), (0.0, None));
        assert_eq!(step.interval.0, 0.0);
        assert!(((1.0 - step.interval.1).powi(n as i32) / 0.025 - 1.0).abs() < 1e-9);
        assert!(none.steps.is_empty());
        assert_eq!((none.runs, none.stopped_before), (u64::from(n), u64::from(n)));
        let (low, high) = none.interval_before();
        assert!((low.powi(n as i32) / 0.025 - 1.0).abs() < 1e-9 && high == 1.0);
    }
    assert_eq!(curve(&[], &[]).interval_before(), (0.0, 1.0));
    // The bounds decrease monotonically.
    let steps = curve(&[1.0, 2.0, 3.0, 4.0, 5.0], &[2.5, 3.5]).steps;
    for pair in steps.windows(2) {
        assert!(pair[1].interval.0 <= pair[0].interval.0);
        assert!(pair[1].interval.1 <= pair[0].interval.1);
    }
}

/// For runs that rest at a rate of 1 and are stopped between 0 and 4 s, the intervals of the
/// curve at fixed times and of the median, ln 2, have a coverage near 95 %. With 20 runs, few
/// have rested early, and the discrete coverage falls to 0.93.
#[test]
fn coverage_is_95_percent() {
    let mut draws = TestRng::new(3);
    for (runs, least) in [(20, 0.915), (100, 0.93)] {
        let times = [0.02, 0.2, 0.7, 1.5, 2.5];
        let (mut held, mut median) = ([0.0; 5], 0.0);
        let repetitions = 4000;
        for _ in 0..repetitions {
            let (mut rests, mut stopped) = (Vec::new(), Vec::new());
            for _ in 0..runs {
                let (rest, stop) = (draws.exponential(1.0), 4.0 * draws.uniform());
                if rest <= stop { rests.push(rest) } else { stopped.push(stop) }
            }
            let curve = curve(&rests, &stopped);
            for (held, time) in held.iter_mut().zip(times) {
                let (low, high) = match curve.steps.iter().rfind(|step| step.time_s <= time) {
                    Some(step) => step.interval,
                    None => curve.interval_before(),
                };
                let moving = (-time).exp();
                *held += f64::from(u8::from(low <= moving && moving <= high));
            }
            let [low, high] = curve.time_to_rest_interval(0.5);
            let exact = std::f64::consts::LN_2;
            let holds = low.is_none_or(|low| low <= exact) && high.is_none_or(|high| exact <= high);
            median += f64::from(u8::from(holds));
        }
        let fraction = |count: f64| count / f64::from(repetitions);
        println!("{runs} runs: {:?}, median {}", held.map(fraction), fraction(median));
        for (held, time) in held.into_iter().zip(times) {
            assert!(fraction(held) > least, "{runs} runs, {time} s: {}", fraction(held));
        }
        assert!((fraction(median) - 0.95).abs() < 0.02, "{runs} runs: {}", fraction(median));
    }
}
