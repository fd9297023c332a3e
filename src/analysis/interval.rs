//! Intervals for a fraction of runs.

/// The two-sided 95 % point of the normal distribution.
pub const Z_95: f64 = 1.959_963_984_540_054;

/// How an interval was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IntervalMethod {
    /// Wilson's score interval: runs count one by one.
    Wilson,
    /// From the variation within the cells of a stratified design.
    Stratified,
}

impl IntervalMethod {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wilson => "wilson",
            Self::Stratified => "stratified",
        }
    }
}

/// A 95 % interval of a fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
    /// How it was made.
    pub method: IntervalMethod,
}

impl Interval {
    /// Its lower and its upper end.
    pub fn ends(&self) -> (f64, f64) {
        (self.low, self.high)
    }
}

/// Wilson's score interval for a fraction, `successes` of `trials`: valid at 0 and 1 and for few
/// trials; the whole of [0, 1] where there are none.
///
/// Source: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209, doi:10.1080/01621459.1927.10502953.
pub fn wilson(successes: u64, trials: u64, z: f64) -> (f64, f64) {
    match trials {
        0 => (0.0, 1.0),
        _ => score_interval(successes as f64 / trials as f64, trials as f64, z),
    }
}

/// Wilson's interval for a fraction seen in `n` trials, which need not be a whole number.
pub(super) fn score_interval(fraction: f64, n: f64, z: f64) -> (f64, f64) {
    let z2 = z * z;
    let centre = (fraction + z2 / (2.0 * n)) / (1.0 + z2 / n);
    let half = z / (1.0 + z2 / n) * (fraction * (1.0 - fraction) / n + z2 / (4.0 * n * n)).sqrt();
    // At the ends the interval reaches the end exactly; rounding must not take that away.
    let low = if fraction == 0.0 { 0.0 } else { (centre - half).max(0.0) };
    let high = if fraction == 1.0 { 1.0 } else { (centre + half).min(1.0) };
    (low, high)
}

/// Wilson's interval when some runs failed, so that it is not known what they would have done: from
/// the lower end if none of them had succeeded to the upper end if all had.
pub fn wilson_with_failures(successes: u64, failures: u64, trials: u64, z: f64) -> (f64, f64) {
    (wilson(successes, trials, z).0, wilson(successes + failures, trials, z).1)
}

/// The two-sided point of the normal distribution at 99 %: five intervals, each of which misses with
/// 1 %, miss together with 5 % at most (Bonferroni).
const Z_99: f64 = 2.575_829_303_548_901;

/// Intervals for the fractions of five kinds of runs that hold all together with 95 %, failures being
/// the last kind: a failed run might have been of any other kind, so that the upper ends of the
/// others count it.
///
/// Source: L. A. Goodman, Technometrics 7 (1965) 247, doi:10.1080/00401706.1965.10490252.
pub fn simultaneous(counts: [u64; 5]) -> [(f64, f64); 5] {
    let trials = counts.iter().sum();
    let [others @ .., failures] = counts;
    let [a, b, c, d] = others.map(|count| wilson_with_failures(count, failures, trials, Z_99));
    [a, b, c, d, wilson(failures, trials, Z_99)]
}

#[cfg(test)]
mod tests {
    use super::{Z_95, Z_99, simultaneous, wilson, wilson_with_failures};
    use crate::analysis::test_rng::TestRng;

    /// Brown, Cai, DasGupta, Stat. Sci. 16 (2001) 101 give no table; these values are the roots of
    /// `|p - k/n| = z sqrt(p (1 - p) / n)`, which defines the interval.
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

    /// Coverage: over fractions p and all outcomes k of n, weighted by the binomial distribution, the
    /// interval holds p in 95 % on average (Wilson's interval has mean coverage within 1 % here).
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

    /// Five intervals that each miss with 1 %, by the normal distribution's own function.
    #[test]
    fn five_intervals_fraction_the_error() {
        let beyond = libm::erfc(Z_99 / std::f64::consts::SQRT_2);
        assert!((beyond - 0.01).abs() < 1e-15, "{beyond}");
        let intervals = simultaneous([50, 0, 20, 20, 10]);
        assert_eq!(intervals[0], (wilson(50, 100, Z_99).0, wilson(60, 100, Z_99).1));
        assert_eq!(intervals[1], (0.0, wilson(10, 100, Z_99).1));
        assert_eq!(intervals[4], wilson(10, 100, Z_99));
        assert_eq!(simultaneous([0; 5]), [(0.0, 1.0); 5]);
    }

    /// All five fractions lie in their intervals in 95 % of seeded samples or more (to the error of 4000:
    /// 0.0034); without failures, as those only widen.
    #[test]
    fn joint_coverage_is_95_percent() {
        let mut draws = TestRng::new(1965);
        let fractions = [
            [0.2, 0.2, 0.2, 0.2, 0.2],
            [0.5, 0.1, 0.1, 0.3, 0.0],
            [0.9, 0.05, 0.0, 0.05, 0.0],
            [0.97, 0.01, 0.01, 0.01, 0.0],
            [0.5, 0.0, 0.0, 0.5, 0.0],
        ];
        for trials in [50, 256, 768] {
            for fractions in fractions {
                let repetitions = 4000;
                let (mut held, mut single) = (0, 0);
                for _ in 0..repetitions {
                    let mut counts = [0; 5];
                    for _ in 0..trials {
                        let mut left = draws.uniform();
                        let kind = fractions.iter().position(|fraction| {
                            left -= fraction;
                            left < 0.0
                        });
                        counts[kind.unwrap_or(3)] += 1;
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
                println!(
                    "{trials} runs, {fractions:?}: {held}, with intervals of their own {single}"
                );
                assert!(held > 0.95 - 0.0068 && held >= single, "{trials}, {fractions:?}: {held}");
            }
        }
    }
}
