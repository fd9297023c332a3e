//! Where on the ring balls come to rest, as counts in equal bins and as a density on the torus of
//! their angles.
//!
//! One angle or two are looked at together. With three balls and more, what is counted is each ball's
//! angle alone, those of balls that are alike together. Bins are 10° wide. The density is a kernel
//! estimate at their centres, with products of von Mises densities of a standard deviation `h`,
//!
//! ```text
//! h = n^(-1/(d + 4)) / 2 rad, at least 0.05 rad, for n equilibria and d angles
//! ```
//!
//! which is Scott's rule (D. W. Scott, Multivariate Density Estimation, 2nd ed., Wiley 2015, section 6.3,
//! doi:10.1002/9781118575574) for features half a radian wide: at all points the same, so that they
//! can be compared. It is computed from counts in bins of 1°, so that it takes no more memory for
//! more runs and does not depend on their order.
//!
//! Two balls that are alike have no names: each equilibrium counts in the bin of its angles in ascending
//! order, and half in the density at `(β_1, β_2)`, half at `(β_2, β_1)`. The density integrates to 1 over
//! the whole torus, or, of three balls and more, round the ring.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::interval::{Z_95, wilson};

/// Bins per angle.
pub const BINS: usize = 36;
/// Fine bins per angle, from which densities are computed.
const FINE: usize = 360;
/// The least standard deviation of a kernel, rad: fine bins are not seen.
const LEAST_WIDTH_RAD: f64 = 0.05;

/// The bin of an angle in [0, 2π), from 0.
pub fn bin(angle: f64) -> usize {
    place(angle, BINS)
}

/// Where a bin begins and ends, rad.
pub fn bin_edges(bin: usize) -> [f64; 2] {
    [bin, bin + 1].map(|edge| edge as f64 * (TAU / BINS as f64))
}

fn place(angle: f64, bins: usize) -> usize {
    ((angle.rem_euclid(TAU) / TAU * bins as f64) as usize).min(bins - 1)
}

/// One bin in which balls came to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityBin {
    /// Of three balls and more: the first of the balls that are alike, of which the angle is one, from
    /// 0.
    pub ball: usize,
    /// The bin of each angle: one or two.
    pub bins: Vec<usize>,
    /// Equilibria in it; of three balls and more, those with one of the balls in it or several.
    pub runs: u64,
    /// Share of all equilibria of the point.
    pub share: f64,
    /// Its 95 % interval (Wilson).
    pub interval: (f64, f64),
    /// Density at the bin's centre, 1/rad or 1/rad².
    pub density: f64,
}

/// Collects the equilibria of one point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Density {
    equilibria: u64,
    /// Equilibria by ball and bins.
    counts: BTreeMap<(usize, Vec<usize>), u64>,
    /// By ball.
    fine: BTreeMap<usize, Fine>,
}

/// Counts in fine bins.
#[derive(Clone, Debug, PartialEq)]
struct Fine {
    angles: usize,
    counts: Vec<u64>,
}

impl Density {
    /// Takes in the angles at which balls rest, ascending among balls that are alike; `groups` has the
    /// places of those that are, each ball once.
    pub fn add(&mut self, beta: &[f64], groups: &[Vec<usize>]) {
        self.equilibria += 1;
        match *beta {
            [angle] => self.count(0, vec![bin(angle)], &[&[angle]]),
            [a, b] if groups.len() == 1 => {
                self.count(0, vec![bin(a), bin(b)], &[&[a, b], &[b, a]]);
            }
            [a, b] => self.count(0, vec![bin(a), bin(b)], &[&[a, b], &[a, b]]),
            _ => {
                for group in groups {
                    self.add_group(group, beta);
                }
            }
        }
    }

    fn add_group(&mut self, group: &[usize], beta: &[f64]) {
        let Some(&ball) = group.first() else { return };
        let mut seen = [false; BINS];
        for &place in group {
            let angle = beta[place];
            self.count_fine(ball, &[angle]);
            if !std::mem::replace(&mut seen[bin(angle)], true) {
                *self.counts.entry((ball, vec![bin(angle)])).or_default() += 1;
            }
        }
    }

