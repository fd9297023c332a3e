//! The log-likelihood of all measured runs at any place of the prior.
//!
//! The density of each measured run is smoothed over the parameter sets, and the log-likelihood is the sum of the logarithms. A
//! density is at least that of one further run that rests anywhere, so that no measurement is impossible.
//!
//! Replicates of the parameter sets show the error of the likelihood that comes from a finite number of simulated runs. A
//! replicate gives each parameter set an exponentially distributed weight instead of an equal one (the Bayesian bootstrap,
//! D. B. Rubin 1981, doi:10.1214/aos/1176345338). Runs of different sets are independent. The scatter of the replicates thus
//! contains the error of the runs of each set, and the deviation of the sets from the regression over them.
//!
//! The excess of mass of a smoothed density is found by importance sampling. A polynomial of densities has the mass of the
//! polynomial of the probabilities of rest. It may be negative somewhere, and where a part of the mean takes its place, the
//! density has an excess of mass. The excess is estimated at reference positions: rests of the first parameter sets, which fill
//! the prior, measured with the error of the measurements. Their own density, the proposal, is the mean of the densities of
//! these sets at rest. The whole mass is not estimated in this way: its error would shift all posteriors alike.

use rand::RngExt;
use rand_distr::Exp1;

use super::density::Rests;
use super::sampler::{generator, normal};
use super::set_densities::{SetDensities, sums_of_rests};
use super::site::{MeasuredRest, Site};
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
pub struct Likelihood {
    /// The sites with the measured runs; positions of reference follow the measured ones, once there are some.
    pub sites: Vec<Site>,
    /// The references at each site, which give the mass of the density.
    pub references: Vec<References>,
    /// The densities for each parameter set, one entry per site.
    pub densities: Vec<Vec<SetDensities>>,
    /// The regression over the parameter sets.
    pub smoother: Smoother,
    /// The own weights of the parameter sets in each replicate.
    pub set_weights: Vec<Replicated>,
    /// The density of one run that rests anywhere.
    pub uniform: f64,
}

impl Likelihood {
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
        let site = &self.sites[index];
        let of = |weight: &SetWeight| (*weight, &self.densities[weight.set][index]);
        let known: Vec<(SetWeight, &SetDensities)> =
            weights.iter().map(of).filter(|(_, densities)| densities.runs > 0).collect();
        if known.is_empty() {
            // Nothing is known here: all runs around it failed.
            return site.runs() as f64 * libm::log(SMALLEST);
        }
        log_likelihood(site, &self.references[index], self.uniform, known.iter().copied())
    }
}

/// Returns the sum of the logarithms of the densities of rests at a site, and of the probabilities of motions. The mass of the
/// density is corrected if its excess is known. `uniform` is the density of one run that rests anywhere.
pub(super) fn log_likelihood<'d>(
    site: &Site,
    references: &References,
    uniform: f64,
    each: impl Iterator<Item = (SetWeight, &'d SetDensities)> + Clone,
) -> f64 {
    let runs = each.clone().map(|(_, densities)| densities.runs).min().unwrap_or(0);
    let least = 1.0 / (runs as f64 + 1.0);
    let of_moving = sums(each.clone().map(|(weight, densities)| (weight, densities.moving)));
    let moving = positive(of_moving).clamp(0.5 * least, 1.0 - 0.5 * least);
    let rests = sums_of_rests(each);
    // The mass of the density is the probability of rest.
    let mass = references.excess(&rests).map(|excess| 1.0 - of_moving[0] + excess);
    let factor = mass.filter(|mass| *mass > 0.0).map_or(1.0, |mass| (1.0 - moving) / mass);
    let log = |sums: &[f64; 2]| libm::log((factor * positive(*sums)).max(uniform * least));
    let rests: f64 = rests.iter().take(references.measured).map(log).sum();
    rests + site.moving as f64 * libm::log(moving)
}

/// The density where nothing is known.
const SMALLEST: f64 = 1e-6;

/// The number of reference positions at a site.
const REFERENCES: usize = 128;

