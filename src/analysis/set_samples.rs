//! The equilibrium set of any number of balls at quasi-random positions.
//!
//! Sobol' points with hashed Owen scrambling (B. Burley, J. Comput. Graph. Tech. 9 (2020) 4), in
//! several independent scrambles: each gives an unbiased fraction, and their scatter gives an
//! interval.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use nalgebra::Complex;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::interval::{Z_95, wilson};
use super::rest_form::{RestForm, direction};
use crate::model::MAX_BALLS;

/// Number of independent scrambles.
pub const REPLICATES: u32 = 16;

/// Returns the angles of one sample, one per ball, rad.
pub fn sample(balls: usize, replicate: u32, index: u32) -> Vec<f64> {
    let angle = |axis| f64::from(sobol_burley::sample(index, axis, replicate)) * TAU;
    (0..balls as u32).map(angle).collect()
}

/// Number of samples per scramble in a block.
const BLOCK: u32 = 256;
/// Total number of blocks: 65,536 positions.
const BLOCKS: usize = 16;

/// Positions of the balls with their directions, which do not depend on the machine.
struct Block {
    beta: Vec<f64>,
    directions: Vec<Complex<f64>>,
}

impl Block {
    fn new(balls: usize, number: usize) -> Self {
        let first = number as u32 * BLOCK;
        let places =
            (first..first + BLOCK).flat_map(|index| (0..REPLICATES).map(move |r| (r, index)));
        let beta: Vec<f64> =
            places.flat_map(|(replicate, index)| sample(balls, replicate, index)).collect();
        let directions = beta.iter().map(|&beta| direction(beta)).collect();
        Block { beta, directions }
    }

    /// Returns a block, which is computed on first use and cached: a sweep tests the same positions
    /// for every machine. All blocks take 1.5 MB per ball.
    fn of(balls: usize, number: usize) -> &'static Self {
        static CACHE: [[OnceLock<Block>; BLOCKS]; MAX_BALLS] =
            [const { [const { OnceLock::new() }; BLOCKS] }; MAX_BALLS];
        CACHE[balls - 1][number].get_or_init(|| Self::new(balls, number))
    }

    /// Returns the positions of the block at which the balls can rest.
    fn held<'a>(&'a self, form: &'a RestForm) -> impl Iterator<Item = &'a [f64]> {
        let balls = form.mass.len();
        let positions = self.beta.chunks_exact(balls).zip(self.directions.chunks_exact(balls));
        positions.filter(|(_, directions)| form.holds(directions)).map(|(beta, _)| beta)
    }
}

/// Returns those of the first 65,536 samples that are in the set, as angles of each ball, rad. The
/// samples are ordered by index, then by scramble.
#[cfg(test)]
pub fn held_positions(form: &RestForm) -> impl Iterator<Item = &[f64]> {
    (0..BLOCKS).flat_map(|number| Block::of(form.mass.len(), number).held(form))
}

/// Returns the fraction of the first 16,384 samples that are in the set.
pub fn fraction(form: &RestForm) -> f64 {
    let blocks = 4;
    let held = |number| Block::of(form.mass.len(), number).held(form).count();
    (0..blocks).map(held).sum::<usize>() as f64 / (blocks as u32 * BLOCK * REPLICATES) as f64
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

#[cfg(test)]
mod tests {
    use super::{REPLICATES, fraction, fraction_with_interval, held_positions, sample};
    use crate::analysis::RestForm;
    use crate::model::{Ball, Machine};

    /// The cached positions are the samples, in their order.
    #[test]
    fn cached_positions_are_the_samples() {
        for (balls, friction_coefficient) in [(1, 2.75e-3), (2, 2.75e-4), (3, 2.75e-3), (3, 0.0)] {
            let ball = Ball { friction_coefficient, ..Ball::default() };
            let machine = Machine { balls: vec![ball; balls], ..Machine::default() };
            let form = RestForm::new(&machine).unwrap();
            let all = (0..4096).flat_map(|index| {
                (0..REPLICATES).map(move |replicate| sample(balls, replicate, index))
            });
            let inside: Vec<(usize, Vec<f64>)> =
                all.enumerate().filter(|(_, beta)| form.at_rest(beta).in_set()).collect();
            let found: Vec<&[f64]> = held_positions(&form).collect();
            assert!(inside.iter().map(|(_, beta)| beta).eq(&found));
            assert_eq!(found.is_empty(), friction_coefficient == 0.0);
            let first = inside.iter().filter(|(place, _)| *place < 16_384).count();
            assert_eq!(fraction(&form), first as f64 / 16_384.0);
        }
    }

    /// The interval uses Student's t for 15 degrees of freedom, 2.131450 in published tables.
    #[test]
    fn the_interval_is_that_of_students_t() {
        let fractions: Vec<f64> =
            (0..16).map(|i| 0.5 + if i % 2 == 0 { 0.01 } else { -0.01 }).collect();
        let (mean, (low, high)) = fraction_with_interval(&fractions, 1024);
        let deviation = (16.0 * 1e-4 / 15.0_f64).sqrt();
        let half = 2.131_449_545_559_323 * deviation / 4.0;
        assert!((mean - 0.5).abs() < 1e-15);
        assert!((high - mean - half).abs() < 1e-9 && (mean - low - half).abs() < 1e-9, "{high}");
    }

    #[test]
    fn fractions_of_zero_and_one_have_wilsons_interval() {
        let (mean, (low, high)) = fraction_with_interval(&[1.0; 16], 4096);
        assert_eq!((mean, high), (1.0, 1.0));
        assert!(low < 1.0 && low > 0.9999, "{low}");
        assert_eq!(fraction_with_interval(&[0.0; 16], 4096).1.0, 0.0);
    }
}
