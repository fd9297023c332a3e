//! Histograms of the angles at which balls come to rest.
//!
//! One or two angles are counted jointly. With three or more balls, each ball's angle is counted on
//! its own, and the angles of identical balls share one histogram. Bins are 10° wide. Two identical
//! balls are interchangeable: each equilibrium counts in the bin of its angles in ascending order.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::interval::{Z_95, wilson};

/// Number of bins per angle.
pub const BINS: usize = 36;

/// Returns the bin of an angle, counted from 0.
pub fn bin(angle: f64) -> usize {
    ((angle.rem_euclid(TAU) / TAU * BINS as f64) as usize).min(BINS - 1)
}

/// Returns the start and the end of a bin, rad.
pub fn bin_edges(bin: usize) -> [f64; 2] {
    [bin, bin + 1].map(|edge| edge as f64 * (TAU / BINS as f64))
}

/// One bin in which balls came to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct HistogramBin {
    /// With three or more balls: the first of the identical balls whose angles the bin counts, from
    /// 0.
    pub ball: usize,
    /// The bin of each angle: one or two.
    pub bins: Vec<usize>,
    /// Number of equilibria in the bin; with three or more balls, the number with at least one of
    /// the balls in it.
    pub runs: u64,
    /// Fraction of all equilibria of the point.
    pub fraction: f64,
    /// 95 % interval of the fraction (Wilson).
    pub interval: (f64, f64),
}

/// Collects the equilibria of one point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EquilibriumHistogram {
    equilibria: u64,
    /// Number of equilibria, by ball and bins.
    counts: BTreeMap<(usize, Vec<usize>), u64>,
}

impl EquilibriumHistogram {
    /// Adds the angles of balls at rest, ascending among identical balls. `groups` has the indices
    /// of identical balls, each ball in one group.
    pub fn add(&mut self, beta: &[f64], groups: &[Vec<usize>]) {
        self.equilibria += 1;
        if beta.len() <= 2 {
            self.count(0, beta.iter().copied().map(bin).collect());
            return;
        }
        for group in groups {
            let mut bins: Vec<usize> = group.iter().map(|&ball| bin(beta[ball])).collect();
            bins.sort_unstable();
            bins.dedup();
            bins.into_iter().for_each(|bin| self.count(group[0], vec![bin]));
        }
    }

    fn count(&mut self, ball: usize, bins: Vec<usize>) {
        *self.counts.entry((ball, bins)).or_default() += 1;
    }

    /// Returns the bins in which balls came to rest, in ascending order.
    pub fn bins(&self) -> Vec<HistogramBin> {
        let row = |((ball, bins), &runs): (&(usize, Vec<usize>), &u64)| HistogramBin {
            ball: *ball,
            bins: bins.clone(),
            runs,
            fraction: runs as f64 / self.equilibria as f64,
            interval: wilson(runs, self.equilibria, Z_95),
        };
        self.counts.iter().map(row).collect()
    }
}
