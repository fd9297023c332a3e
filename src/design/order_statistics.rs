//! Quantiles and their intervals between order statistics, which hold whatever the distribution.
//!
//! Of `n` values the number below the quantile `q` of a continuous distribution is binomial. The
//! interval from the `l`-th to the `u`-th value in order has the largest `l` and the least `u` for which
//! that number is below `l`, and is `u` or more, with at most 2.5 % each (H. A. David, H. N. Nagaraja,
//! Order Statistics, 3rd ed., Wiley 2003, section 7.1, doi:10.1002/0471722162). Values drawn cell by
//! cell vary less, so that for them it is wider than need be, not wrong.

/// The quantile of ascending values, linear between them (type 7 of Hyndman and Fan, Am. Stat. 50
/// (1996) 361, doi:10.1080/00031305.1996.10473566); none of no values.
pub(super) fn quantile(ascending: &[f64], share: f64) -> Option<f64> {
    let place = share * ascending.len().checked_sub(1)? as f64;
    let low = *ascending.get(place.floor() as usize)?;
    let high = *ascending.get(place.ceil() as usize)?;
    let part = place - place.floor();
    Some(if part == 0.0 { low } else { low + part * (high - low) })
}

/// The 95 % interval of the quantile; an end is none where the values set no bound.
pub(super) fn interval(ascending: &[f64], share: f64) -> [Option<f64>; 2] {
    const TAIL: f64 = 0.025;
    let n = ascending.len();
    if n == 0 || share <= 0.0 || share >= 1.0 {
        return [None, None];
    }
    let log_choose =
        |k: f64, n: f64| libm::lgamma(n + 1.0) - libm::lgamma(k + 1.0) - libm::lgamma(n - k + 1.0);
    let probability = |k: usize| {
        let (k, n) = (k as f64, n as f64);
        libm::exp(log_choose(k, n) + k * libm::log(share) + (n - k) * libm::log1p(-share))
    };
    // How many values are below with at most so much probability, from either end.
    let (mut below, mut low) = (0.0, None);
    for (k, value) in ascending.iter().enumerate() {
        below += probability(k);
        if below > TAIL {
            break;
        }
        low = Some(*value);
    }
    let (mut above, mut high) = (0.0, None);
    for k in (1..=n).rev() {
        above += probability(k);
        if above > TAIL {
            break;
        }
        high = ascending.get(k - 1).copied();
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::{interval, quantile};

    /// Conover, Practical Nonparametric Statistics, and every table of the sign test: the median of ten
    /// values lies between the second and the ninth, of twenty between the sixth and the fifteenth.
    #[test]
    fn the_table() {
        let values: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!(interval(&values[..10], 0.5), [Some(2.0), Some(9.0)]);
        assert_eq!(interval(&values, 0.5), [Some(6.0), Some(15.0)]);
        assert_eq!(interval(&values[..5], 0.5), [None, None], "1/32 in each tail");
        assert_eq!(interval(&values[..6], 0.5), [Some(1.0), Some(6.0)], "1/64 in each tail");
        assert_eq!(interval(&values, 0.95)[1], None, "0.95^20 = 0.36 is beyond the last");
        assert_eq!(interval(&[], 0.5), [None, None]);
    }

    #[test]
    fn linear_between_values() {
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.5), Some(2.0));
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.75), Some(3.0));
        assert_eq!(quantile(&[7.0], 0.1), Some(7.0));
        assert_eq!(quantile(&[], 0.1), None);
    }
}