    fn count(&mut self, ball: usize, bins: Vec<usize>, positions: &[&[f64]]) {
        *self.counts.entry((ball, bins)).or_default() += 1;
        positions.iter().for_each(|position| self.count_fine(ball, position));
    }

    fn count_fine(&mut self, ball: usize, position: &[f64]) {
        let angles = position.len();
        let empty = || Fine { angles, counts: vec![0; FINE.pow(angles as u32)] };
        let fine = self.fine.entry(ball).or_insert_with(empty);
        let cell = position.iter().fold(0, |cell, &angle| cell * FINE + place(angle, FINE));
        fine.counts[cell] += 1;
    }

    /// The bins in which balls came to rest, in ascending order.
    pub fn bins(&self) -> Vec<DensityBin> {
        let estimates: BTreeMap<usize, Vec<f64>> = self
            .fine
            .iter()
            .map(|(&ball, fine)| (ball, fine.estimate(width_rad(self.equilibria, fine.angles))))
            .collect();
        let row = |((ball, bins), &runs): (&(usize, Vec<usize>), &u64)| DensityBin {
            ball: *ball,
            bins: bins.clone(),
            runs,
            share: runs as f64 / self.equilibria as f64,
            interval: wilson(runs, self.equilibria, Z_95),
            density: estimates[ball][bins.iter().fold(0, |place, bin| place * BINS + bin)],
        };
        self.counts.iter().map(row).collect()
    }
}

/// The standard deviation of a kernel.
fn width_rad(equilibria: u64, angles: usize) -> f64 {
    let width = 0.5 * libm::pow(equilibria as f64, -1.0 / (angles as f64 + 4.0));
    width.max(LEAST_WIDTH_RAD)
}

