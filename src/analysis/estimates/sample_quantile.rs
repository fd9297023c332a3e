//! Quantiles of samples with standard errors and the intervals of [`interval_ranks`].

use statrs::function::beta::checked_beta_reg;

use crate::analysis::{interpolated_quantile, interval_ranks};

/// Returns the quantile of ascending values (see [`interpolated_quantile`]); `None` if there are no values.
pub(super) fn quantile(ascending: &[f64], fraction: f64) -> Option<f64> {
    let value = |rank| ascending.get(usize::try_from(rank).ok()?).copied();
    interpolated_quantile(ascending.len() as u64, fraction, value)
}

/// Returns the 95 % interval of the quantile; an end is `None` if the values do not bound it.
pub(super) fn interval(ascending: &[f64], fraction: f64) -> [Option<f64>; 2] {
    let value = |rank| ascending.get(usize::try_from(rank).ok()?).copied();
    interval_ranks(ascending.len() as u64, fraction).map(|rank| rank.and_then(value))
}

/// The range of the sum over order statistics, in standard deviations of a proportion. The quantile of a resample lies
/// outside of this range with a probability below 1e-15.
const REACH: f64 = 8.0;

/// A value, the fraction of the distribution up to it, and the number of runs behind that fraction (with censoring,
/// the effective number).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CumulativeFraction {
    pub value: f64,
    pub proportion: f64,
    pub runs: f64,
}

/// Returns the cumulative distribution of ascending values.
pub(super) fn cumulative(ascending: &[f64]) -> impl Iterator<Item = CumulativeFraction> {
    let runs = ascending.len() as f64;
    let at = move |(index, value): (usize, &f64)| CumulativeFraction {
        value: *value,
        proportion: (index + 1) as f64 / runs,
        runs,
    };
    ascending.iter().enumerate().map(at)
}

/// Returns the standard error of a quantile: that of a bootstrap with infinitely many resamples, in closed form.
///
/// In a resample of `n` runs the quantile `q` is at most `x` with the probability `I_F(a, b)`, where `F` is the
/// fraction of the runs up to `x`, `I` the regularised incomplete beta function, `a = q (n - 1) + 1` and
/// `b = (1 - q) (n - 1) + 1`. Unlike the width of an interval it accounts for the gap of a bimodal sample. Returns
/// `None` if more than 2.5 % of the resamples do not reach the quantile.
///
/// Source: J. S. Maritz, R. G. Jarrett, J. Am. Stat. Assoc. 73 (1978) 194,
/// doi:10.1080/01621459.1978.10480027.
pub(super) fn standard_error(
    ascending: impl Iterator<Item = CumulativeFraction>,
    fraction: f64,
) -> Option<f64> {
    let (mut weight, mut first, mut second, mut reference) = (0.0, 0.0, 0.0, None);
    for CumulativeFraction { value, proportion, runs } in ascending {
        let scale = (fraction * (1.0 - fraction) / runs).sqrt();
        let off = (proportion - fraction) / (scale + 1.0 / runs);
        let (a, b) = (fraction * (runs - 1.0) + 1.0, (1.0 - fraction) * (runs - 1.0) + 1.0);
        let reached = match off {
            off if off < -REACH => 0.0,
            off if off > REACH => 1.0,
            _ => checked_beta_reg(a, b, proportion.clamp(0.0, 1.0)).ok()?,
        };
        // With censoring the effective number of runs decreases, and so could the probability.
        let part = (reached - weight).max(0.0);
        weight += part;
        let from = value - *reference.get_or_insert(value);
        first += part * from;
        second += part * from * from;
    }
    let (mean, square) = (first / weight, second / weight);
    (weight >= 0.975).then(|| (square - mean * mean).max(0.0).sqrt())
}
