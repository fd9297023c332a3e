//! A density on the torus of one angle or two, at the centres of bins: a kernel estimate with products
//! of von Mises densities.
//!
//! The standard deviation of the kernels follows the runs (`kernel_width`). The estimate is computed from
//! counts in bins of 1°, so that it takes no more memory for more runs and does not depend on their order.

use std::f64::consts::TAU;

use super::density::{BINS, place};
use super::kernel_width::width_rad;

/// Fine bins per angle.
const FINE: usize = 360;

/// Counts in fine bins.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FineCounts {
    angles: usize,
    mirrored: bool,
    counts: Vec<u64>,
}

impl FineCounts {
    /// None yet, of positions of one angle or two; `mirrored` ones are counted in both orders.
    pub fn new(angles: usize, mirrored: bool) -> Self {
        FineCounts { angles, mirrored, counts: vec![0; FINE.pow(angles as u32)] }
    }

    /// Counts a position.
    pub fn add(&mut self, position: &[f64]) {
        let cell = position.iter().fold(0, |cell, &angle| cell * FINE + place(angle, FINE));
        self.counts[cell] += 1;
    }

    /// The standard deviation of kernels that fits.
    pub fn width_rad(&self) -> f64 {
        width_rad(&self.counts, self.angles, self.mirrored)
    }

    /// The density at the centres of all bins, the last angle's changing fastest, with kernels of this
    /// standard deviation.
    pub fn density(&self, width_rad: f64) -> Vec<f64> {
        let kernel = kernel(width_rad);
        let total = self.counts.iter().sum::<u64>() as f64;
        // The last angle first: rows of fine bins become rows of bins.
        let rows = self.counts.chunks(FINE).map(|row| smoothed(&kernel, row.iter().copied()));
        if self.angles == 1 {
            return rows.flatten().map(|sum| sum / total).collect();
        }
        let mut density = vec![0.0; BINS * BINS];
        for (fine, row) in rows.enumerate() {
            if row.iter().all(|&sum| sum == 0.0) {
                continue;
            }
            for (bin, weights) in kernel.iter().enumerate() {
                for (place, sum) in row.iter().enumerate() {
                    density[bin * BINS + place] += weights[fine] * sum / total;
                }
            }
        }
        density
    }
}

/// Sums of kernels about the fine bins, at the centre of each bin.
fn smoothed(kernel: &[Vec<f64>], counts: impl Iterator<Item = u64>) -> Vec<f64> {
    let mut sums = vec![0.0; BINS];
    for (fine, count) in counts.enumerate().filter(|(_, count)| *count > 0) {
        for (sum, weights) in sums.iter_mut().zip(kernel) {
            *sum += weights[fine] * count as f64;
        }
    }
    sums
}

/// For the centre of each bin, the von Mises density there about the centre of each fine bin.
fn kernel(width_rad: f64) -> Vec<Vec<f64>> {
    let concentration = 1.0 / (width_rad * width_rad);
    let density = |angle: f64| libm::exp(concentration * (libm::cos(angle) - 1.0));
    let step = TAU / FINE as f64;
    // The trapezoidal rule round a circle is exact for such a function, but for rounding.
    let whole: f64 = (0..FINE).map(|fine| density(step * fine as f64) * step).sum();
    let centre = |place: usize, bins: usize| (place as f64 + 0.5) * (TAU / bins as f64);
    let about = |bin: usize| {
        (0..FINE).map(|fine| density(centre(bin, BINS) - centre(fine, FINE)) / whole).collect()
    };
    (0..BINS).map(about).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use statrs::distribution::{ContinuousCDF, Normal};

    use super::{BINS, FineCounts, kernel};
    use crate::analysis::draws::Draws;

    /// The kernel is the von Mises density, with its Bessel function from another rule of quadrature.
    #[test]
    fn kernels_are_densities() {
        for width in [0.05_f64, 0.2, 0.5] {
            let concentration = 1.0 / (width * width);
            // exp(-κ) I_0(κ) = mean over the circle of exp(κ (cos x - 1)).
            let points = 100_003;
            let mean = (0..points)
                .map(|i| {
                    (concentration * ((TAU * f64::from(i) / f64::from(points)).cos() - 1.0)).exp()
                })
                .sum::<f64>()
                / f64::from(points);
            let at = kernel(width)[3][40];
            let way = (35.0_f64 - 40.5).to_radians();
            let expected = (concentration * (way.cos() - 1.0)).exp() / (TAU * mean);
            assert!((at / expected - 1.0).abs() < 1e-9, "{at} {expected}");
        }
    }

    /// Two independent von Mises angles: the densities at the centres within the normal limits at a
    /// level of 0.001 for all together (Bonferroni) of what they are on average, the distribution
    /// smoothed by the kernel.
    #[test]
    fn a_known_distribution_is_recovered() {
        let mut draws = Draws::new(12);
        let (centres, concentrations) = ([2.0, 5.0], [2.0, 4.0]);
        let runs = 20_000;
        let mut counts = FineCounts::new(2, false);
        for _ in 0..runs {
            let beta = [0, 1].map(|i| draws.von_mises(centres[i], concentrations[i]));
            counts.add(&beta);
        }
        // The distribution of each angle on 7200 points.
        let points = 7200;
        let at = |point: usize| (point as f64 + 0.5) * TAU / points as f64;
        let exact = [0, 1].map(|i| {
            let weight =
                |angle: f64| (concentrations[i] * ((angle - centres[i]).cos() - 1.0)).exp();
            let all: f64 = (0..points).map(|point| weight(at(point))).sum();
            (0..points).map(|point| weight(at(point)) / all).collect::<Vec<f64>>()
        });
        let width = counts.width_rad();
        let concentration = 1.0 / (width * width);
        let smoothed = |i: usize, bin: usize| -> [f64; 2] {
            let centre = (bin as f64 + 0.5) * TAU / BINS as f64;
            let kernel = |angle: f64| (concentration * ((angle - centre).cos() - 1.0)).exp();
            let whole: f64 =
                (0..points).map(|point| kernel(at(point))).sum::<f64>() * TAU / points as f64;
            let mean = |power: i32| -> f64 {
                let weights = exact[i].iter().enumerate();
                weights.map(|(point, share)| share * (kernel(at(point)) / whole).powi(power)).sum()
            };
            [mean(1), mean(2)]
        };
        let limit = Normal::new(0.0, 1.0).unwrap().inverse_cdf(1.0 - 0.0005 / 1296.0);
        let estimate = counts.density(width);
        let sides = [0, 1].map(|i| (0..BINS).map(|bin| smoothed(i, bin)).collect::<Vec<_>>());
        let mut checked = 0;
        for (a, b) in (0..BINS).flat_map(|a| (0..BINS).map(move |b| (a, b))) {
            let mean = sides[0][a][0] * sides[1][b][0];
            let square = sides[0][a][1] * sides[1][b][1];
            // Where a few runs only are within reach, the sum of kernels is not normal.
            if mean * width * width * f64::from(runs) < 5.0 {
                continue;
            }
            checked += 1;
            let deviation = ((square - mean * mean) / f64::from(runs)).sqrt();
            let off = (estimate[a * BINS + b] - mean) / deviation;
            assert!(off.abs() < limit, "{a} {b}: off by {off} deviations");
        }
        assert!(checked > 200, "{checked}");
    }
}
