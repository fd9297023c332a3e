//! Wilson's intervals and simultaneous intervals: definition and coverage.

use crate::support::TestRng;
use stickslip::analysis::{Z_95, simultaneous, wilson, wilson_with_failures};

/// The ends are the roots of `|p - k/n| = z sqrt(p (1 - p) / n)`, which defines the interval
/// (Brown, Cai, DasGupta, Stat. Sci. 16 (2001) 101; they give no table).
#[test]
fn ends_solve_the_score_equation() {
    for (k, n) in [(1, 10), (5, 10), (435, 768), (61, 256), (1, 1_000_000)] {
        let (low, high) = wilson(k, n, Z_95);
        let fraction = k as f64 / n as f64;
        for end in [low, high] {
            let score = (end - fraction).abs() - Z_95 * (end * (1.0 - end) / n as f64).sqrt();
            assert!(score.abs() < 1e-12, "{k} of {n}: {end}");
        }
        assert!(low < fraction && fraction < high);
    }
}

#[test]
fn intervals_at_the_ends_of_the_range_are_closed() {
    assert_eq!(wilson(0, 0, Z_95), (0.0, 1.0));
    assert_eq!(wilson(0, 768, Z_95).0, 0.0);
    assert_eq!(wilson(768, 768, Z_95).1, 1.0);
    assert!(wilson(768, 768, Z_95).0 > 0.99);
}

#[test]
fn failures_widen_the_interval() {
    let without = wilson(50, 100, Z_95);
    let with = wilson_with_failures(50, 10, 100, Z_95);
    assert_eq!(with.0, without.0);
    assert_eq!(with.1, wilson(60, 100, Z_95).1);
}

/// Averaged over the fractions p, with all outcomes k of n weighted by the binomial
/// distribution, the interval contains p in 95 % of the cases (within 1 %).
#[test]
fn mean_coverage_is_95_percent() {
    let n = 60_u64;
    let mut mean = 0.0;
    let fractions = 400;
    for i in 0..fractions {
        let p = (f64::from(i) + 0.5) / f64::from(fractions);
        let mut probability = (1.0 - p).powi(n as i32);
        for k in 0..=n {
            let (low, high) = wilson(k, n, Z_95);
            if low <= p && p <= high {
                mean += probability / f64::from(fractions);
            }
            probability *= p / (1.0 - p) * (n - k) as f64 / (k + 1) as f64;
        }
    }
    assert!((mean - 0.95).abs() < 0.01, "{mean}");
}

/// Each of the eight intervals is Wilson's with an eighth of the error, and the last kind widens the upper ends of the others.
#[test]
fn eight_intervals_share_the_error() {
    const JOINT: f64 = 2.734_368_786_533_181;
    let outside = libm::erfc(JOINT / std::f64::consts::SQRT_2);
    assert!((outside - 0.05 / 8.0).abs() < 1e-15, "{outside}");
    let intervals = simultaneous([50, 0, 0, 0, 20, 10, 10, 10]);
    assert_eq!(intervals[0], (wilson(50, 100, JOINT).0, wilson(60, 100, JOINT).1));
    assert_eq!(intervals[1], (0.0, wilson(10, 100, JOINT).1));
    assert_eq!(intervals[7], wilson(10, 100, JOINT));
    assert_eq!(simultaneous([0; 8]), [(0.0, 1.0); 8]);
}

/// All eight fractions lie in their intervals in at least 95 % of seeded samples (two standard
/// errors of 4000 samples: 0.0068). The samples have no failures, which would only widen the
/// intervals.
#[test]
fn joint_coverage_is_95_percent() {
    let mut draws = TestRng::new(1965);
    let fractions = [
        [0.2, 0.0, 0.2, 0.0, 0.2, 0.2, 0.1, 0.1],
        [0.5, 0.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.0],
        [0.9, 0.05, 0.0, 0.0, 0.0, 0.05, 0.0, 0.0],
        [0.97, 0.01, 0.0, 0.0, 0.01, 0.01, 0.0, 0.0],
        [0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0],
    ];
    for trials in [50, 256, 768] {
        for fractions in fractions {
            let repetitions = 4000;
            let (mut held, mut single) = (0, 0);
            for _ in 0..repetitions {
                let mut counts = [0; 8];
                for _ in 0..trials {
                    let mut left = draws.uniform();
                    let kind = fractions.iter().position(|fraction| {
                        left -= fraction;
                        left < 0.0
                    });
                    counts[kind.unwrap_or(5)] += 1;
                }
                let holds = |(fraction, (low, high)): (&f64, (f64, f64))| {
                    low <= *fraction && *fraction <= high
                };
                held += u32::from(fractions.iter().zip(simultaneous(counts)).all(holds));
                let each = counts.map(|count| wilson(count, trials, Z_95));
                single += u32::from(fractions.iter().zip(each).all(holds));
            }
            let [held, single] =
                [held, single].map(|held| f64::from(held) / f64::from(repetitions));
            println!("{trials} runs, {fractions:?}: {held}, with intervals of their own {single}");
            assert!(held > 0.95 - 0.0068 && held >= single, "{trials}, {fractions:?}: {held}");
        }
    }
}
