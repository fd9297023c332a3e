//! The posterior of the parameters over the box of the prior.
//!
//! A surrogate (a Gaussian process) approximates the log-likelihood between the parameter sets. Far below its maximum, the
//! log-likelihood is compressed, so that the surrogate is accurate where the posterior is. The log-likelihoods carry the error of
//! a finite number of simulated runs: the posterior is the mean of the posteriors for several sets of values that differ from the
//! computed ones by as much, each with a surrogate of its own.

use super::likelihood::LogLikelihood;
use super::sampler::{generator, normal, sample_in_unit_cube};
use crate::optimize::Surrogate;
use crate::study::{Identification, Study, Values};

/// The number of surrogates over which the posterior is averaged.
const SURROGATES: u64 = 8;
/// Values further below the maximum than this, and this much more per parameter, are compressed.
const EXACT: [f64; 2] = [15.0, 5.0];
/// A parameter whose 95 % interval has more than this part of the width of the prior's is not identified.
const FLAT: f64 = 0.8;

/// The posterior.
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    /// Samples: the values of the parameters in their units.
    pub samples: Vec<Vec<f64>>,
    /// One marginal distribution per parameter.
    pub marginals: Vec<Marginal>,
    /// The correlation of each pair of parameters.
    pub correlations: Vec<Vec<f64>>,
    /// The standard deviation of the posterior means of the surrogates, over the standard deviation of the posterior, per
    /// parameter: the error that comes from the finite number of simulated runs.
    pub simulation_error: Vec<f64>,
}

/// The posterior of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Marginal {
    /// Name of the parameter.
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
    /// The 95 % interval between quantiles of the samples.
    pub interval: [f64; 2],
    /// Width of the interval over that of the prior: 1 if the measurements say nothing.
    pub width_over_prior: f64,
}

impl Marginal {
    /// Returns whether the measurements determine the parameter.
    pub fn is_identified(&self) -> bool {
        self.width_over_prior <= FLAT
    }
}

/// Returns the values for a surrogate: `values`, compressed far below `highest`.
pub(super) fn compressed(values: &[f64], highest: f64, parameters: usize) -> Vec<f64> {
    let exact = EXACT[0] + EXACT[1] * parameters as f64;
    let one = |value: &f64| match highest - value {
        below if below <= exact => *value,
        below => highest - exact * (1.0 + libm::log(below / exact)),
    };
    values.iter().map(one).collect()
}

/// Returns a value of each log-likelihood; a parameter set whose runs all failed gets the smallest one.
fn known(likelihoods: &[LogLikelihood], value: impl FnMut(&LogLikelihood) -> f64) -> Vec<f64> {
    let values: Vec<f64> = likelihoods.iter().map(value).collect();
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let smallest = finite.fold(f64::INFINITY, f64::min);
    values.into_iter().map(|value| if value.is_finite() { value } else { smallest }).collect()
}

/// Returns the surrogate of the log-likelihoods of parameter sets at these coordinates in the unit cube.
///
/// # Errors
/// Returns the reason if there is no surrogate, for example because no likelihood is known.
pub(super) fn surrogate(
    coordinates: &[Vec<f64>],
    likelihoods: &[LogLikelihood],
    seed: u64,
) -> Result<(Surrogate, f64), String> {
    let values = known(likelihoods, |one| one.value);
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let dimensions = coordinates.first().map_or(0, Vec::len);
    let exact = EXACT[0] + EXACT[1] * dimensions as f64;
    let near: Vec<f64> = likelihoods
        .iter()
        .filter(|one| highest - one.value <= exact)
        .map(|one| one.variance)
        .collect();
    let noise = near.iter().sum::<f64>() / near.len().max(1) as f64;
    let shown = compressed(&values, highest, dimensions);
    Ok((Surrogate::fit(coordinates, &shown, noise, seed)?, highest))
}

