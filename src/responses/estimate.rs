//! What estimates are made from, and what they are.

use std::borrow::Cow;

use crate::classification::Label;

/// What one run has shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Its cell in a stratified design; zero in others.
    pub cell: u64,
    /// How it ended.
    pub label: Label,
    /// Its residual amplitude, m or over that without balls; none of a failed run.
    pub amplitude: Option<f64>,
    /// When it came to rest, s.
    pub time_to_rest_s: Option<f64>,
    /// When it was stopped, s.
    pub end_time_s: Option<f64>,
}

impl Seen {
    /// Whether it failed.
    pub fn failed(&self) -> bool {
        self.label == Label::Failed
    }
}

/// The runs of a design at one point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// Cells of equal size from which the start states were drawn; none where the sampling is not
    /// stratified.
    pub cells: Option<u64>,
    /// The runs.
    pub runs: Vec<Seen>,
}

impl Sample {
    /// How many runs failed.
    pub fn failed(&self) -> u64 {
        self.runs.iter().filter(|run| run.failed()).count() as u64
    }
}

/// A response: a value and how well it is known. All intervals are 95 %.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The value; none where the runs do not say it.
    pub value: Option<f64>,
    /// Its standard error.
    pub standard_error: Option<f64>,
    /// The lower end of its interval; none where it has no bound.
    pub low: Option<f64>,
    /// The upper end of its interval; none where it has no bound.
    pub high: Option<f64>,
    /// Why something of this is missing.
    pub reason: Option<Cow<'static, str>>,
}

impl Estimate {
    /// A value with its standard error, between the ends of its interval. Where an end has no bound there is
    /// no standard error either, for a reason.
    pub fn within(
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

    /// Nothing is known, for a reason.
    pub fn unknown(reason: &'static str) -> Self {
        Estimate { reason: Some(Cow::Borrowed(reason)), ..Estimate::default() }
    }
}
