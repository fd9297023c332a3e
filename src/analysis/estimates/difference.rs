//! Intervals of the difference and the ratio of two estimates, recovered from the intervals of the estimates.

use super::estimate::Estimate;

/// Estimates `first - second` of two estimates with this correlation, which is 0 for independent samples (G. Y. Zou, Psychol.
/// Methods 12 (2007) 399, doi:10.1037/1082-989X.12.4.399; G. Y. Zou, A. Donner, Stat. Med. 27 (2008) 1693,
/// doi:10.1002/sim.3095).
pub fn estimate_difference(first: &Estimate, second: &Estimate, correlation: f64) -> Estimate {
    let Some((x, y)) = first.value.zip(second.value) else { return unknown(first, second) };
    let root = |a: f64, b: f64| (a * a + b * b - 2.0 * correlation * a * b).max(0.0).sqrt();
    let half_width = |end: Option<f64>, opposite: Option<f64>| {
        end.zip(opposite).map(|(end, opposite)| root((x - end).abs(), (y - opposite).abs()))
    };
    Estimate {
        value: Some(x - y),
        standard_error: first.standard_error.zip(second.standard_error).map(|(a, b)| root(a, b)),
        low: half_width(first.low, second.high).map(|half| x - y - half),
        high: half_width(first.high, second.low).map(|half| x - y + half),
        reason: first.reason.clone().or_else(|| second.reason.clone()),
    }
}

/// Estimates `first / second` of positive quantities (A. Donner, G. Y. Zou, Stat. Methods Med. Res. 21 (2012) 347,
/// doi:10.1177/0962280210383082); unknown if one of their intervals reaches zero. The standard error is that of
/// independent samples, to first order.
pub fn estimate_ratio(first: &Estimate, second: &Estimate) -> Estimate {
    let Some((x, y)) = first.value.zip(second.value) else { return unknown(first, second) };
    let intervals = first.low.zip(first.high).zip(second.low.zip(second.high));
    let Some(((l1, u1), (l2, u2))) = intervals else { return unknown(first, second) };
    if !(l1 > 0.0 && l2 > 0.0) {
        return Estimate::unknown("an interval that reaches zero");
    }
    let ratio_end = |end: f64, opposite: f64, sign: f64| {
        let radicand = (x * y).powi(2) - end * opposite * (2.0 * x - end) * (2.0 * y - opposite);
        let denominator = opposite * (2.0 * y - opposite);
        let ratio = (x * y + sign * radicand.max(0.0).sqrt()) / denominator;
        (denominator > 0.0 && ratio.is_finite()).then_some(ratio)
    };
    let (low, high) = (ratio_end(l1, u2, -1.0), ratio_end(u1, l2, 1.0));
    let error = first.standard_error.zip(second.standard_error).map(|(a, b)| {
        let (a, b) = (a / x, b / y);
        x / y * (a * a + b * b).sqrt()
    });
    Estimate::with_interval(
        x / y,
        error,
        [low, high],
        "the interval of the compared design is too wide",
    )
}

fn unknown(first: &Estimate, second: &Estimate) -> Estimate {
    let reason = first.reason.clone().or_else(|| second.reason.clone());
    Estimate { reason, ..Estimate::default() }
}
