//! The excess of mass of a smoothed density, by importance sampling.
//!
//! A polynomial of densities has the mass of the polynomial of the probabilities of rest. It may be negative somewhere, and where
//! a part of the mean takes its place, the density has an excess of mass. The excess is estimated at reference positions: rests of
//! the first parameter sets, which fill the prior, measured with the error of the measurements. Their own density, the proposal, is
//! the mean of the densities of these sets at rest. The whole mass is not estimated in this way: its error would shift all posteriors alike.

use super::density::Rests;
use super::sampler::{generator, normal};
use super::set_densities::SetDensities;
use super::site::{MeasuredRest, Site};
use super::smoother::positive;
use crate::study::Study;

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
