//! The widths of the regression over parameters: those that predict the rests of left-out parameter sets best.
//!
//! Parameter sets near the maximum of the likelihood are left out in turn. Some of their runs, measured with the error of the
//! measurements, are predicted from the other sets, and the values with the largest sum of logarithms of densities are chosen
//! (likelihood cross-validation; B. W. Silverman, *Density Estimation for Statistics and Data Analysis*, 1986, section 3.4.4).

use rayon::prelude::*;

use super::density::Rests;
use super::likelihood::log_densities;
use super::references::References;
use super::sampler::{generator, normal};
use super::set_densities::{SetDensities, sums_of_rests};
use super::site::{MeasuredRest, Site};
use super::smoother::{SetWeight, Smoother};
use crate::study::Study;

/// The widths that are compared, over the width of the prior.
const WIDTHS: [f64; 7] = [0.03, 0.05, 0.08, 0.12, 0.18, 0.27, 0.4];
/// The width with which the comparison begins.
const FIRST_WIDTH: f64 = 0.12;
/// The number of parameter sets that are left out.
const LEFT_OUT: usize = 24;
/// The number of rests of a left-out parameter set that are predicted at each site: many more than there are measurements, so
/// that the choice is better than these could see.
const PREDICTED: usize = 12;

/// Returns the widths with which the regression begins.
pub fn first_widths(dimensions: usize) -> Vec<f64> {
    vec![FIRST_WIDTH; dimensions]
}

/// Parameter sets with their simulated ends. The ends of some sets are predicted from those of the other sets.
pub struct CrossValidation<'a> {
    /// The sites.
    pub sites: &'a [Site],
    /// The ends for each parameter set, one entry per site.
    pub rests: &'a [Vec<Rests>],
    /// The places of the parameter sets.
    pub places: &'a [Vec<f64>],
    /// The left-out sets, and for each one a site per site whose rests are predicted.
    left_out: Vec<(usize, Vec<Site>)>,
}

impl<'a> CrossValidation<'a> {
    /// Leaves out the parameter sets with the largest log-likelihoods.
    pub fn new(
        study: &Study,
        sites: &'a [Site],
        rests: &'a [Vec<Rests>],
        places: &'a [Vec<f64>],
        likelihoods: &[f64],
    ) -> Self {
        let mut order: Vec<usize> = (0..places.len()).collect();
        order.sort_by(|left, right| likelihoods[*right].total_cmp(&likelihoods[*left]));
        order.truncate(LEFT_OUT);
        let mut random = generator(study, "identify widths", 0);
        let mut predicted = |set: usize, index: usize| {
            let site = &sites[index];
            let deviations: Vec<f64> = site.rests.iter().map(|rest| rest.std_dev_rad).collect();
            let simulated = &rests[set][index];
            let every = simulated.runs().div_ceil(PREDICTED).max(1);
            let positions = simulated.positions().step_by(every).enumerate();
            let measured = positions.filter(|_| !deviations.is_empty()).map(|(place, angles)| {
                let std_dev_rad = deviations[place % deviations.len()];
                let blurred = angles.iter().map(|angle| angle + std_dev_rad * normal(&mut random));
                MeasuredRest { angles: blurred.collect(), std_dev_rad }
            });
            let moving = simulated.moving.div_ceil(every) as u64;
            Site { rests: measured.collect(), moving, ..site.clone() }
        };
        let of_set = |set: usize| {
            (set, (0..sites.len()).map(|index| predicted(set, index)).collect::<Vec<Site>>())
        };
        let left_out = order.into_iter().map(of_set).collect();
        CrossValidation { sites, rests, places, left_out }
    }

    /// Returns the best widths of the regression. `references` are the densities of all positions at the sites, one entry per
    /// parameter set and site, and the references among them.
    pub fn widths(
        &self,
        of_references: &[Vec<SetDensities>],
        references: &[References],
    ) -> Vec<f64> {
        // The densities of the predicted rests for all parameter sets, per left-out set and site.
        let densities: Vec<Vec<Vec<SetDensities>>> = self
            .left_out
            .par_iter()
            .map(|(_, sites)| {
                let at = |index: usize| -> Vec<SetDensities> {
                    let of = |set: &Vec<Rests>| SetDensities::at_site(&sites[index], &set[index]);
                    self.rests.iter().map(of).collect()
                };
                (0..self.sites.len()).map(at).collect()
            })
            .collect();
        let score = |widths: &[f64]| -> f64 {
            let smoother = Smoother::new(self.places.to_vec(), widths.to_vec());
            let of_set =
                |((set, predicted), of_sites): (&(usize, Vec<Site>), &Vec<Vec<SetDensities>>)| {
                    let weights = smoother
                        .weights(&self.places[*set], |other| f64::from(u8::from(other != *set)));
                    let at = |(index, all): (usize, &Vec<SetDensities>)| {
                        let (site, references) = (&predicted[index], &references[index]);
                        let each = weights
                            .iter()
                            .map(|weight| (*weight, &of_references[weight.set][index]));
                        let excess = references.excess(&sums_of_rests(each));
                        let each = weights.iter().map(|weight| (*weight, &all[weight.set]));
                        self.log_density(index, site, each, excess)
                    };
                    of_sites.iter().enumerate().map(at).sum::<f64>()
                };
            self.left_out.iter().zip(&densities).map(of_set).sum()
        };
        let mut widths = first_widths(self.dimensions());
        for _ in 0..2 {
            for index in 0..widths.len() {
                let scored = WIDTHS.map(|candidate| {
                    let mut other = widths.clone();
                    other[index] = candidate;
                    (candidate, score(&other))
                });
                let best = scored.into_iter().max_by(|left, right| left.1.total_cmp(&right.1));
                widths[index] = best.map_or(FIRST_WIDTH, |(width, _)| width);
            }
        }
        widths
    }

    fn dimensions(&self) -> usize {
        self.places.first().map_or(0, Vec::len)
    }

    /// Returns the sum of the logarithms of the densities of predicted rests, and of the probabilities of predicted motions. The
    /// mass of the density is corrected if its excess is known.
    fn log_density<'d>(
        &self,
        index: usize,
        site: &Site,
        each: impl Iterator<Item = (SetWeight, &'d SetDensities)> + Clone,
        excess: Option<f64>,
    ) -> f64 {
        let runs = each.clone().map(|(_, densities)| densities.runs).min().unwrap_or(0);
        let uniform = self.rests.first().map_or(1.0, |of_set| of_set[index].uniform());
        let references = References::known(site.rests.len(), excess);
        let (rests, moving) = log_densities((runs, uniform), &references, each);
        rests + site.moving as f64 * moving
    }
}
