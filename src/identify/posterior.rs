//! The posterior of the parameters over the box of the prior, and further parameter sets where it is.
//!
//! An ensemble sampler draws from it. The densities carry the error of a finite number of simulated runs: the posterior is the
//! mean of the posteriors of several replicates, in which parameter sets have other weights.

use rayon::prelude::*;
use serde::Serialize;

use super::likelihood::{Likelihood, REPLICATES};
use super::sampler::{generator, sample_in_unit_cube};
use crate::study::{Identification, Study};

/// A parameter whose 95 % interval has more than this part of the width of the prior's is not identified.
const FLAT: f64 = 0.8;
/// A posterior leans on an end of its prior if its 95 % interval ends less than this part of its width before it, or within the
/// width of the regression, which has parameter sets on one side only there.
const NEAR: f64 = 0.5;

/// The posterior.
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    /// Samples: the values of the parameters in their units.
    pub samples: Vec<Vec<f64>>,
    /// One marginal distribution per parameter.
    pub marginals: Vec<Marginal>,
    /// The correlation of each pair of parameters.
    pub correlations: Vec<Vec<f64>>,
}

/// The posterior of one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Marginal {
    /// Name of the parameter.
    #[serde(rename = "parameter")]
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// The range of the prior.
    pub prior: [f64; 2],
    /// Mean of the samples.
    pub mean: f64,
    /// Standard deviation of the samples.
    pub std_dev: f64,
    /// Median of the samples.
    pub median: f64,
    /// Lower end of the 95 % interval, a quantile of the samples.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
    /// Width of the interval over that of the prior's, on the scale on which the prior is constant: 1 if the measurements say
    /// nothing.
    pub width_over_prior: f64,
    /// Whether the measurements determine the parameter.
    pub identified: bool,
    /// The standard deviation of the means of the replicates, over the standard deviation of the samples: the error that
    /// comes from the finite number of simulated runs, which the interval includes.
    pub simulation_error: f64,
    /// The end of the prior on which the posterior leans, `from` or `to`; `None` if both ends are near, because the posterior is
    /// then about as wide as the prior, or if none is.
    pub leans_on: Option<&'static str>,
    /// The width of the regression over the parameter, over that of the prior.
    pub regression_width: f64,
}

/// Returns the posterior.
pub fn posterior(
    study: &Study,
    identification: &Identification,
    likelihood: &Likelihood,
) -> Posterior {
    let dimensions = identification.parameters.len();
    let each = (identification.posterior_samples as usize).div_ceil(REPLICATES);
    let sample = |replicate: usize| {
        let mut random = generator(study, "identify posterior", replicate as u64);
        let density = |place: &[f64]| likelihood.at(place, replicate);
        sample_in_unit_cube(dimensions, each, density, &mut random)
    };
    let by_replicate: Vec<Vec<Vec<f64>>> = (1..=REPLICATES).into_par_iter().map(sample).collect();
    summary(identification, &likelihood.smoother.widths, &by_replicate)
}

fn summary(
    identification: &Identification,
    widths: &[f64],
    by_replicate: &[Vec<Vec<f64>>],
) -> Posterior {
    let places: Vec<&Vec<f64>> = by_replicate.iter().flatten().collect();
    let samples: Vec<Vec<f64>> =
        places.iter().map(|place| identification.values_at(place)).collect();
    let column =
        |index: usize| -> Vec<f64> { samples.iter().map(|sample| sample[index]).collect() };
    let marginal = |(index, parameter): (usize, &crate::study::Variable)| {
        let values = column(index);
        let (mean, std_dev) = mean_and_deviation(&values);
        let [low, median, high] = quantiles(values);
        let of_places: Vec<f64> = places.iter().map(|place| place[index]).collect();
        let (_, deviation) = mean_and_deviation(&of_places);
        let [first, _, last] = quantiles(of_places);
        let width_over_prior = (last - first) / 0.95;
        let near = widths[index].max(NEAR * (last - first));
        let leans_on = match [first < near, last > 1.0 - near] {
            [true, false] => Some("from"),
            [false, true] => Some("to"),
            _ => None,
        };
        let means = by_replicate.iter().map(|places| {
            places.iter().map(|place| place[index]).sum::<f64>() / places.len() as f64
        });
        let (_, of_means) = mean_and_deviation(&means.collect::<Vec<f64>>());
        Marginal {
            name: parameter.name().to_owned(),
            unit: parameter.unit().unwrap_or("1"),
            prior: parameter.range().unwrap_or([f64::NAN; 2]),
            mean,
            std_dev,
            median,
            low,
            high,
            width_over_prior,
            identified: width_over_prior <= FLAT,
            simulation_error: of_means / deviation,
            leans_on,
            regression_width: widths[index],
        }
    };
    let correlation = |first: usize, second: usize| {
        let (first, second) = (column(first), column(second));
        let [(first_mean, first_dev), (second_mean, second_dev)] =
            [&first, &second].map(|values| mean_and_deviation(values));
        let product = |(x, y): (&f64, &f64)| (x - first_mean) * (y - second_mean);
        let covariance = first.iter().zip(&second).map(product).sum::<f64>();
        covariance / (samples.len() as f64 * first_dev * second_dev)
    };
    let count = identification.parameters.len();
    let row = |index: usize| (0..count).map(|other| correlation(index, other)).collect();
    Posterior {
        correlations: (0..count).map(row).collect(),
        marginals: identification.parameters.iter().enumerate().map(marginal).collect(),
        samples,
    }
}

fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    (mean, variance.sqrt())
}

/// Returns the ends of the 95 % interval and the median between them.
fn quantiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.025, 0.5, 0.975].map(|fraction| {
        let place = fraction * (values.len() - 1) as f64;
        let (low, part) = (place.floor() as usize, place.fract());
        let high = (low + 1).min(values.len() - 1);
        values[low] + part * (values[high] - values[low])
    })
}

/// The number of places among which the next ones are chosen.
const CANDIDATES: usize = 512;

/// Returns `count` places in the unit cube for the next parameter sets.
pub(super) fn next_places(study: &Study, likelihood: &Likelihood, count: usize) -> Vec<Vec<f64>> {
    let places = &likelihood.smoother.places;
    let dimensions = places.first().map_or(0, Vec::len);
    let mut random = generator(study, "identify next", places.len() as u64);
    let density = |place: &[f64]| likelihood.at(place, 0);
    let candidates = sample_in_unit_cube(dimensions, CANDIDATES, density, &mut random);
    let width = |index: usize| {
        let of_candidates: Vec<f64> = candidates.iter().map(|place| place[index]).collect();
        mean_and_deviation(&of_candidates).1.max(1e-6)
    };
    let widths: Vec<f64> = (0..dimensions).map(width).collect();
    let mut all = places.to_vec();
    for _ in 0..count {
        let distance = |place: &Vec<f64>| {
            let square = |other: &Vec<f64>| -> f64 {
                let parts = place.iter().zip(other).zip(&widths);
                parts.map(|((x, y), width)| ((x - y) / width).powi(2)).sum()
            };
            all.iter().map(square).fold(f64::INFINITY, f64::min)
        };
        let scored = candidates.iter().map(|place| (distance(place), place));
        let farthest = scored.max_by(|left, right| left.0.total_cmp(&right.0));
        let Some((_, farthest)) = farthest else { break };
        all.push(farthest.clone());
    }
    all.split_off(places.len())
}
