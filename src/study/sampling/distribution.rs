//! Distributions of uncertain parameters, sampled by inversion of their distribution functions.
//!
//! Inversion consumes exactly one uniform number per draw. Each draw therefore has a fixed place in
//! its random stream, and it changes smoothly with the parameters of the distribution.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::study::error::{Fault, describe_number};
use crate::study::file::uncertain_file::DistributionFile;

/// A validated distribution.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Distribution {
    Normal(Normal),
    TruncatedNormal {
        normal: Normal,
        min: f64,
        max: f64,
        below: f64,
        within: f64,
        mirrored: bool,
    },
    /// A log-normal distribution, as the normal distribution of the logarithm.
    Lognormal(Normal),
    Uniform {
        min: f64,
        max: f64,
    },
    Triangular {
        min: f64,
        mode: f64,
        max: f64,
    },
    /// Values and the cumulative fractions of their weights.
    Choice {
        values: Vec<f64>,
        fractions: Vec<f64>,
    },
}

/// The smallest fraction of a normal distribution that truncation may leave.
const MIN_TRUNCATED_FRACTION: f64 = 1.0e-12;

impl Distribution {
    /// Validates a distribution of a study file.
    pub fn resolve(written: &DistributionFile) -> Result<Distribution, (&'static str, Fault)> {
        match written {
            DistributionFile::Normal { mean, std_dev } => {
                Ok(Distribution::Normal(normal(*mean, *std_dev)?))
            }
            DistributionFile::TruncatedNormal { mean, std_dev, min, max } => {
                truncated(normal(*mean, *std_dev)?, *mean, *min, *max)
            }
            DistributionFile::Lognormal { mean, std_dev } => {
                positive("mean", *mean)?;
                positive("std_dev", *std_dev)?;
                let variance = (std_dev / mean).powi(2).ln_1p();
                let location = mean.ln() - 0.5 * variance;
                Ok(Distribution::Lognormal(normal(location, variance.sqrt())?))
            }
            DistributionFile::Uniform { min, max } => {
                ordered(*min, *max)?;
                Ok(Distribution::Uniform { min: *min, max: *max })
            }
            DistributionFile::Triangular { min, mode, max } => {
                ordered(*min, *max)?;
                if !(*min..=*max).contains(mode) {
                    let allowed = "a value from min to max";
                    return Err(("mode", fault("mode outside the range", *mode, allowed)));
                }
                Ok(Distribution::Triangular { min: *min, mode: *mode, max: *max })
            }
            DistributionFile::Choice { values, weights } => choice(values, weights.as_deref()),
            DistributionFile::Times(_) => {
                let allowed = "a distribution other than `times`";
                Err(("times", Fault::new("a factor of a factor", "times", allowed)))
            }
        }
    }

    /// Returns the quantile of a fraction, which is strictly between 0 and 1.
    pub fn quantile(&self, fraction: f64) -> f64 {
        match self {
            Distribution::Normal(normal) => normal.inverse_cdf(fraction),
            Distribution::TruncatedNormal { normal, min, max, below, within, mirrored } => {
                // In the upper tail, the distribution function is almost one; its mirror image
                // keeps all digits.
                let value = if *mirrored {
                    let centre = 2.0 * normal_mean(normal);
                    centre - normal.inverse_cdf((below + (1.0 - fraction) * within).clamp(0.0, 1.0))
                } else {
                    normal.inverse_cdf((below + fraction * within).clamp(0.0, 1.0))
                };
                value.clamp(*min, *max)
            }
            Distribution::Lognormal(normal) => normal.inverse_cdf(fraction).exp(),
            Distribution::Uniform { min, max } => (min + fraction * (max - min)).clamp(*min, *max),
            Distribution::Triangular { min, mode, max } => {
                let width = max - min;
                let rising = (mode - min) / width;
                let value = if fraction < rising {
                    min + width * (fraction * rising).sqrt()
                } else {
                    max - width * ((1.0 - fraction) * (1.0 - rising)).sqrt()
                };
                value.clamp(*min, *max)
            }
            Distribution::Choice { values, fractions } => {
                let index = fractions.partition_point(|cumulated| *cumulated <= fraction);
                values[index.min(values.len() - 1)]
            }
        }
    }

