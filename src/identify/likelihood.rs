//! The log-likelihood of all measured runs at any place of the prior.
//!
//! The density of each measured run is smoothed over the parameter sets, and the log-likelihood is the sum of the logarithms. A
//! density is at least that of one further run that rests anywhere, so that no measurement is impossible.
//!
//! Replicates of the parameter sets show the error of the likelihood that comes from a finite number of simulated runs. A
//! replicate gives each parameter set an exponentially distributed weight instead of an equal one (the Bayesian bootstrap,
//! D. B. Rubin 1981, doi:10.1214/aos/1176345338). Runs of different sets are independent. The scatter of the replicates thus
//! contains the error of the runs of each set, and the deviation of the sets from the regression over them.

use rand::RngExt;
use rand_distr::Exp1;

use super::references::References;
use super::sampler::generator;
use super::set_densities::{SetDensities, sums_of_rests};
use super::site::Site;
use super::smoother::{SetWeight, Smoother, positive, sums};
use crate::study::Study;

/// The number of replicates.
pub const REPLICATES: usize = 8;

/// The weight 1, and the weight in each replicate.
pub type Replicated = [f64; REPLICATES + 1];

/// Returns the weights of a parameter set.
pub fn set_weights(study: &Study, set: usize) -> Replicated {
    let mut random = generator(study, "identify weights", set as u64);
    std::array::from_fn(|replicate| if replicate == 0 { 1.0 } else { random.sample(Exp1) })
}

/// The log-likelihood as a function of the place.
pub struct Likelihood<'a> {
    /// The sites with the measured runs; positions of reference follow the measured ones.
    pub sites: &'a [Site],
    /// The references at each site, which give the mass of the density.
    pub references: &'a [References],
    /// The densities for each parameter set, one entry per site.
    pub densities: &'a [Vec<SetDensities>],
    /// The regression over the parameter sets.
    pub smoother: &'a Smoother,
    /// The own weights of the parameter sets in each replicate.
    pub set_weights: &'a [Replicated],
    /// The density of one run that rests anywhere, at each site.
    pub uniform: &'a [f64],
}

impl Likelihood<'_> {
    /// Returns the log-likelihood at a place for a replicate; 0 is the one with equal weights of all parameter sets.
    pub fn at(&self, place: &[f64], replicate: usize) -> f64 {
        let weights = self.smoother.weights(place, |set| self.set_weights[set][replicate]);
        (0..self.sites.len()).map(|site| self.at_site(site, &weights)).sum()
    }

    /// Returns the log-likelihood at a place and its standard error, which comes from the number of simulated runs.
    pub fn with_error(&self, place: &[f64]) -> [f64; 2] {
        let values: Vec<f64> =
            (1..=REPLICATES).map(|replicate| self.at(place, replicate)).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
        [self.at(place, 0), variance.sqrt()]
    }

    fn at_site(&self, index: usize, weights: &[SetWeight]) -> f64 {
        let (site, uniform) = (&self.sites[index], self.uniform[index]);
        let of = |weight: &SetWeight| (*weight, &self.densities[weight.set][index]);
        let known: Vec<(SetWeight, &SetDensities)> =
            weights.iter().map(of).filter(|(_, densities)| densities.runs > 0).collect();
        let Some(runs) = known.iter().map(|(_, densities)| densities.runs).min() else {
            // Nothing is known here: all runs around it failed.
            return site.runs() as f64 * libm::log(SMALLEST);
        };
        let references = &self.references[index];
        let each = known.iter().map(|(weight, densities)| (*weight, *densities));
        let (rests, moving) = log_densities((runs, uniform), references, each);
        rests + site.moving as f64 * moving
    }
}

/// Returns the sum of the logarithms of the densities of measured positions, and the logarithm of the probability of motion.
/// `runs` is the number of simulated runs, and `uniform` the density of one run that rests anywhere.
pub(super) fn log_densities<'d>(
    (runs, uniform): (usize, f64),
    references: &References,
    each: impl Iterator<Item = (SetWeight, &'d SetDensities)> + Clone,
) -> (f64, f64) {
    let least = 1.0 / (runs as f64 + 1.0);
    let of_moving = sums(each.clone().map(|(weight, densities)| (weight, densities.moving)));
    let moving = positive(of_moving).clamp(0.5 * least, 1.0 - 0.5 * least);
    let rests = sums_of_rests(each);
    // The mass of the density is the probability of rest.
    let mass = references.excess(&rests).map(|excess| 1.0 - of_moving[0] + excess);
    let factor = mass.filter(|mass| *mass > 0.0).map_or(1.0, |mass| (1.0 - moving) / mass);
    let log = |sums: &[f64; 2]| libm::log((factor * positive(*sums)).max(uniform * least));
    (rests.iter().take(references.measured).map(log).sum(), libm::log(moving))
}

/// The density where nothing is known.
const SMALLEST: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::Likelihood;
    use crate::identify::{MeasuredRest, References, SetDensities, Site, Smoother, set_weights};
    use crate::study::Study;

    /// The standard error of the log-likelihood contains what separates the parameter sets from the regression over them. The
    /// expected variance is that of a linear estimator, from the squares of the residuals (White 1980, doi:10.2307/1912934).
    #[test]
    fn scatter_between_parameter_sets_is_an_error() {
        let text = "schema: 1\nname: a\nseed: 1\nmodel: {kind: ball_balancer}\ninitial_conditions: {design: \
                    {monte_carlo: {samples: 1}}}\n";
        let study = Study::parse(Path::new("a.yaml"), text.to_owned()).expect("a study");
        let sets = 0..80_u8;
        let density = |set: u8| 1.0 + if set.is_multiple_of(2) { 0.3 } else { -0.3 };
        let densities: Vec<Vec<SetDensities>> = sets
            .clone()
            .map(|set| vec![SetDensities { runs: 1000, rests: vec![density(set)], moving: 0.0 }])
            .collect();
        let places = sets.clone().map(|set| vec![f64::from(set) / 79.0]).collect();
        let smoother = Smoother::new(places, vec![0.05]);
        let rests = vec![MeasuredRest { angles: vec![1.0], std_dev_rad: 0.1 }];
        let likelihood = Likelihood {
            sites: &[Site { point_id: 0, stage: 1, rests, moving: 0 }],
            references: &[References::known(1, None)],
            densities: &densities,
            smoother: &smoother,
            set_weights: &sets.map(|set| set_weights(&study, set.into())).collect::<Vec<_>>(),
            uniform: &[0.1],
        };
        let [mut variance, mut expected] = [0.0; 2];
        for place in [[0.1], [0.3], [0.5], [0.7], [0.9]] {
            variance += likelihood.with_error(&place)[1].powi(2);
            let weights = smoother.weights(&place, |_| 1.0);
            expected += weights.iter().map(|weight| (0.3 * weight.regression).powi(2)).sum::<f64>();
        }
        let ratio = variance / expected;
        assert!((0.4..2.5).contains(&ratio), "{ratio}");
    }
}
