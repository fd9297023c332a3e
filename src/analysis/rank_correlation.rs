//! Spearman's rank correlation with its 95 % interval.

use super::Z_95;

/// The fewest pairs of values that have an interval.
const FEWEST: usize = 5;

/// A rank correlation with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankCorrelation {
    /// Spearman's coefficient, from -1 to 1.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// Returns Spearman's rank correlation of independent pairs of values. Equal values have the mean of their ranks;
/// infinite values rank first or last. Returns `None` if there are fewer than five pairs, if all values of a column are
/// equal, or if a value is NaN.
///
/// The interval is Fisher's transformation with the variance (1 + r²/2) / (n - 3) of D. G. Bonett and T. A. Wright
/// (Psychometrika 65 (2000) 23, doi:10.1007/BF02294183).
pub fn rank_correlation(x: &[f64], y: &[f64]) -> Option<RankCorrelation> {
    let count = x.len();
    if count < FEWEST || count != y.len() || x.iter().chain(y).any(|value| value.is_nan()) {
        return None;
    }
    let middle = (count as f64 + 1.0) / 2.0;
    let [x, y] = [x, y].map(|values| {
        let ranks = ranks(values);
        ranks.into_iter().map(|rank| rank - middle).collect::<Vec<f64>>()
    });
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scale = (product(&x, &x) * product(&y, &y)).sqrt();
    if scale == 0.0 {
        return None;
    }
    let value = (product(&x, &y) / scale).clamp(-1.0, 1.0);
    let half = Z_95 * ((1.0 + value * value / 2.0) / (count as f64 - 3.0)).sqrt();
    let end = |shift: f64| (value.atanh() + shift).tanh();
    Some(RankCorrelation { value, low: end(-half), high: end(half) })
}

/// Returns the ranks of values from 1; equal values have the mean of their ranks.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    let value = |place: &usize| values.get(*place).copied().unwrap_or(f64::NAN);
    order.sort_by(|a, b| value(a).total_cmp(&value(b)));
    let mut ranks = vec![0.0; values.len()];
    let mut before = 0;
    for equal in order.chunk_by(|a, b| value(a) == value(b)) {
        let rank = before as f64 + (equal.len() as f64 + 1.0) / 2.0;
        for &place in equal {
            if let Some(of) = ranks.get_mut(place) {
                *of = rank;
            }
        }
        before += equal.len();
    }
    ranks
}
