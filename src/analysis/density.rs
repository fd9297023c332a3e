//! Where on the ring balls come to rest, as counts in equal bins and as a density on the torus of
//! their angles.
//!
//! One angle or two are looked at together. With three balls and more, what is counted is each ball's
//! angle alone, those of balls that are alike together. Bins are 10° wide; the density is a kernel
//! estimate at their centres.
//!
//! Two balls that are alike have no names: each equilibrium counts in the bin of its angles in ascending
//! order, and half in the density at `(β_1, β_2)`, half at `(β_2, β_1)`. The density integrates to 1 over
//! the whole torus, or, of three balls and more, round the ring.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::interval::{Z_95, wilson};
use super::kernel_density::{Estimate, FineCounts};

/// Bins per angle.
pub const BINS: usize = 36;

/// The bin of an angle in [0, 2π), from 0.
pub fn bin(angle: f64) -> usize {
    place(angle, BINS)
}

/// Where a bin begins and ends, rad.
pub fn bin_edges(bin: usize) -> [f64; 2] {
    [bin, bin + 1].map(|edge| edge as f64 * (TAU / BINS as f64))
}

/// The place of an angle among so many equal bins.
pub(super) fn place(angle: f64, bins: usize) -> usize {
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
    /// Standard deviation of its kernels, rad.
    pub kernel_width_rad: f64,
}

/// Collects the equilibria of one point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Density {
    equilibria: u64,
    /// Equilibria by ball and bins; of one angle the second bin is 0.
    counts: BTreeMap<(usize, [usize; 2]), u64>,
    /// By ball.
    fine: BTreeMap<usize, FineCounts>,
}

impl Density {
    /// Takes in the angles at which balls rest, ascending among balls that are alike; `groups` has the
    /// places of those that are, each ball once.
    pub fn add(&mut self, beta: &[f64], groups: &[Vec<usize>]) {
        self.equilibria += 1;
        match *beta {
            [angle] => self.count(0, [bin(angle), 0], &[&[angle]]),
            [a, b] if groups.len() == 1 => {
                self.count(0, [bin(a), bin(b)], &[&[a, b], &[b, a]]);
            }
            [a, b] => self.count(0, [bin(a), bin(b)], &[&[a, b]]),
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
            self.count_fine(ball, &[angle], false);
            if !std::mem::replace(&mut seen[bin(angle)], true) {
                *self.counts.entry((ball, [bin(angle), 0])).or_default() += 1;
            }
        }
    }

    fn count(&mut self, ball: usize, bins: [usize; 2], positions: &[&[f64]]) {
        *self.counts.entry((ball, bins)).or_default() += 1;
        let mirrored = positions.len() > 1;
        positions.iter().for_each(|position| self.count_fine(ball, position, mirrored));
    }

    fn count_fine(&mut self, ball: usize, position: &[f64], mirrored: bool) {
        let none = || FineCounts::new(position.len(), mirrored);
        self.fine.entry(ball).or_insert_with(none).add(position);
    }

    /// The bins in which balls came to rest, in ascending order.
    pub fn bins(&self) -> Vec<DensityBin> {
        let estimates: BTreeMap<usize, Estimate> =
            self.fine.iter().map(|(&ball, fine)| (ball, fine.estimate())).collect();
        let row = |(&(ball, bins), &runs): (&(usize, [usize; 2]), &u64)| DensityBin {
            ball,
            bins: bins[..estimates[&ball].angles].to_vec(),
            runs,
            share: runs as f64 / self.equilibria as f64,
            interval: wilson(runs, self.equilibria, Z_95),
            density: estimates[&ball].at(&bins),
            kernel_width_rad: estimates[&ball].width_rad,
        };
        self.counts.iter().map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use statrs::distribution::{ChiSquared, ContinuousCDF};

    use super::{BINS, Density, bin, bin_edges};
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

    #[test]
    fn bins_have_their_angles() {
        for angle in [0.0, 1e-300, 0.17453, 1.0, 3.0, TAU - 1e-9, TAU.next_down()] {
            let [from, to] = bin_edges(bin(angle));
            assert!(from <= angle && angle <= to, "{angle}");
        }
        assert_eq!((bin(0.0), bin(TAU.next_down()), bin(-0.1)), (0, 35, 35));
        assert_eq!(bin_edges(35)[1], TAU);
    }

    /// Over all bins the densities integrate to 1, and the counts to all equilibria.
    #[test]
    fn integrates_to_one() {
        let mut draws = Draws::new(10);
        for balls in [1, 2, 3, 5] {
            for groups in [alike(balls), differing(balls)] {
                let mut density = Density::default();
                for _ in 0..500 {
                    let beta = (0..balls).map(|_| draws.von_mises(2.0, 3.0)).collect();
                    density.add(&if groups.len() == 1 { sorted(beta) } else { beta }, &groups);
                }
                for fine in density.fine.values() {
                    let width = TAU / BINS as f64;
                    let estimate = fine.estimate();
                    let bins: Vec<[usize; 2]> = match balls {
                        2 => (0..BINS).flat_map(|i| (0..BINS).map(move |j| [i, j])).collect(),
                        _ => (0..BINS).map(|i| [i, 0]).collect(),
                    };
                    let all = bins.iter().map(|bins| estimate.at(bins)).sum::<f64>()
                        * width.powi(if balls == 2 { 2 } else { 1 });
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
        let positions: Vec<Vec<f64>> =
            (0..300).map(|_| vec![draws.von_mises(1.0, 2.0), TAU * draws.uniform()]).collect();
        let of = |positions: &mut dyn Iterator<Item = Vec<f64>>| {
            let mut density = Density::default();
            positions.for_each(|beta| density.add(&beta, &alike(2)));
            density
        };
        let forward = of(&mut positions.iter().cloned().map(sorted));
        assert_eq!(forward, of(&mut positions.iter().rev().cloned().map(sorted)));
        let density = forward.fine[&0].estimate();
        for (i, j) in (0..BINS).flat_map(|i| (0..BINS).map(move |j| (i, j))) {
            let [one, other] = [density.at(&[i, j]), density.at(&[j, i])];
            assert!((one - other).abs() <= 1e-12 * one, "{i} {j}: {one} {other}");
        }
        assert!(forward.bins().iter().all(|row| row.bins[0] <= row.bins[1]));
    }

    /// Two independent von Mises angles: the counts of the bins by a chi-square test at a level of 0.001.
    #[test]
    fn bins_count_a_known_distribution() {
        let mut draws = Draws::new(12);
        let (centres, concentrations) = ([2.0, 5.0], [2.0, 4.0]);
        let runs = 20_000;
        let mut density = Density::default();
        for _ in 0..runs {
            let beta = [0, 1].map(|i| draws.von_mises(centres[i], concentrations[i])).to_vec();
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
    }
}
