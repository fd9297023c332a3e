//! Mean, standard deviation, quantile and maximum of residual amplitudes, without failed runs.

use super::estimate::{Estimate, Sample};
use super::moments::{self, student_95};
use super::sample_quantile;

const NO_AMPLITUDE: &str = "no run has an amplitude";
const ONE_RUN: &str = "a single run has no standard error";
const NO_BOUND: &str = "too few runs for both ends of the interval";

fn amplitudes(sample: &Sample) -> Vec<(u64, f64)> {
    let runs = sample.runs.iter().filter(|run| !run.failed());
    runs.filter_map(|run| Some((run.cell, run.amplitude?))).collect()
}

fn ascending(sample: &Sample) -> Vec<f64> {
    let mut values: Vec<f64> = amplitudes(sample).into_iter().map(|(_, value)| value).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Estimates the mean with Student's interval; within cells if the sample is stratified (see `moments`).
pub fn mean(sample: &Sample) -> Estimate {
    let Some(mean) = moments::mean(&amplitudes(sample), sample.cells) else {
        return Estimate::unknown(NO_AMPLITUDE);
    };
    let Some(variance) = mean.variance else {
        return Estimate { value: Some(mean.value), ..Estimate::unknown(ONE_RUN) };
    };
    let error = variance.sqrt();
    let half = student_95(mean.degrees) * error;
    Estimate::known(mean.value, error, [mean.value - half, mean.value + half])
}

/// Estimates the standard deviation over the whole box of start states, not within cells.
///
/// The standard error follows from that of the mean of squared deviations, with the fourth moment of the sample instead
/// of that of a normal distribution. The interval is symmetric on a logarithmic scale (R. G. Miller, Beyond ANOVA,
/// Wiley 1986, section 7.1).
pub fn standard_deviation(sample: &Sample) -> Estimate {
    let values = amplitudes(sample);
    let Some(mean) = moments::mean(&values, sample.cells) else {
        return Estimate::unknown(NO_AMPLITUDE);
    };
    let Some(of_mean) = mean.variance else { return Estimate::unknown(ONE_RUN) };
    let squared = |value: f64| (value - mean.value) * (value - mean.value);
    let squares: Vec<(u64, f64)> =
        values.iter().map(|(cell, value)| (*cell, squared(*value))).collect();
    let Some((square, of_square)) =
        moments::mean(&squares, sample.cells).and_then(|square| Some((square, square.variance?)))
    else {
        return Estimate::unknown(ONE_RUN);
    };
    // Deviations from the sample mean are smaller than those from the population mean, by the mean's variance.
    let value = (square.value + of_mean).sqrt();
    if value <= 0.0 {
        return Estimate::known(0.0, 0.0, [0.0; 2]);
    }
    let error = of_square.sqrt() / (2.0 * value);
    let factor = libm::exp(student_95(square.degrees) * error / value);
    Estimate::known(value, error, [value / factor, value * factor])
}

/// Estimates a quantile, with an interval between order statistics and the bootstrap's standard error.
pub fn quantile(sample: &Sample, fraction: f64) -> Estimate {
    let values = ascending(sample);
    let Some(value) = sample_quantile::quantile(&values, fraction) else {
        return Estimate::unknown(NO_AMPLITUDE);
    };
    let error = sample_quantile::standard_error(sample_quantile::cumulative(&values), fraction);
    Estimate::with_interval(value, error, sample_quantile::interval(&values, fraction), NO_BOUND)
}

/// Returns the largest amplitude of all runs; further runs could exceed it by any amount.
pub fn worst(sample: &Sample) -> Estimate {
    match ascending(sample).last() {
        None => Estimate::unknown(NO_AMPLITUDE),
        Some(&value) => Estimate {
            value: Some(value),
            low: Some(value),
            ..Estimate::unknown("the largest of a sample bounds the worst from below only")
        },
    }
}
