//! Distribution-free intervals of quantiles between order statistics.
//!
//! The number of values below the quantile of a continuous distribution is binomial. The interval extends from the
//! `l`-th to the `u`-th smallest value, with the largest `l` and the least `u` for which the quantile lies below the
//! interval, and above it, with a probability of at most 2.5 % each (H. A. David, H. N. Nagaraja, Order Statistics,
//! 3rd ed., Wiley 2003, section 7.1, doi:10.1002/0471722162). Stratified values vary less, so that their interval is
//! conservative.

use statrs::function::factorial::ln_binomial;

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
