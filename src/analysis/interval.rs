//! Intervals for a share of runs.

/// The two-sided 95 % point of the normal distribution.
pub const Z_95: f64 = 1.959_963_984_540_054;

/// Wilson's score interval for a share, `successes` of `trials`: valid at 0 and 1 and for few
/// trials; the whole of [0, 1] where there are none.
///
/// Source: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209, doi:10.1080/01621459.1927.10502953.
pub fn wilson(successes: u64, trials: u64, z: f64) -> (f64, f64) {
    if trials == 0 {
        return (0.0, 1.0);
    }
    let n = trials as f64;
    let share = successes as f64 / n;
    let z2 = z * z;
    let centre = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
    let half = z / (1.0 + z2 / n) * (share * (1.0 - share) / n + z2 / (4.0 * n * n)).sqrt();
    // At the ends the interval reaches the end exactly; rounding must not take that away.
    let low = if successes == 0 { 0.0 } else { (centre - half).max(0.0) };
    let high = if successes == trials { 1.0 } else { (centre + half).min(1.0) };
    (low, high)
}

/// Wilson's interval when some runs failed, so that it is not known what they would have done: from
/// the lower end if none of them had succeeded to the upper end if all had.
pub fn wilson_with_failures(successes: u64, failures: u64, trials: u64, z: f64) -> (f64, f64) {
    (wilson(successes, trials, z).0, wilson(successes + failures, trials, z).1)
}

#[cfg(test)]
mod tests {
    use super::{Z_95, wilson, wilson_with_failures};

    /// Brown, Cai, DasGupta, Stat. Sci. 16 (2001) 101 give no table; these values are the roots of
    /// `|p - k/n| = z sqrt(p (1 - p) / n)`, which defines the interval.
    #[test]
    fn ends_solve_the_score_equation() {
        for (k, n) in [(1, 10), (5, 10), (435, 768), (61, 256), (1, 1_000_000)] {
            let (low, high) = wilson(k, n, Z_95);
            let share = k as f64 / n as f64;
            for end in [low, high] {
                let score = (end - share).abs() - Z_95 * (end * (1.0 - end) / n as f64).sqrt();
                assert!(score.abs() < 1e-12, "{k} of {n}: {end}");
            }
            assert!(low < share && share < high);
        }
    }

    #[test]
    fn ends_of_the_range() {
        assert_eq!(wilson(0, 0, Z_95), (0.0, 1.0));
        assert_eq!(wilson(0, 768, Z_95).0, 0.0);
        assert_eq!(wilson(768, 768, Z_95).1, 1.0);
        assert!(wilson(768, 768, Z_95).0 > 0.99);
    }

    #[test]
    fn failures_widen() {
        let without = wilson(50, 100, Z_95);
        let with = wilson_with_failures(50, 10, 100, Z_95);
        assert_eq!(with.0, without.0);
        assert_eq!(with.1, wilson(60, 100, Z_95).1);
    }

    /// Coverage: over shares p and all outcomes k of n, weighted by the binomial distribution, the
    /// interval holds p in 95 % on average (Wilson's interval has mean coverage within 1 % here).
    #[test]
    fn mean_coverage_is_95_percent() {
        let n = 60_u64;
        let mut mean = 0.0;
        let shares = 400;
        for i in 0..shares {
            let p = (f64::from(i) + 0.5) / f64::from(shares);
            let mut probability = (1.0 - p).powi(n as i32);
            for k in 0..=n {
                let (low, high) = wilson(k, n, Z_95);
                if low <= p && p <= high {
                    mean += probability / f64::from(shares);
                }
                probability *= p / (1.0 - p) * (n - k) as f64 / (k + 1) as f64;
            }
        }
        assert!((mean - 0.95).abs() < 0.01, "{mean}");
    }
}
