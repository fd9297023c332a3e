//! Intervals of differences and ratios: published examples and coverage.

use crate::support::TestRng;
use stickslip::analysis::{Estimate, estimate_difference, estimate_ratio};

fn estimate(value: f64, low: f64, high: f64) -> Estimate {
    let ends = [Some(low), Some(high)];
    Estimate::with_interval(value, Some((high - low) / 3.92), ends, "none")
}

/// Newcombe's example: the fractions 5/56 and 0/29 with Wilson's intervals (0.0387, 0.1926) and (0, 0.1170)
/// differ by 0.0893 (-0.0381, 0.1926) (Stat. Med. 17 (1998) 873, table II, method 10).
#[test]
fn difference_of_fractions() {
    let [first, second] = [estimate(5.0 / 56.0, 0.03873, 0.19258), estimate(0.0, 0.0, 0.11697)];
    let found = estimate_difference(&first, &second, 0.0);
    assert!((found.low.unwrap() + 0.0381).abs() < 2e-4, "{found:?}");
    assert!((found.high.unwrap() - 0.1926).abs() < 2e-4, "{found:?}");
}

/// With symmetric intervals the result is Fieller's theorem.
#[test]
fn ratio_is_fiellers() {
    let (x, y, a, b): (f64, f64, f64, f64) = (3.0, 2.0, 0.4, 0.3);
    let found = estimate_ratio(&estimate(x, x - a, x + a), &estimate(y, y - b, y + b));
    let under = ((x * y).powi(2) - (x * x - a * a) * (y * y - b * b)).sqrt();
    let ends = [-1.0, 1.0].map(|sign| (x * y + sign * under) / (y * y - b * b));
    assert!((found.low.unwrap() - ends[0]).abs() < 1e-12, "{found:?}");
    assert!((found.high.unwrap() - ends[1]).abs() < 1e-12, "{found:?}");
    assert_eq!(estimate_ratio(&estimate(1.0, 0.0, 2.0), &estimate(1.0, 0.5, 2.0)).value, None);
}

/// Of 2000 pairs of samples 95 % of the intervals contain the true difference and ratio; fewer than 93.6 % have a
/// probability below 0.3 %.
#[test]
fn coverage() {
    let mut draws = TestRng::new(9);
    let mut held = [0; 2];
    for _ in 0..2000 {
        let [x, y] = [5.0 + 0.5 * draws.normal(), 4.0 + 0.2 * draws.normal()];
        let first = estimate(x, x - 1.96 * 0.5, x + 1.96 * 0.5);
        let second = estimate(y, y - 1.96 * 0.2, y + 1.96 * 0.2);
        let all = [
            (estimate_difference(&first, &second, 0.0), 1.0),
            (estimate_ratio(&first, &second), 1.25),
        ];
        for (count, (found, truth)) in held.iter_mut().zip(all) {
            *count += u32::from(found.low.unwrap() <= truth && truth <= found.high.unwrap());
        }
    }
    assert!(held.iter().all(|held| (1872..=1935).contains(held)), "{held:?}");
}
