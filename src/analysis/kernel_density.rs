//! A density on the torus of one angle or two, at the centres of bins: a kernel estimate with products
//! of von Mises densities.
//!
//! The standard deviation of the kernels follows the runs (`kernel_width`). The estimate is computed from
//! counts in bins of 1°, so that it takes no more memory for more runs and does not depend on their order.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::{Arc, OnceLock};

use super::density::{BINS, place};
use super::kernel_width::{WIDTHS_RAD, width_rad};

/// Fine bins per angle.
const FINE: usize = 360;
/// Most fine bins that are listed; where more are occupied, all have a place.
const MOST_LISTED: usize = 4096;

/// Counts in fine bins.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FineCounts {
    angles: usize,
    mirrored: bool,
    counts: Counts,
}

/// A point with few runs, of which there may be many, should cost no time for bins that are empty.
#[derive(Clone, Debug, PartialEq)]
enum Counts {
    Listed(BTreeMap<usize, u64>),
    All(Vec<u64>),
}

impl FineCounts {
    /// None yet, of positions of one angle or two; `mirrored` ones are counted in both orders.
    pub fn new(angles: usize, mirrored: bool) -> Self {
        FineCounts { angles, mirrored, counts: Counts::Listed(BTreeMap::new()) }
    }

    /// Counts a position.
    pub fn add(&mut self, position: &[f64]) {
        let cell = position.iter().fold(0, |cell, &angle| cell * FINE + place(angle, FINE));
        match &mut self.counts {
            Counts::All(counts) => counts[cell] += 1,
            Counts::Listed(counts) => {
                *counts.entry(cell).or_default() += 1;
                if counts.len() > MOST_LISTED {
                    let mut all = vec![0; FINE.pow(self.angles as u32)];
                    counts.iter().for_each(|(&cell, &count)| all[cell] = count);
                    self.counts = Counts::All(all);
                }
            }
        }
    }

    /// The bins that are occupied, in ascending order.
    fn occupied(&self) -> Vec<(usize, u64)> {
        match &self.counts {
            Counts::Listed(counts) => counts.iter().map(|(&cell, &count)| (cell, count)).collect(),
            Counts::All(counts) => {
                counts.iter().copied().enumerate().filter(|(_, count)| *count > 0).collect()
            }
        }
    }

    /// The density with kernels of the standard deviation that fits.
    pub fn estimate(&self) -> Estimate {
        let occupied = self.occupied();
        let width_rad = width_rad(&occupied, FINE, self.angles, self.mirrored);
        Estimate::new(&occupied, self.angles, width_rad)
    }
}

/// A kernel estimate, computed at the centre of a bin when it is asked for.
pub(super) struct Estimate {
    /// Standard deviation of the kernels, rad.
    pub width_rad: f64,
    kernel: Kernel,
    total: f64,
    /// Rows of fine bins that are occupied, by the first angle where there are two, each with the sums
    /// of kernels along the last angle at the centres of bins.
    rows: Vec<(usize, [f64; BINS])>,
    /// How many angles a position has.
    pub angles: usize,
}

impl Estimate {
    fn new(occupied: &[(usize, u64)], angles: usize, width_rad: f64) -> Self {
        let kernel = Kernel::of(width_rad);
        let total = occupied.iter().map(|(_, count)| count).sum::<u64>() as f64;
        let rows = occupied.chunk_by(|(a, _), (b, _)| a / FINE == b / FINE);
        let rows = rows.map(|row| (row[0].0 / FINE, kernel.smoothed(row))).collect();
        Estimate { width_rad, kernel, total, rows, angles }
    }

    /// The density at the centre of a bin of each angle, 1/rad or 1/rad²; of one angle the second bin
    /// is not looked at.
    pub fn at(&self, bins: &[usize; 2]) -> f64 {
        let last = bins[self.angles - 1];
        if self.angles == 1 {
            return self.rows.first().map_or(0.0, |(_, sums)| sums[last] / self.total);
        }
        let parts = self
            .rows
            .iter()
            .map(|(fine, sums)| self.kernel.about(*fine)[bins[0]] * sums[last] / self.total);
        parts.fold(0.0, |density, part| density + part)
    }
}

/// For the centre of each fine bin, the von Mises density about it at the centre of each bin.
#[derive(Clone)]
struct Kernel(Arc<[[f64; BINS]]>);

impl Kernel {
    /// Those of the usual widths are computed once.
    fn of(width_rad: f64) -> Self {
        static USUAL: [OnceLock<Kernel>; WIDTHS_RAD.len()] =
            [const { OnceLock::new() }; WIDTHS_RAD.len()];
        match WIDTHS_RAD.iter().position(|&usual| usual == width_rad) {
            Some(place) => USUAL[place].get_or_init(|| Self::new(width_rad)).clone(),
            None => Self::new(width_rad),
        }
    }

    fn new(width_rad: f64) -> Self {
        let concentration = 1.0 / (width_rad * width_rad);
        let density = |angle: f64| libm::exp(concentration * (libm::cos(angle) - 1.0));
        let step = TAU / FINE as f64;
        // The trapezoidal rule round a circle is exact for such a function, but for rounding.
        let whole: f64 = (0..FINE).map(|fine| density(step * fine as f64) * step).sum();
        let centre = |place: usize, bins: usize| (place as f64 + 0.5) * (TAU / bins as f64);
        let about = |fine: usize| {
            let at = |bin: usize| density(centre(bin, BINS) - centre(fine, FINE)) / whole;
            std::array::from_fn(at)
        };
        Kernel((0..FINE).map(about).collect())
    }

    fn about(&self, fine: usize) -> &[f64; BINS] {
        &self.0[fine]
    }

    /// Sums of kernels about the fine bins of a row, at the centre of each bin.
    fn smoothed(&self, row: &[(usize, u64)]) -> [f64; BINS] {
        let mut sums = [0.0; BINS];
        for &(cell, count) in row {
            let weights = self.about(cell % FINE);
            sums.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * count as f64);
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use statrs::distribution::{ContinuousCDF, Normal};

    use super::{BINS, FineCounts, Kernel};
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
            let at = Kernel::of(width).about(40)[3];
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
        let estimate = counts.estimate();
        let width = estimate.width_rad;
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
            let off = (estimate.at(&[a, b]) - mean) / deviation;
            assert!(off.abs() < limit, "{a} {b}: off by {off} deviations");
        }
        assert!(checked > 200, "{checked}");
    }
}
