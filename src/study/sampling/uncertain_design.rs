//! Sampling designs of uncertain parameters: the fraction of its distribution at which a run draws a parameter, computed
//! from the run's number in its point alone.

use crate::study::sampling::draw::{DrawKey, RandomOrder};
use crate::study::sampling::sampling_design::{SampleId, sobol_fraction, within};

/// How the uncertain parameters of a block's runs are sampled. Parameters are given by their places in the order of the
/// model's parameters.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum UncertainDesign {
    /// Independent draws.
    MonteCarlo,
    /// A Latin hypercube over the runs of a point.
    LatinHypercube {
        /// Number of runs.
        runs: u64,
        /// One axis per parameter.
        axes: Vec<LatinAxis>,
    },
    /// Dimensions of a scrambled Sobol' sequence.
    Sobol {
        /// Seed of the scrambling.
        seed: u32,
        /// Dimension of the first parameter; those of the others follow it.
        first_dimension: u32,
    },
}

/// The random numbers of one axis of a Latin hypercube.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LatinAxis {
    order: RandomOrder,
    key: DrawKey,
}

impl UncertainDesign {
    /// Creates a Latin hypercube over `runs` runs for parameters of these names, which key its random numbers.
    pub fn latin_hypercube(names: &[String], runs: u64, seed: u64) -> UncertainDesign {
        let axis = |name: &String| {
            let order = DrawKey::new(seed, "uncertain latin_hypercube order", name);
            LatinAxis {
                order: RandomOrder::new(&order, runs),
                key: DrawKey::new(seed, "uncertain latin_hypercube", name),
            }
        };
        UncertainDesign::LatinHypercube { runs, axes: names.iter().map(axis).collect() }
    }

    /// Creates a Sobol' sequence that is scrambled independently of that of the start states.
    pub fn own_sobol(seed: u64) -> UncertainDesign {
        let seed = DrawKey::new(seed, "uncertain sobol", "scramble").bits(0, 0) as u32;
        UncertainDesign::Sobol { seed, first_dimension: 0 }
    }

    /// Returns the number of dimensions of a Sobol' sequence that `parameters` parameters need, with those before them.
    pub fn dimensions(&self, parameters: usize) -> usize {
        match self {
            UncertainDesign::Sobol { first_dimension, .. } => {
                *first_dimension as usize + parameters
            }
            _ => 0,
        }
    }

    /// Returns the fraction of the parameter at a place, strictly between 0 and 1. `key` is the parameter's key of
    /// independent draws, and `sample` counts the runs of the point from zero.
    pub fn fraction(&self, place: usize, key: &DrawKey, id: SampleId, sample: u64) -> f64 {
        let independent = || key.uniform(id.cell, id.replicate);
        match self {
            UncertainDesign::MonteCarlo => independent(),
            UncertainDesign::LatinHypercube { runs, axes } => match axes.get(place) {
                Some(axis) => within(axis.order.at(sample), *runs, axis.key.uniform(0, sample)),
                None => independent(),
            },
            UncertainDesign::Sobol { seed, first_dimension } => {
                // A dimension is one of the library's 256, see `resolve::uncertain_sampling`.
                let dimension = first_dimension + place as u32;
                // The library's numbers are multiples of 2^-23, which may be zero.
                sobol_fraction(sample, dimension, *seed) + 0.5_f64.powi(24)
            }
        }
    }
}