/// The reference positions at a site.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct References {
    /// The number of measured positions, which come before the reference positions.
    pub measured: usize,
    /// The density of each reference position in the proposal.
    proposal: Vec<f64>,
    /// The excess of mass, if it is known from other references.
    known: Option<f64>,
}

/// Returns a site with reference positions after the measured ones; `rests` are the simulated ends of the parameter sets there.
pub fn with_references(study: &Study, index: usize, site: &Site, rests: &[&Rests]) -> Site {
    let deviations: Vec<f64> = site.rests.iter().map(|rest| rest.std_dev_rad).collect();
    let known: Vec<&&Rests> = rests.iter().filter(|set| set.at_rest() > 0).collect();
    let mut site = site.clone();
    if known.is_empty() || deviations.is_empty() {
        return site;
    }
    let mut random = generator(study, "identify references", index as u64);
    for number in 0..REFERENCES {
        let set = known[number % known.len()];
        let positions = set.at_rest();
        // A step that has no common factor with most numbers of runs spreads the references over them.
        let Some(angles) = set.run((number * 7919 / known.len()) % positions) else { continue };
        let std_dev_rad = deviations[number % deviations.len()];
        let blurred = angles.iter().map(|angle| angle + std_dev_rad * normal(&mut random));
        site.rests.push(MeasuredRest { angles: blurred.collect(), std_dev_rad });
    }
    site
}

impl References {
    /// Returns the references of a site with `measured` measured positions, from the densities of all its positions for all
    /// parameter sets.
    pub fn new(measured: usize, densities: &[&SetDensities]) -> Self {
        let at_rest: Vec<(&&SetDensities, f64)> = densities
            .iter()
            .map(|set| (set, 1.0 - set.moving))
            .filter(|(set, rest)| set.runs > 0 && *rest > 0.0)
            .take(REFERENCES)
            .collect();
        let rows = densities.first().map_or(0, |set| set.rests.len());
        let density = |row: usize| -> f64 {
            let sum: f64 = at_rest.iter().map(|(set, rest)| set.rests[row] / rest).sum();
            sum / at_rest.len() as f64
        };
        let proposal = (measured..rows).map(density).collect();
        References { measured, proposal, known: None }
    }

    /// Returns no references for this many measured positions, but the excess of mass if it is known.
    pub fn known(measured: usize, excess: Option<f64>) -> Self {
        References { measured, proposal: Vec::new(), known: excess }
    }

    /// Returns the excess of mass of a smoothed density over that of the regression, from the sums of regression and mean at all
    /// positions; `None` if it is not known.
    pub fn excess(&self, sums: &[[f64; 2]]) -> Option<f64> {
        if self.proposal.is_empty() {
            return self.known;
        }
        let references = sums.get(self.measured..).unwrap_or_default();
        let each = references.iter().zip(&self.proposal);
        let excess = each.map(|(sums, proposal)| (positive(*sums) - sums[0]) / proposal);
        Some(excess.sum::<f64>() / self.proposal.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Likelihood, MeasuredRest, References, SetDensities, Site, Smoother, set_weights};
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
        let rests = vec![MeasuredRest { angles: vec![1.0], std_dev_rad: 0.1 }];
        let likelihood = Likelihood {
            sites: vec![Site { point_id: 0, stage: 1, rests, moving: 0 }],
            references: vec![References::known(1, None)],
            densities,
            smoother: Smoother::new(places, vec![0.05]),
            set_weights: sets.map(|set| set_weights(&study, set.into())).collect(),
            uniform: 0.1,
        };
        let [mut variance, mut expected] = [0.0; 2];
        for place in [[0.1], [0.3], [0.5], [0.7], [0.9]] {
            variance += likelihood.with_error(&place)[1].powi(2);
            let weights = likelihood.smoother.weights(&place, |_| 1.0);
            expected += weights.iter().map(|weight| (0.3 * weight.regression).powi(2)).sum::<f64>();
        }
        let ratio = variance / expected;
        assert!((0.4..2.5).contains(&ratio), "{ratio}");
    }
}
