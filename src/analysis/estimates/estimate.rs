//! Samples of runs, and the estimates made from them.

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
