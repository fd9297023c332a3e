//! Replicates of the parameter sets, for the error of the likelihood that comes from a finite number of simulated runs.
//!
//! A replicate gives each parameter set an exponentially distributed weight instead of an equal one (the Bayesian bootstrap,
//! D. B. Rubin 1981, doi:10.1214/aos/1176345338). Runs of different sets are independent. The scatter of the replicates thus
//! contains the error of the runs of each set, and the deviation of the sets from the regression over them.

use rand::RngExt;
use rand_distr::Exp1;

use super::sampler::generator;
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