impl Fine {
    /// The density at the centres of all bins, the last angle's changing fastest.
    fn estimate(&self, width_rad: f64) -> Vec<f64> {
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

    use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

    use super::{BINS, Density, bin, bin_edges, kernel, width_rad};
    use crate::analysis::draws::Draws;

    fn alike(balls: usize) -> Vec<Vec<usize>> {
        vec![(0..balls).collect()]
    }

    fn differing(balls: usize) -> Vec<Vec<usize>> {
        (0..balls).map(|ball| vec![ball]).collect()
    }

    fn sorted(mut beta: Vec<f64>) -> Vec<f64> {
        beta.sort_by(f64::total_cmp);
        beta
    }

    /// An angle from a von Mises distribution, by rejection.
    fn von_mises(centre: f64, concentration: f64, draws: &mut Draws) -> f64 {
        loop {
            let angle = TAU * draws.uniform();
            if draws.uniform() < (concentration * ((angle - centre).cos() - 1.0)).exp() {
                return angle;
            }
        }
    }

    #[test]
    fn bins_have_their_angles() {
        for angle in [0.0, 1e-300, 0.17453, 1.0, 3.0, TAU - 1e-9, TAU.next_down()] {
            let [from, to] = bin_edges(bin(angle));
            assert!(from <= angle && angle <= to, "{angle}");
        }
        assert_eq!((bin(0.0), bin(TAU.next_down()), bin(-0.1)), (0, 35, 35));
        assert_eq!(bin_edges(35)[1], TAU);
    }

    /// The kernel is the von Mises density: with its Bessel function by the series.
    #[test]
    fn kernels_are_densities() {
        for width in [0.05_f64, 0.2, 0.5] {
            let concentration = 1.0 / (width * width);
            // exp(-κ) I_0(κ) = mean over the circle of exp(κ (cos x - 1)), by another rule.
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

    /// Over all bins the densities integrate to 1, and the counts to all equilibria.
    #[test]
    fn integrates_to_one() {
        let mut draws = Draws::new(10);
        for balls in [1, 2, 3, 5] {
            for groups in [alike(balls), differing(balls)] {
                let mut density = Density::default();
                for _ in 0..500 {
                    let beta = (0..balls).map(|_| von_mises(2.0, 3.0, &mut draws)).collect();
                    density.add(&if groups.len() == 1 { sorted(beta) } else { beta }, &groups);
                }
                for fine in density.fine.values() {
                    let width = TAU / BINS as f64;
                    let all = fine.estimate(width_rad(500, fine.angles)).iter().sum::<f64>()
                        * width.powi(fine.angles as i32);
                    assert!((all - 1.0).abs() < 1e-6, "{balls} balls: {all}");
                }
                let rows = density.bins();
                let runs: u64 = rows.iter().map(|row| row.runs).sum();
                match balls {
                    1 | 2 => assert_eq!(runs, 500),
                    // More than one ball may lie in a bin.
                    _ => assert!(runs <= 500 * balls as u64 && runs >= 500 * groups.len() as u64),
                }
                assert!(rows.iter().all(|row| {
                    row.interval.0 < row.share && row.share <= row.interval.1 && row.density > 0.0
                }));
            }
        }
    }

    /// Balls that are alike may be exchanged, and runs come in any order.
    #[test]
    fn order_and_exchange_do_not_matter() {
        let mut draws = Draws::new(11);
        let positions: Vec<Vec<f64>> = (0..300)
            .map(|_| vec![von_mises(1.0, 2.0, &mut draws), TAU * draws.uniform()])
            .collect();
        let of = |positions: &mut dyn Iterator<Item = Vec<f64>>| {
            let mut density = Density::default();
            positions.for_each(|beta| density.add(&beta, &alike(2)));
            density
        };
        let forward = of(&mut positions.iter().cloned().map(sorted));
        assert_eq!(forward, of(&mut positions.iter().rev().cloned().map(sorted)));
        let density = forward.fine[&0].estimate(0.2);
        for (i, j) in (0..BINS).flat_map(|i| (0..BINS).map(move |j| (i, j))) {
            let [one, other] = [density[i * BINS + j], density[j * BINS + i]];
            assert!((one - other).abs() <= 1e-12 * one, "{i} {j}: {one} {other}");
        }
        assert!(forward.bins().iter().all(|row| row.bins[0] <= row.bins[1]));
    }

    /// Two independent von Mises angles: the counts of the bins by a chi-square test at a level of
    /// 0.001, and the densities at the centres within the normal limits at a level of 0.001 for
    /// all together (Bonferroni) of what they are on average, the distribution smoothed by the kernel.
    #[test]
    fn a_known_distribution_is_recovered() {
        let mut draws = Draws::new(12);
        let (centres, concentrations) = ([2.0, 5.0], [2.0, 4.0]);
        let runs = 20_000;
        let mut density = Density::default();
        for _ in 0..runs {
            let beta =
                [0, 1].map(|i| von_mises(centres[i], concentrations[i], &mut draws)).to_vec();
            density.add(&beta, &differing(2));
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
        let of_bin = |i: usize, bin: usize| -> f64 {
            exact[i][bin * points / BINS..(bin + 1) * points / BINS].iter().sum()
        };
        let rows = density.bins();
        let (mut chi_square, mut kinds, mut rest) = (0.0, 0, [0.0, runs as f64]);
        for (a, b) in (0..BINS).flat_map(|a| (0..BINS).map(move |b| (a, b))) {
            let expected = of_bin(0, a) * of_bin(1, b) * f64::from(runs);
            if expected >= 5.0 {
                let found = rows.iter().find(|row| row.bins == [a, b]).map_or(0, |row| row.runs);
                chi_square += (found as f64 - expected).powi(2) / expected;
                kinds += 1;
                rest = [rest[0] + expected, rest[1] - found as f64];
            }
        }
        let left = f64::from(runs) - rest[0];
        chi_square += (rest[1] - left).powi(2) / left;
        let limit = ChiSquared::new(f64::from(kinds)).unwrap().inverse_cdf(0.999);
        println!("chi-square {chi_square} of {kinds}, limit {limit}");
        assert!(kinds > 300 && chi_square < limit);

        let width = width_rad(runs as u64, 2);
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
        let estimate = density.fine[&0].estimate(width);
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
