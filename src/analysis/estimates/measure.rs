//! The quantities that can be estimated from a sample of runs, and the contribution of each run to an estimate.

use super::amplitude::{mean, quantile, standard_deviation, worst};
use super::estimate::{Estimate, RunResult, Sample};
use super::probability::{above, at_rest_by, median_time_to_rest};

/// The estimated quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Mean amplitude.
    Mean,
    /// Standard deviation of the amplitude.
    StandardDeviation,
    /// Quantile of the amplitude, with the fraction of runs below it.
    Quantile(f64),
    /// Largest amplitude.
    Worst,
    /// Probability of an amplitude above this limit.
    Above(f64),
    /// Probability of rest by this time, s.
    AtRestBy(f64),
    /// Median time to rest.
    MedianTimeToRest,
}

impl Measure {
    /// Estimates the quantity from a sample.
    pub fn estimate(self, sample: &Sample) -> Estimate {
        match self {
            Measure::Mean => mean(sample),
            Measure::StandardDeviation => standard_deviation(sample),
            Measure::Quantile(fraction) => quantile(sample, fraction),
            Measure::Worst => worst(sample),
            Measure::Above(limit) => above(sample, limit),
            Measure::AtRestBy(time_s) => at_rest_by(sample, time_s),
            Measure::MedianTimeToRest => median_time_to_rest(sample),
        }
    }

    /// Returns what each run contributes to the estimate `value`; NaN for a run without a result. The correlation of the
    /// contributions is that of the estimates of two samples with the same start states.
    pub fn contributions(self, runs: &[RunResult], value: f64) -> Vec<f64> {
        let indicator = |holds: bool| f64::from(u8::from(holds));
        let amplitude = |run: &RunResult| run.amplitude.unwrap_or(f64::NAN);
        let above = |run: &RunResult, limit: f64| {
            run.amplitude.map_or(f64::NAN, |amplitude| indicator(amplitude > limit))
        };
        let rests = |run: &RunResult, by_s: f64| {
            indicator(run.time_to_rest_s.is_some_and(|time_s| time_s <= by_s))
        };
        let sound = || runs.iter().filter(|run| !run.failed()).filter_map(|run| run.amplitude);
        let mean = sound().sum::<f64>() / sound().count().max(1) as f64;
        let each = |run: &RunResult| match self {
            _ if run.failed() => f64::NAN,
            Measure::Mean => amplitude(run),
            Measure::StandardDeviation => (amplitude(run) - mean).powi(2),
            Measure::Quantile(_) => above(run, value),
            Measure::Above(limit) => above(run, limit),
            Measure::AtRestBy(time_s) => rests(run, time_s),
            Measure::MedianTimeToRest => rests(run, value),
            Measure::Worst => f64::NAN,
        };
        runs.iter().map(each).collect()
    }
}
