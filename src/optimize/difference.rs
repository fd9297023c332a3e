//! Intervals of the difference and the ratio of two estimates from independent samples, recovered from the intervals
//! of the estimates.

use crate::responses::Estimate;

/// Estimates `one - other` (G. Y. Zou, A. Donner, Stat. Med. 27 (2008) 1693, doi:10.1002/sim.3095). The standard
/// error is that of independent samples.
pub fn difference(one: &Estimate, other: &Estimate) -> Estimate {
    let Some((x, y)) = one.value.zip(other.value) else { return unknown(one, other) };
    let root = |a: f64, b: f64| (a * a + b * b).sqrt();
    let end = |near: Option<f64>, far: Option<f64>| {
        near.zip(far).map(|(near, far)| root(x - near, y - far))
    };
    Estimate {
        value: Some(x - y),
        standard_error: one.standard_error.zip(other.standard_error).map(|(a, b)| root(a, b)),
        low: end(one.low, other.high).map(|half| x - y - half),
        high: end(one.high, other.low).map(|half| x - y + half),
        reason: one.reason.clone().or_else(|| other.reason.clone()),
    }
}

/// Estimates `one / other` of positive quantities (A. Donner, G. Y. Zou, Stat. Methods Med. Res. 21 (2012) 347,
/// doi:10.1177/0962280210383082); unknown if one of their intervals reaches zero. The standard error is that of
/// independent samples, to first order.
pub fn ratio(one: &Estimate, other: &Estimate) -> Estimate {
    let Some((x, y)) = one.value.zip(other.value) else { return unknown(one, other) };
    let intervals = one.low.zip(one.high).zip(other.low.zip(other.high));
    let Some(((l1, u1), (l2, u2))) = intervals else { return unknown(one, other) };
    if !(l1 > 0.0 && l2 > 0.0) {
        return Estimate::unknown("an interval that reaches zero");
    }
    let end = |own: f64, across: f64, sign: f64| {
        let under = (x * y).powi(2) - own * across * (2.0 * x - own) * (2.0 * y - across);
        let over = across * (2.0 * y - across);
        let end = (x * y + sign * under.max(0.0).sqrt()) / over;
        (over > 0.0 && end.is_finite()).then_some(end)
    };
    let (low, high) = (end(l1, u2, -1.0), end(u1, l2, 1.0));
    let error = one.standard_error.zip(other.standard_error).map(|(a, b)| {
        let (a, b) = (a / x, b / y);
        x / y * (a * a + b * b).sqrt()
    });
    Estimate::within(x / y, error, [low, high], "the interval of the compared design is too wide")
}

fn unknown(one: &Estimate, other: &Estimate) -> Estimate {
    let reason = one.reason.clone().or_else(|| other.reason.clone());
    Estimate { reason, ..Estimate::default() }
}

#[cfg(test)]
mod tests {
    use super::{difference, ratio};
    use crate::responses::Estimate;

    fn estimate(value: f64, low: f64, high: f64) -> Estimate {
        let ends = [Some(low), Some(high)];
        Estimate::within(value, Some((high - low) / 3.92), ends, "none")
    }

    /// Newcombe's example: the fractions 5/56 and 0/29 with Wilson's intervals (0.0387, 0.1926) and (0, 0.1170)
    /// differ by 0.0893 (-0.0381, 0.1926) (Stat. Med. 17 (1998) 873, table II, method 10).
    #[test]
    fn difference_of_fractions() {
        let [one, other] = [estimate(5.0 / 56.0, 0.03873, 0.19258), estimate(0.0, 0.0, 0.11697)];
        let found = difference(&one, &other);
        assert!((found.low.unwrap() + 0.0381).abs() < 2e-4, "{found:?}");
        assert!((found.high.unwrap() - 0.1926).abs() < 2e-4, "{found:?}");
    }

    /// With symmetric intervals the result is Fieller's theorem.
    #[test]
    fn ratio_is_fiellers() {
        let (x, y, a, b): (f64, f64, f64, f64) = (3.0, 2.0, 0.4, 0.3);
        let found = ratio(&estimate(x, x - a, x + a), &estimate(y, y - b, y + b));
        let under = ((x * y).powi(2) - (x * x - a * a) * (y * y - b * b)).sqrt();
        let ends = [-1.0, 1.0].map(|sign| (x * y + sign * under) / (y * y - b * b));
        assert!((found.low.unwrap() - ends[0]).abs() < 1e-12, "{found:?}");
        assert!((found.high.unwrap() - ends[1]).abs() < 1e-12, "{found:?}");
        assert_eq!(ratio(&estimate(1.0, 0.0, 2.0), &estimate(1.0, 0.5, 2.0)).value, None);
    }

    /// Of 2000 pairs of samples 95 % of the intervals contain the true difference and ratio; fewer than 93.6 % have a
    /// probability below 0.3 %.
    #[test]
    fn coverage() {
        let mut state = 9_u64;
        let mut normal = || {
            let mut uniform = || {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            };
            (-2.0 * (1.0 - uniform()).ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
        };
        let mut held = [0; 2];
        for _ in 0..2000 {
            let [x, y] = [5.0 + 0.5 * normal(), 4.0 + 0.2 * normal()];
            let one = estimate(x, x - 1.96 * 0.5, x + 1.96 * 0.5);
            let other = estimate(y, y - 1.96 * 0.2, y + 1.96 * 0.2);
            let all = [(difference(&one, &other), 1.0), (ratio(&one, &other), 1.25)];
            for (count, (found, truth)) in held.iter_mut().zip(all) {
                *count += u32::from(found.low.unwrap() <= truth && truth <= found.high.unwrap());
            }
        }
        assert!(held.iter().all(|held| (1872..=1935).contains(held)), "{held:?}");
    }
}
