//! Confidence interval of a fraction of runs with stratified start states.
//!
//! Cells of equal size partition the box of start states, and each has its own samples, so that
//! only the variation *within* cells, including that of parameters sampled for each run, makes the
//! mean of the cells' fractions uncertain. With `H` cells, `n_h` samples and `k_h` successes in
//! each, the fraction is `p = Σ p_h / H` with `p_h = k_h / n_h`, and an unbiased estimate of its
//! variance is
//!
//! ```text
//! V = Σ p_h (1 - p_h) / (n_h - 1) / H²
//! ```
//!
//! (W. G. Cochran, Sampling Techniques, 3rd ed., Wiley 1977, section 5.4). The effective number of
//! runs without cells is `p (1 - p) / V`; used as the number of trials in Wilson's interval, it
//! gives an interval for a stratified sample (X. Yan, X. G. Su, Stat. Biopharm. Res. 2 (2010) 329,
//! doi:10.1198/sbr.2009.0049).
//!
//! This interval is wrong if few cells are mixed, because their number is then poorly known: two or
//! three samples that agree do not prove that a cell is pure. (With 16 cells of two samples each,
//! half of them with a fraction of 1 and half with 0.005, no mixed cell is observed in 92 % of all
//! samples; the estimated variance is then 0 and the interval is wrong.) There are therefore two
//! bounds. The variance of `z²/2` additional mixed cells is added, just as Wilson's interval adds
//! `z²/2` successes and as many failures; one mixed cell contributes about `1 / (H n)²`, with `n`
//! the least `n_h`. And the effective number of runs is at least `H n`, because stratification
//! never increases the variance.
//!
//! `docs/methods.md` has the coverage in simulated samples.

use super::interval::{Z_95, score_interval};

/// Largest number of cells that are counted separately.
const MOST_CELLS: u64 = 1 << 16;

/// Returns how many cells are counted: all, or none with a single cell or more than 65,536.
pub(super) fn cells_counted(cells: u64) -> usize {
    if (2..=MOST_CELLS).contains(&cells) { cells as usize } else { 0 }
}

/// Counts of one cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct CellCounts {
    runs: u64,
    equilibria: u64,
    failures: u64,
}

/// The runs of a point, by cell.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StratifiedCells(Vec<CellCounts>);

impl StratifiedCells {
    /// Creates this number of empty cells of equal size. With a single cell or more than 65,536
    /// cells the design counts as not stratified.
    pub fn new(cells: u64) -> Self {
        StratifiedCells(vec![CellCounts::default(); cells_counted(cells)])
    }

    /// Counts a run.
    pub fn add(&mut self, cell: u64, equilibrium: bool, failed: bool) {
        if let Some(cell) = usize::try_from(cell).ok().and_then(|cell| self.0.get_mut(cell)) {
            cell.runs += 1;
            cell.equilibria += u64::from(equilibrium);
            cell.failures += u64::from(failed);
        }
    }

    /// Returns the smallest number of runs in a cell, or `None` if it is less than two: the
    /// variation of such a cell is unknown.
    fn fewest(&self) -> Option<f64> {
        self.0.iter().map(|cell| cell.runs).min().filter(|&runs| runs >= 2).map(|runs| runs as f64)
    }

    /// Returns the fraction of equilibria with equal weights of all cells, or `None` if a cell has
    /// too few runs.
    pub fn fraction(&self) -> Option<f64> {
        self.fewest().map(|_| self.mean(|cell| cell.equilibria))
    }

    /// Returns the 95 % interval of the fraction, from the lower end with no failed run as an
    /// equilibrium to the upper end with all of them, or `None` if a cell has too few runs.
    pub fn interval(&self) -> Option<(f64, f64)> {
        let low = self.interval_of(|cell| cell.equilibria)?.0;
        let high = self.interval_of(|cell| cell.equilibria + cell.failures)?.1;
        Some((low, high))
    }

    fn mean(&self, successes: impl Fn(&CellCounts) -> u64) -> f64 {
        let equal = self.0.iter().all(|cell| cell.runs == self.0[0].runs);
        if equal {
            // The result has the same bits as the fraction of all runs.
            let successes: u64 = self.0.iter().map(successes).sum();
            let runs: u64 = self.0.iter().map(|cell| cell.runs).sum();
            return successes as f64 / runs as f64;
        }
        let fractions = self.0.iter().map(|cell| successes(cell) as f64 / cell.runs as f64);
        fractions.sum::<f64>() / self.0.len() as f64
    }

    fn interval_of(&self, successes: impl Fn(&CellCounts) -> u64 + Copy) -> Option<(f64, f64)> {
        let fewest = self.fewest()?;
        let cells = self.0.len() as f64;
        let within = self.0.iter().map(|cell| {
            let fraction = successes(cell) as f64 / cell.runs as f64;
            fraction * (1.0 - fraction) / (cell.runs - 1) as f64
        });
        let mixed_cells_more = 0.5 * Z_95 * Z_95;
        let variance =
            (within.sum::<f64>() + mixed_cells_more / (fewest * fewest)) / (cells * cells);
        let fraction = self.mean(successes);
        let trials = (fraction * (1.0 - fraction) / variance).max(cells * fewest);
        Some(score_interval(fraction, trials, Z_95))
    }
}