    /// Returns the bounds of the draws, by key, if the distribution is bounded. They must be valid
    /// values of the parameter.
    pub fn bounds(&self) -> Vec<(&'static str, f64)> {
        match self {
            Distribution::Normal(_) | Distribution::Lognormal(_) => Vec::new(),
            Distribution::TruncatedNormal { min, max, .. }
            | Distribution::Uniform { min, max }
            | Distribution::Triangular { min, max, .. } => vec![("min", *min), ("max", *max)],
            Distribution::Choice { values, .. } => {
                values.iter().map(|value| ("values", *value)).collect()
            }
        }
    }
}

type Checked<T> = Result<T, (&'static str, Fault)>;

fn fault(problem: &str, found: f64, allowed: &str) -> Fault {
    Fault::new(problem, describe_number(found), allowed)
}

fn positive(key: &'static str, number: f64) -> Checked<()> {
    if number.is_finite() && number > 0.0 {
        Ok(())
    } else {
        Err((key, fault("not positive", number, "a positive, finite number")))
    }
}

fn ordered(min: f64, max: f64) -> Checked<()> {
    if min >= max {
        let allowed = format!("a number above min, which is {}", describe_number(min));
        return Err(("max", fault("reversed or empty range", max, &allowed)));
    }
    if !(max - min).is_finite() {
        let found = format!("min {}, max {}", describe_number(min), describe_number(max));
        let allowed = "max - min of at most 1.79e308, the largest number";
        return Err(("max", Fault::new("too wide a range", found, allowed)));
    }
    Ok(())
}

fn normal(mean: f64, std_dev: f64) -> Checked<Normal> {
    positive("std_dev", std_dev)?;
    Normal::new(mean, std_dev).map_err(|error| {
        ("mean", Fault::new("not a distribution", describe_number(mean), error.to_string()))
    })
}

fn normal_mean(normal: &Normal) -> f64 {
    use statrs::statistics::Distribution as _;
    normal.mean().unwrap_or(0.0)
}

fn truncated(normal: Normal, mean: f64, min: f64, max: f64) -> Checked<Distribution> {
    ordered(min, max)?;
    let mirrored = min > mean;
    let (low, high) = if mirrored { (2.0 * mean - max, 2.0 * mean - min) } else { (min, max) };
    let below = normal.cdf(low);
    let within = normal.cdf(high) - below;
    if within < MIN_TRUNCATED_FRACTION {
        let allowed = "a range that holds at least 1e-12 of the normal distribution";
        return Err(("max", fault("almost nothing is left between min and max", max, allowed)));
    }
    Ok(Distribution::TruncatedNormal { normal, min, max, below, within, mirrored })
}

fn choice(values: &[f64], weights: Option<&[f64]>) -> Checked<Distribution> {
    if values.is_empty() {
        return Err(("values", Fault::new("nothing to choose from", "an empty list", "values")));
    }
    let equal = vec![1.0; values.len()];
    let weights = weights.unwrap_or(&equal);
    if weights.len() != values.len() {
        let found = format!("{} weights for {} values", weights.len(), values.len());
        return Err(("weights", Fault::new("unequal lengths", found, "one weight per value")));
    }
    if let Some(wrong) = weights.iter().find(|weight| !(weight.is_finite() && **weight >= 0.0)) {
        return Err(("weights", fault("not a weight", *wrong, "numbers, zero or more")));
    }
    let total: f64 = weights.iter().sum();
    if !(total.is_finite() && total > 0.0) {
        return Err(("weights", fault("weights without a sum", total, "a positive, finite sum")));
    }
    let mut sum = 0.0;
    let fractions = weights
        .iter()
        .map(|weight| {
            sum += weight;
            sum / total
        })
        .collect();
    // The last value with a positive weight takes what rounding leaves; trailing zero weights do
    // not.
    let last = weights.iter().rposition(|weight| *weight > 0.0).unwrap_or(0);
    Ok(Distribution::Choice { values: values[..=last].to_vec(), fractions })
}
