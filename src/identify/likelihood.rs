//! The log-likelihood of all measured runs at any place of the prior.
//!
//! The density of each measured run is smoothed over the parameter sets, and the log-likelihood is the sum of the logarithms. A
//! density is at least that of one further run that rests anywhere, so that no measurement is impossible.

use super::references::References;
use super::set_densities::{REPLICATES, SetDensities, sums_of_rests};
use super::site::Site;
use super::smoother::{SetWeight, Smoother, positive, sums};

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
    /// The density of one run that rests anywhere, at each site.
    pub uniform: &'a [f64],
}

impl Likelihood<'_> {
    /// Returns the log-likelihood at a place for a replicate; 0 is the one with equal weights of all runs.
    pub fn at(&self, place: &[f64], replicate: usize) -> f64 {
        let weights = self.smoother.weights(place, None);
        (0..self.sites.len()).map(|site| self.at_site(site, &weights, replicate)).sum()
    }

    /// Returns the log-likelihood at a place and its standard error, which comes from the number of simulated runs.
    pub fn with_error(&self, place: &[f64]) -> [f64; 2] {
        let values: Vec<f64> =
            (1..=REPLICATES).map(|replicate| self.at(place, replicate)).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (count - 1.0);
        [self.at(place, 0), variance.sqrt()]
    }

    fn at_site(&self, index: usize, weights: &[SetWeight], replicate: usize) -> f64 {
        let (site, uniform) = (&self.sites[index], self.uniform[index]);
        let of = |one: &SetWeight| (*one, &self.densities[one.set][index]);
        let known: Vec<(SetWeight, &SetDensities)> =
            weights.iter().map(of).filter(|(_, densities)| densities.runs > 0).collect();
        let Some(runs) = known.iter().map(|(_, densities)| densities.runs).min() else {
            // Nothing is known here: all runs around it failed.
            return site.runs() as f64 * libm::log(SMALLEST);
        };
        let references = &self.references[index];
        let each = known.iter().map(|(weight, one)| (*weight, *one));
        let (rests, moving) = log_densities((runs, uniform), references, each, replicate);
        rests + site.moving as f64 * moving
    }
}

/// Returns the sum of the logarithms of the densities of measured positions, and the logarithm of the probability of motion.
/// `runs` is the number of simulated runs, and `uniform` the density of one run that rests anywhere.
pub(super) fn log_densities<'d>(
    (runs, uniform): (usize, f64),
    references: &References,
    each: impl Iterator<Item = (SetWeight, &'d SetDensities)> + Clone,
    replicate: usize,
) -> (f64, f64) {
    let least = 1.0 / (runs as f64 + 1.0);
    let of_moving = sums(each.clone().map(|(weight, one)| (weight, one.moving[replicate])));
    let moving = positive(of_moving).clamp(0.5 * least, 1.0 - 0.5 * least);
    let rests = sums_of_rests(each, replicate);
    // The mass of the density is the probability of rest.
    let mass = references.excess(&rests).map(|excess| 1.0 - of_moving[0] + excess);
    let factor = mass.filter(|mass| *mass > 0.0).map_or(1.0, |mass| (1.0 - moving) / mass);
    let log = |sums: &[f64; 2]| libm::log((factor * positive(*sums)).max(uniform * least));
    (rests.iter().take(references.measured()).map(log).sum(), libm::log(moving))
}

/// The density where nothing is known.
const SMALLEST: f64 = 1e-6;
