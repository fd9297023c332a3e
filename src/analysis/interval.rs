//! Confidence intervals for a fraction of runs, and for quantiles between order statistics.
//!
//! The number of values below the quantile of a continuous distribution is binomial. The interval of a quantile extends
//! from the `l`-th to the `u`-th smallest value, with the largest `l` and the least `u` for which the quantile lies
//! below the interval, and above it, with a probability of at most 2.5 % each (H. A. David, H. N. Nagaraja, Order
//! Statistics, 3rd ed., Wiley 2003, section 7.1, doi:10.1002/0471722162). Stratified values vary less, so that their
//! interval is conservative.

use statrs::function::factorial::ln_binomial;

use crate::named::named;

/// The two-sided 95 % point of the normal distribution.
pub const Z_95: f64 = 1.959_963_984_540_054;

/// The method that gave an interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IntervalMethod {
    /// Wilson's score interval, with runs as independent trials.
    #[default]
    Wilson,
    /// From the variation within the strata of a stratified design.
    Stratified,
}

named!(IntervalMethod { Wilson: "wilson", Stratified: "stratified" });

/// A 95 % interval of a fraction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConfidenceInterval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// The method that gave it.
    pub method: IntervalMethod,
}

impl ConfidenceInterval {
    /// Returns the lower and the upper end.
    pub fn ends(&self) -> (f64, f64) {
        (self.low, self.high)
    }
}

/// Returns Wilson's score interval for a fraction, `successes` of `trials`. It is valid at 0 and 1
/// and for few trials, and is [0, 1] for no trials.
///
/// Source: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209, doi:10.1080/01621459.1927.10502953.
pub fn wilson(successes: u64, trials: u64, z: f64) -> (f64, f64) {
    match trials {
        0 => (0.0, 1.0),
        _ => score_interval(successes as f64 / trials as f64, trials as f64, z),
    }
}

/// Returns Wilson's interval for a fraction observed in `n` trials; `n` need not be an integer.
pub(super) fn score_interval(fraction: f64, n: f64, z: f64) -> (f64, f64) {
    let z2 = z * z;
    let centre = (fraction + z2 / (2.0 * n)) / (1.0 + z2 / n);
    let half = z / (1.0 + z2 / n) * (fraction * (1.0 - fraction) / n + z2 / (4.0 * n * n)).sqrt();
    // At a fraction of 0 or 1 the interval includes that end exactly, despite rounding.
    let low = if fraction == 0.0 { 0.0 } else { (centre - half).max(0.0) };
    let high = if fraction == 1.0 { 1.0 } else { (centre + half).min(1.0) };
    (low, high)
}

/// Returns Wilson's interval if some runs failed and their labels are unknown: from the lower end with
/// no failed run as a success to the upper end with all of them as successes.
pub fn wilson_with_failures(successes: u64, failures: u64, trials: u64, z: f64) -> (f64, f64) {
    (wilson(successes, trials, z).0, wilson(successes + failures, trials, z).1)
}

/// The number of kinds of runs.
const KINDS: usize = 8;

/// The two-sided point of the normal distribution with an error of 5 % over the number of kinds: all intervals together have an
/// error of at most 5 % (Bonferroni).
const JOINT: f64 = 2.734_368_786_533_181;

/// Returns intervals for the fractions of eight kinds of runs that hold jointly at 95 %. The last
/// kind are failures. A failed run could have been of any other kind, so that the upper ends of the
/// other intervals count it.
///
/// Source: L. A. Goodman, Technometrics 7 (1965) 247, doi:10.1080/00401706.1965.10490252.
pub fn simultaneous(counts: [u64; KINDS]) -> [(f64, f64); KINDS] {
    let trials = counts.iter().sum();
    let failures = counts[KINDS - 1];
    std::array::from_fn(|kind| match kind + 1 == KINDS {
        true => wilson(failures, trials, JOINT),
        false => wilson_with_failures(counts[kind], failures, trials, JOINT),
    })
}

/// The largest probability of a quantile on either side of its interval.
const TAIL: f64 = 0.025;

/// Returns the ranks, from 0, of the values at the ends of the 95 % interval of a quantile of `count` values; an end is
/// `None` if the values do not bound it.
pub(crate) fn interval_ranks(count: u64, fraction: f64) -> [Option<u64>; 2] {
    if count == 0 || fraction <= 0.0 || fraction >= 1.0 {
        return [None, None];
    }
    let probability = |k: u64| {
        let choices = ln_binomial(count, k);
        let (k, n) = (k as f64, count as f64);
        libm::exp(choices + k * libm::log(fraction) + (n - k) * libm::log1p(-fraction))
    };
    // The number of values below the quantile, up to the tail probability, from either end.
    let mut below = 0.0;
    let low = (0..count)
        .take_while(|k| {
            below += probability(*k);
            below <= TAIL
        })
        .last();
    let mut above = 0.0;
    let high = (1..=count)
        .rev()
        .take_while(|k| {
            above += probability(*k);
            above <= TAIL
        })
        .last();
    [low, high.map(|k| k - 1)]
}
