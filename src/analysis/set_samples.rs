//! The equilibrium set of any number of balls at quasi-random positions.
//!
//! Sobol' points with hashed Owen scrambling (B. Burley, J. Comput. Graph. Tech. 9 (2020) 4), in
//! several independent scrambles: each gives an unbiased fraction, and their scatter gives an
//! interval.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use nalgebra::Complex;
use sobol_burley::NUM_DIMENSIONS;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::interval::{Z_95, wilson};
use super::rest_form::{RestForm, direction};
use crate::model::MAX_BALLS;

/// Number of independent scrambles.
pub const REPLICATES: u32 = 16;

/// Returns the angles of one sample, one per ball, rad.
pub fn sample(balls: usize, replicate: u32, index: u32) -> Vec<f64> {
    (0..balls).map(|axis| coordinate(axis, replicate, index) * TAU).collect()
}

/// Returns a coordinate of a sample, in [0, 1).
pub(crate) fn coordinate(axis: usize, replicate: u32, index: u32) -> f64 {
    // Axes beyond those of the sequence are other scrambles of the first ones.
    let (again, axis) = (axis as u32 / NUM_DIMENSIONS, axis as u32 % NUM_DIMENSIONS);
    f64::from(sobol_burley::sample(index, axis, replicate + REPLICATES * again))
}

/// Number of samples per scramble in a block.
const BLOCK: u32 = 256;
/// Total number of blocks: 16,384 positions.
const BLOCKS: usize = 4;

/// The directions `e^{iβ}` of the balls at the positions of a block, which do not depend on the
/// machine.
struct SampleBlock {
    directions: Vec<Complex<f64>>,
}

impl SampleBlock {
    fn new(balls: usize, number: usize) -> Self {
        let first = number as u32 * BLOCK;
        let places =
            (first..first + BLOCK).flat_map(|index| (0..REPLICATES).map(move |r| (r, index)));
        let beta = places.flat_map(|(replicate, index)| sample(balls, replicate, index));
        SampleBlock { directions: beta.map(direction).collect() }
    }

    /// Returns a block, which is computed on first use and cached: a sweep tests the same positions
    /// for every machine. All blocks take 0.4 MB per ball.
    fn of(balls: usize, number: usize) -> &'static Self {
        static CACHE: [[OnceLock<SampleBlock>; BLOCKS]; MAX_BALLS] =
            [const { [const { OnceLock::new() }; BLOCKS] }; MAX_BALLS];
        CACHE[balls - 1][number].get_or_init(|| Self::new(balls, number))
    }

    /// Returns the number of positions of the block at which the balls can rest, and of those that they can have.
    fn held(&self, form: &RestForm) -> [usize; 2] {
        let positions = self.directions.chunks_exact(form.mass.len());
        let apart = positions.filter(|directions| form.are_apart(directions));
        [apart.clone().filter(|directions| form.holds(directions)).count(), apart.count()]
    }
}

/// Returns the fraction of the possible ones of the first 16,384 samples that are in the set; 0 if none is possible.
pub fn fraction(form: &RestForm) -> f64 {
    let counts = (0..BLOCKS).map(|number| SampleBlock::of(form.mass.len(), number).held(form));
    let [held, all] =
        counts.fold([0, 0], |[held, all], [more, others]| [held + more, all + others]);
    held as f64 / all.max(1) as f64
}

/// Returns the mean and the 95 % interval (Student's t) of the fractions of independent scrambles
/// of `samples` each. If all or none of the samples are in the set, there is no scatter, and the
/// interval is Wilson's for the same number of independent samples, which is conservative for
/// quasi-random ones.
pub fn fraction_with_interval(fractions: &[f64], samples: u32) -> (f64, (f64, f64)) {
    let n = fractions.len() as f64;
    let mean = fractions.iter().sum::<f64>() / n;
    let all = fractions.len() as u64 * u64::from(samples);
    if mean == 0.0 || mean == 1.0 {
        return (mean, wilson(if mean == 0.0 { 0 } else { all }, all, Z_95));
    }
    let variance =
        fractions.iter().map(|fraction| (fraction - mean).powi(2)).sum::<f64>() / (n - 1.0);
    // Without degrees of freedom the interval is [0, 1].
    let half = StudentsT::new(0.0, 1.0, n - 1.0)
        .map_or(f64::INFINITY, |student| student.inverse_cdf(0.975) * (variance / n).sqrt());
    (mean, ((mean - half).max(0.0), (mean + half).min(1.0)))
}
