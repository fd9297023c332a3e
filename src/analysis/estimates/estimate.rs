//! Samples of runs, the estimates made from them, and the difference and the ratio of two estimates.

use std::borrow::Cow;

use serde::Serialize;

use crate::classification::Label;

/// The results of one run that responses use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunResult {
    /// Number of the run's cell in a stratified design; otherwise 0.
    pub cell: u64,
    /// Label of the run.
    pub label: Label,
    /// The measured amplitude, in m or relative to the amplitude without balls; `None` if the run failed.
    pub amplitude: Option<f64>,
    /// Time at which the run came to rest, s.
    pub time_to_rest_s: Option<f64>,
    /// Time at which the run was stopped, s.
    pub end_time_s: Option<f64>,
}

impl RunResult {
    /// Returns whether the run failed.
    pub fn failed(&self) -> bool {
        self.label == Label::Failed
    }
}

/// The runs of a design at one point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// Number of cells of equal size from which the start states were drawn; `None` if the sampling is not stratified.
    pub cells: Option<u64>,
    /// The runs.
    pub runs: Vec<RunResult>,
}

impl Sample {
    /// Returns the number of failed runs.
    pub fn failed(&self) -> u64 {
        self.runs.iter().filter(|run| run.failed()).count() as u64
    }
}

/// An estimated response with its 95 % interval.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Estimate {
    /// The value; `None` if the runs do not determine it.
    pub value: Option<f64>,
    /// Standard error of the value.
    pub standard_error: Option<f64>,
    /// Lower end of the interval; `None` if it is unbounded.
    pub low: Option<f64>,
    /// Upper end of the interval; `None` if it is unbounded.
    pub high: Option<f64>,
    /// Why a value is missing.
    pub reason: Option<Cow<'static, str>>,
}

impl Estimate {
    /// Creates an estimate with its standard error and its interval.
    pub fn known(value: f64, standard_error: f64, [low, high]: [f64; 2]) -> Self {
        let [value, standard_error] = [value, standard_error].map(Some);
        Estimate { value, standard_error, low: Some(low), high: Some(high), reason: None }
    }

    /// Creates an estimate with its interval. If an end is unbounded, the standard error is omitted for the given
    /// reason.
    pub fn with_interval(
        value: f64,
        standard_error: Option<f64>,
        [low, high]: [Option<f64>; 2],
        unbounded: &'static str,
    ) -> Self {
        let both = low.zip(high).is_some();
        let standard_error = standard_error.filter(|_| both);
        let reason = standard_error.is_none().then_some(Cow::Borrowed(unbounded));
        Estimate { value: Some(value), standard_error, low, high, reason }
    }

    /// Creates an estimate without any values, for the given reason.
    pub fn unknown(reason: &'static str) -> Self {
        Estimate { reason: Some(Cow::Borrowed(reason)), ..Estimate::default() }
    }
}

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
