//! The densities of all measured runs for one parameter set, with replicates for the error of a finite number of runs.
//!
//! A replicate gives each simulated run an exponentially distributed weight instead of an equal one (the Bayesian bootstrap,
//! D. B. Rubin 1981, doi:10.1214/aos/1176345338). Weights of different parameter sets are independent, as their runs are.

use rand::RngExt;
use rand_distr::Exp1;

use super::density::Rests;
use super::sampler::generator;
use super::site::{Measured, Site};
use super::smoother::SetWeight;
use crate::study::Study;

/// The number of replicates.
pub const REPLICATES: usize = 8;

/// The bandwidth of the kernels over the standard deviation of a measured angle: it adds 4 % to the variance.
const BANDWIDTH: f64 = 0.2;

/// A value with equal weights, and with the weights of each replicate.
pub type Replicated = [f64; REPLICATES + 1];

/// The weights of all runs of a parameter set at a site.
pub struct RunWeights(Vec<Replicated>);

impl RunWeights {
    /// Returns the weights of this many runs of a parameter set at a site.
    pub fn new(study: &Study, set: usize, site: usize, runs: usize) -> Self {
        // The numbers of sets and sites are far below 2^32.
        let number = ((set as u64) << 32) | site as u64;
        let mut random = generator(study, "identify weights", number);
        let weights = |_| {
            std::array::from_fn(|replicate| if replicate == 0 { 1.0 } else { random.sample(Exp1) })
        };
        RunWeights((0..runs).map(weights).collect())
    }

    /// Returns equal weights.
    pub fn equal() -> Self {
        RunWeights(Vec::new())
    }

    fn of(&self, run: usize) -> Replicated {
        self.0.get(run).copied().unwrap_or([1.0; REPLICATES + 1])
    }

    /// Returns the sum of the weights of runs.
    fn sum(&self, runs: &[usize]) -> Replicated {
        runs.iter().fold([0.0; REPLICATES + 1], |sum, run| added(sum, self.of(*run), 1.0))
    }
}

/// The densities of the measured runs at a site for one parameter set.
#[derive(Clone, Debug, PartialEq)]
pub struct SetDensities {
    /// The number of simulated runs.
    pub runs: usize,
    /// For each replicate, the probability density of each measured position of rest.
    pub rests: [Vec<f64>; REPLICATES + 1],
    /// The probability of motion.
    pub moving: Replicated,
}

impl SetDensities {
    /// Returns the densities of the measured runs at a site.
    pub fn at_site(site: &Site, rests: &Rests, weights: &RunWeights) -> Self {
        let moving = weights.sum(rests.moving());
        let all = added(weights.sum(rests.at_rest()), moving, 1.0);
        let of_run = |measured: &Measured| {
            let std_dev_rad = measured.std_dev_rad;
            let kernels = rests.kernels(&measured.angles, std_dev_rad, BANDWIDTH * std_dev_rad);
            let each = rests.at_rest().iter().zip(&kernels).filter(|(_, kernel)| **kernel > 0.0);
            let sum = each.fold([0.0; REPLICATES + 1], |sum, (run, kernel)| {
                added(sum, weights.of(*run), *kernel)
            });
            over(sum, all)
        };
        let rows: Vec<Replicated> = site.rests.iter().map(of_run).collect();
        let of_replicate = |replicate: usize| rows.iter().map(|row| row[replicate]).collect();
        SetDensities {
            runs: rests.runs(),
            rests: std::array::from_fn(of_replicate),
            moving: over(moving, all),
        }
    }
}

/// Returns the sums of the regression and of the plain mean over parameter sets, for each measured position and a replicate.
pub fn sums_of_rests<'d>(
    sets: impl Iterator<Item = (SetWeight, &'d SetDensities)>,
    replicate: usize,
) -> Vec<[f64; 2]> {
    let (mut regression, mut mean) = (Vec::new(), Vec::new());
    for (weight, densities) in sets {
        let rows = &densities.rests[replicate];
        // Two loops over contiguous numbers, which are computed in vectors.
        for (sums, weight) in [(&mut regression, weight.regression), (&mut mean, weight.mean)] {
            sums.resize(rows.len(), 0.0);
            for (sum, density) in sums.iter_mut().zip(rows) {
                *sum += weight * density;
            }
        }
    }
    regression.into_iter().zip(mean).map(|(regression, mean)| [regression, mean]).collect()
}

fn added(sum: Replicated, terms: Replicated, factor: f64) -> Replicated {
    std::array::from_fn(|replicate| sum[replicate] + factor * terms[replicate])
}

fn over(sum: Replicated, all: Replicated) -> Replicated {
    std::array::from_fn(
        |replicate| if all[replicate] > 0.0 { sum[replicate] / all[replicate] } else { 0.0 },
    )
}