/// Returns the posterior for parameter sets at these coordinates in the unit cube.
///
/// # Errors
/// Returns the reason if there is no surrogate.
pub fn posterior(
    study: &Study,
    identification: &Identification,
    coordinates: &[Vec<f64>],
    likelihoods: &[LogLikelihood],
) -> Result<Posterior, String> {
    let seed = study.derived_seed("identify surrogate", 0);
    let (first, highest) = surrogate(coordinates, likelihoods, seed)?;
    let dimensions = identification.parameters.len();
    let each = (identification.posterior_samples as usize).div_ceil(SURROGATES as usize);
    let mut by_surrogate = Vec::new();
    for number in 0..SURROGATES {
        let mut random = generator(study, "identify posterior", number);
        let moved = |one: &LogLikelihood| one.value + one.variance.sqrt() * normal(&mut random);
        let moved = known(likelihoods, moved);
        let moved = compressed(&moved, highest, dimensions);
        let own = first.with_values(coordinates, &moved)?;
        let density = |place: &[f64]| predicted(&own, place);
        by_surrogate.push(sample_in_unit_cube(dimensions, each, density, &mut random));
    }
    Ok(summary(identification, &by_surrogate))
}

/// Returns the surrogate's log-likelihood at a place in the unit cube.
pub(super) fn predicted(surrogate: &Surrogate, place: &[f64]) -> f64 {
    let values = surrogate.predict(&[place.to_vec()]);
    values.ok().and_then(|values| values.first().copied()).unwrap_or(f64::NEG_INFINITY)
}

/// Returns the number at a place in the range of each parameter.
pub(super) fn in_units(identification: &Identification, place: &[f64]) -> Vec<f64> {
    let number = |(parameter, place): (&crate::study::Variable, &f64)| match parameter.values() {
        Values::Numbers(from, to) => from + place * (to - from),
        // Only numbers can be identified.
        Values::Whole(..) | Values::Choices(_) => f64::NAN,
    };
    identification.parameters.iter().zip(place).map(number).collect()
}

fn summary(identification: &Identification, by_surrogate: &[Vec<Vec<f64>>]) -> Posterior {
    let samples: Vec<Vec<f64>> =
        by_surrogate.iter().flatten().map(|place| in_units(identification, place)).collect();
    let column = |index: usize| -> Vec<f64> { samples.iter().map(|one| one[index]).collect() };
    let mut marginals = Vec::new();
    let mut simulation_error = Vec::new();
    for (index, parameter) in identification.parameters.iter().enumerate() {
        let mut sorted = column(index);
        let (mean, std_dev) = mean_and_deviation(&sorted);
        sorted.sort_by(f64::total_cmp);
        let quantile = |fraction: f64| {
            let place = fraction * (sorted.len() - 1) as f64;
            let (low, part) = (place.floor() as usize, place.fract());
            let high = (low + 1).min(sorted.len() - 1);
            sorted[low] + part * (sorted[high] - sorted[low])
        };
        let interval = [quantile(0.025), quantile(0.975)];
        let prior = parameter.range().unwrap_or([f64::NAN; 2]);
        marginals.push(Marginal {
            name: parameter.name().to_owned(),
            unit: parameter.unit().unwrap_or("1"),
            prior,
            mean,
            std_dev,
            median: quantile(0.5),
            interval,
            width_over_prior: (interval[1] - interval[0]) / (0.95 * (prior[1] - prior[0])),
        });
        let means: Vec<f64> = by_surrogate
            .iter()
            .map(|places| {
                places.iter().map(|place| place[index]).sum::<f64>() / places.len() as f64
            })
            .collect();
        let unit = std_dev / (prior[1] - prior[0]);
        simulation_error.push(mean_and_deviation(&means).1 / unit);
    }
    let correlation = |one: usize, other: usize| {
        let (one_column, other_column) = (column(one), column(other));
        let [(one_mean, one_dev), (other_mean, other_dev)] =
            [&one_column, &other_column].map(|values| mean_and_deviation(values));
        let product = |(x, y): (&f64, &f64)| (x - one_mean) * (y - other_mean);
        let covariance = one_column.iter().zip(&other_column).map(product).sum::<f64>();
        covariance / (samples.len() as f64 * one_dev * other_dev)
    };
    let indices = 0..identification.parameters.len();
    let correlations =
        indices.clone().map(|one| indices.clone().map(|other| correlation(one, other)).collect());
    Posterior { correlations: correlations.collect(), samples, marginals, simulation_error }
}

fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / count;
    (mean, variance.sqrt())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{compressed, posterior};
    use crate::identify::LogLikelihood;
    use crate::study::Study;

    fn study(parameters: &str) -> Study {
        let text = format!(
            "schema: 1\nname: one\nseed: 7\nmodel: {{kind: ball_balancer}}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 2}}}}}}\n\
             identify: {{parameters: {parameters}}}\n"
        );
        Study::parse(Path::new("a.yaml"), text).expect("a valid study")
    }

    /// A grid of places in the unit square.
    fn grid(side: usize) -> Vec<Vec<f64>> {
        let place = |index: usize| (index as f64 + 0.5) / side as f64;
        (0..side * side).map(|index| vec![place(index / side), place(index % side)]).collect()
    }

    #[test]
    fn compression_keeps_values_near_the_maximum_and_their_order() {
        let values = [0.0, -5.0, -20.0, -21.0, -100.0, -1e6];
        let shown = compressed(&values, 0.0, 1);
        assert_eq!(shown[..3], values[..3]);
        assert!(shown.windows(2).all(|two| two[0] > two[1]), "{shown:?}");
        assert!(shown[5] > -300.0);
    }

    /// The posterior of a likelihood that is a correlated normal density has its moments: mean, deviation, interval and
    /// correlation. The tolerances are four standard errors of some 400 independent samples.
    #[test]
    fn the_posterior_of_a_normal_likelihood() {
        let study = study(
            "{friction_coefficient: {from: 0.001, to: 0.003}, damping_n_s_m: {from: 1, to: 2}}",
        );
        let (_, identification) = study.for_identification().expect("identify");
        let (deviation, correlation) = (0.08, 0.6);
        let coordinates = grid(11);
        let likelihood = |place: &Vec<f64>| {
            let [x, y] = [place[0] - 0.45, place[1] - 0.55].map(|one| one / deviation);
            let square =
                (x * x - 2.0 * correlation * x * y + y * y) / (1.0 - correlation * correlation);
            LogLikelihood { value: -300.0 - 0.5 * square, variance: 1e-6 }
        };
        let likelihoods: Vec<LogLikelihood> = coordinates.iter().map(likelihood).collect();
        let found =
            posterior(&study, &identification, &coordinates, &likelihoods).expect("a posterior");
        let [friction, damping] = [&found.marginals[0], &found.marginals[1]];
        let error = 4.0 / 20.0;
        assert!((friction.mean - 0.0019).abs() < error * 0.002 * deviation, "{friction:?}");
        assert!((damping.mean - 1.55).abs() < error * deviation, "{damping:?}");
        assert!(
            (damping.std_dev / deviation - 1.0).abs() < error / 2.0_f64.sqrt() + 0.05,
            "{damping:?}"
        );
        assert!((found.correlations[0][1] - correlation).abs() < error, "{:?}", found.correlations);
        assert!((found.correlations[1][1] - 1.0).abs() < 1e-12);
        assert!(friction.is_identified() && (friction.width_over_prior - 0.33).abs() < 0.06);
        assert!(
            found.simulation_error.iter().all(|error| *error < 0.4),
            "{:?}",
            found.simulation_error
        );
    }

    /// A likelihood that does not depend on a parameter leaves the prior, and the parameter is not identified. An error of the
    /// likelihoods makes the posterior wider.
    #[test]
    fn flat_parameters_and_noisy_likelihoods() {
        let study = study(
            "{friction_coefficient: {from: 0.001, to: 0.003}, damping_n_s_m: {from: 1, to: 2}}",
        );
        let (_, identification) = study.for_identification().expect("identify");
        let coordinates = grid(9);
        let of = |variance: f64| {
            let likelihood = |place: &Vec<f64>| LogLikelihood {
                value: -0.5 * ((place[0] - 0.5) / 0.1).powi(2),
                variance,
            };
            let likelihoods: Vec<LogLikelihood> = coordinates.iter().map(likelihood).collect();
            posterior(&study, &identification, &coordinates, &likelihoods).expect("a posterior")
        };
        let exact = of(1e-6);
        assert!(exact.marginals[0].is_identified() && !exact.marginals[1].is_identified());
        assert!(
            (exact.marginals[1].width_over_prior - 1.0).abs() < 0.06,
            "{:?}",
            exact.marginals[1]
        );
        let noisy = of(4.0);
        assert!(
            noisy.simulation_error[0] > 2.0 * exact.simulation_error[0],
            "{:?} {:?}",
            noisy.simulation_error,
            exact.simulation_error
        );
    }
}
