//! The widths of the regression over parameters: those that predict the rests of left-out parameter sets best.
//!
//! Parameter sets near the maximum of the likelihood are left out in turn. Some of their runs, measured with the error of the
//! measurements, are predicted from the other sets, and the values with the largest sum of logarithms of densities are chosen
//! (likelihood cross-validation; B. W. Silverman, *Density Estimation for Statistics and Data Analysis*, 1986, section 3.4.4).

use rayon::prelude::*;

use super::density::Rests;
use super::likelihood::{Likelihood, References, log_likelihood};
use super::sampler::{generator, normal};
use super::set_densities::{SetDensities, sums_of_rests};
use super::site::{MeasuredRest, Site};
use super::smoother::Smoother;
use crate::study::Study;

/// The widths that are compared, over the width of the prior.
const WIDTHS: [f64; 7] = [0.03, 0.05, 0.08, 0.12, 0.18, 0.27, 0.4];
/// The width with which the comparison begins.
pub const FIRST_WIDTH: f64 = 0.12;
/// The number of parameter sets that are left out.
const LEFT_OUT: usize = 24;
/// The number of rests of a left-out parameter set that are predicted at each site: many more than there are measurements, so
/// that the choice is better than these could see.
const PREDICTED: usize = 12;

/// The number of a left-out parameter set, and for each site a site with the rests that are predicted.
type LeftOut = (usize, Vec<Site>);

/// Leaves out the parameter sets with the largest log-likelihoods; `rests` are the ends for each set, one entry per site.
pub fn leave_out(
    study: &Study,
    sites: &[Site],
    rests: &[Vec<Rests>],
    likelihoods: &[f64],
) -> Vec<LeftOut> {
    let mut order: Vec<usize> = (0..likelihoods.len()).collect();
    order.sort_by(|left, right| likelihoods[*right].total_cmp(&likelihoods[*left]));
    order.truncate(LEFT_OUT);
    let mut random = generator(study, "identify widths", 0);
    let mut predicted = |(site, simulated): (&Site, &Rests)| {
        let deviations: Vec<f64> = site.rests.iter().map(|rest| rest.std_dev_rad).collect();
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
    order
        .into_iter()
        .map(|set| (set, sites.iter().zip(&rests[set]).map(&mut predicted).collect()))
        .collect()
}

/// Returns the best widths of the regression of a likelihood with references.
pub fn best_widths(
    likelihood: &Likelihood,
    rests: &[Vec<Rests>],
    left_out: &[LeftOut],
) -> Vec<f64> {
    let Likelihood { smoother: Smoother { places, widths }, references, uniform, .. } = likelihood;
    // The densities of the predicted rests for all parameter sets, per left-out set and site.
    let at_site = |(index, site): (usize, &Site)| -> Vec<SetDensities> {
        rests.iter().map(|set| SetDensities::at_site(site, &set[index])).collect()
    };
    let densities: Vec<Vec<Vec<SetDensities>>> = left_out
        .par_iter()
        .map(|(_, predicted)| predicted.iter().enumerate().map(at_site).collect())
        .collect();
    let score = |widths: &[f64]| -> f64 {
        let smoother = Smoother::new(places.clone(), widths.to_vec());
        let of_set = |((set, predicted), of_sites): (&LeftOut, &Vec<Vec<SetDensities>>)| {
            let weights =
                smoother.weights(&places[*set], |other| f64::from(u8::from(other != *set)));
            let at = |(index, all): (usize, &Vec<SetDensities>)| {
                let of_references = |set: usize| &likelihood.densities[set][index];
                let each = weights.iter().map(|weight| (*weight, of_references(weight.set)));
                let excess = references[index].excess(&sums_of_rests(each));
                let known = References::known(predicted[index].rests.len(), excess);
                let each = weights.iter().map(|weight| (*weight, &all[weight.set]));
                log_likelihood(&predicted[index], &known, *uniform, each)
            };
            of_sites.iter().enumerate().map(at).sum::<f64>()
        };
        left_out.iter().zip(&densities).map(of_set).sum()
    };
    let mut widths = widths.clone();
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
