//! Random numbers of the inference, and samples of a density in the unit cube.

use hammer_and_sample::{MinChainLen, Model, Serial, Stretch, sample};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use crate::study::Study;

/// The number of walkers of the ensemble; at least twice the number of parameters.
const WALKERS: usize = 32;
/// The number of iterations before the first sample.
const BURN_IN: usize = 60;
/// Every so many iterations, all walkers are samples.
const THINNING: usize = 5;
/// The number of points from which the walkers' first places are drawn.
const FIRST_PLACES: usize = 1024;

/// Returns the generator for a purpose and a number.
pub(super) fn generator(study: &Study, purpose: &str, number: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(study.derived_seed(purpose, number))
}

/// Returns a number with the standard normal distribution.
pub(super) fn normal(random: &mut ChaCha8Rng) -> f64 {
    random.sample(StandardNormal)
}

/// A density in the unit cube, by its logarithm.
struct InUnitCube<F>(F);

impl<F: Fn(&[f64]) -> f64 + Send + Sync> Model for InUnitCube<F> {
    type Params = Vec<f64>;

    fn log_prob(&self, place: &Vec<f64>) -> f64 {
        let is_inside = place.iter().all(|coordinate| (0.0..=1.0).contains(coordinate));
        if is_inside { (self.0)(place) } else { f64::NEG_INFINITY }
    }
}

/// Returns `samples` samples of a density in the unit cube with this logarithm, by the affine-invariant ensemble sampler of
/// Goodman and Weare (2010), doi:10.2140/camcos.2010.5.65.
pub(super) fn sample_in_unit_cube(
    dimensions: usize,
    samples: usize,
    log_density: impl Fn(&[f64]) -> f64 + Send + Sync,
    random: &mut ChaCha8Rng,
) -> Vec<Vec<f64>> {
    let uniform = |random: &mut ChaCha8Rng| -> Vec<f64> {
        (0..dimensions).map(|_| random.random()).collect()
    };
    let places: Vec<Vec<f64>> = (0..FIRST_PLACES).map(|_| uniform(random)).collect();
    let heights: Vec<f64> = places.iter().map(|place| log_density(place)).collect();
    let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut sums = Vec::with_capacity(heights.len());
    let mut sum = 0.0;
    for height in &heights {
        sum += libm::exp(height - highest);
        sums.push(sum);
    }
    let walkers: Vec<(Vec<f64>, ChaCha8Rng)> = (0..WALKERS)
        .map(|_| {
            let level = sum * random.random::<f64>();
            let index = sums.partition_point(|total| *total < level).min(places.len() - 1);
            // Places that are drawn twice must differ.
            let moved = |x: &f64| (x + 1e-4 * (random.random::<f64>() - 0.5)).clamp(0.0, 1.0);
            let first = places[index].iter().map(moved).collect();
            (first, ChaCha8Rng::seed_from_u64(random.random()))
        })
        .collect();
    let rounds = samples.div_ceil(WALKERS);
    let length = WALKERS * (BURN_IN + THINNING * rounds);
    let model = InUnitCube(log_density);
    let walkers = walkers.into_iter();
    let (chain, _) = sample(&model, &Stretch::default(), walkers, MinChainLen(length), Serial);
    let iterations: Vec<&[Vec<f64>]> = chain.chunks(WALKERS).skip(BURN_IN).collect();
    let kept = iterations.iter().skip(THINNING - 1).step_by(THINNING);
    kept.flat_map(|walkers| walkers.iter().cloned()).take(samples).collect()
}

#[cfg(test)]
mod tests {
    use super::sample_in_unit_cube;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// Means and variances of a narrow normal density and of one that the border cuts in half: the mean of the half is
    /// σ·sqrt(2/π). The chain's 4000 samples are correlated, so that the tolerance is that of some 400.
    #[test]
    fn samples_have_the_moments_of_the_density() {
        let deviation = [0.02, 0.05];
        let log_density = |place: &[f64]| {
            -0.5 * ((place[0] - 0.4) / deviation[0]).powi(2)
                - 0.5 * (place[1] / deviation[1]).powi(2)
        };
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let samples = sample_in_unit_cube(2, 4000, log_density, &mut random);
        assert_eq!(samples.len(), 4000);
        let mean = |index: usize| samples.iter().map(|sample| sample[index]).sum::<f64>() / 4000.0;
        assert!((mean(0) - 0.4).abs() < 4.0 * deviation[0] / 20.0, "{}", mean(0));
        let expected = deviation[1] * (2.0 / std::f64::consts::PI).sqrt();
        assert!((mean(1) - expected).abs() < 4.0 * 0.6 * deviation[1] / 20.0, "{}", mean(1));
        let variance =
            samples.iter().map(|sample| (sample[0] - mean(0)).powi(2)).sum::<f64>() / 4000.0;
        assert!(
            (variance / deviation[0].powi(2) - 1.0).abs() < 4.0 * (2.0_f64 / 400.0).sqrt(),
            "{variance}"
        );
    }
}
