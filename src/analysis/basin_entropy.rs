//! Basin entropy: how uncertain the class of the outcome is for start states within one cell of a stratified design.
//!
//! With `H` cells and the probability `p_hc` of the outcome `c` in the cell `h`, the basin entropy is
//!
//! ```text
//! S_b = 1/H Σ_h S_h        S_h = -Σ_c p_hc ln p_hc
//! ```
//!
//! (A. Daza, A. Wagemakers, B. Georgeot, D. Guéry-Odelin, M. A. F. Sanjuán, Sci. Rep. 6 (2016) 31416,
//! doi:10.1038/srep31416). The outcomes are rest, each class of limit cycles, irregular motion, and undecided runs. Failed
//! runs are excluded. `S_b` is 0 if the cell of the start state determines the outcome, and `ln C` if `C` outcomes are
//! equally probable in every cell.
//!
//! The entropy of a cell is estimated as by Z. Zhang, Neural Comput. 24 (2012) 1368, doi:10.1162/NECO_a_00266, because the
//! frequencies of few runs underestimate it: `docs/methods.md` compares the estimates.

use std::collections::BTreeMap;

use super::cycles::MOST_CLASSES;
use super::stratified::cells_counted;
use crate::classification::Label;

/// The number of an outcome: that of its label, or from `Label::ALL.len()` on that of a class of limit cycles. The number of
/// the label of limit cycles belongs to the classes that are not counted separately.
type OutcomeNumber = u32;

const OTHER_CYCLES: OutcomeNumber = Label::LimitCycle as OutcomeNumber;

/// The outcomes of the runs of a point, by cell.
///
/// Above 1000 classes of limit cycles, those with the shortest and then the alphabetically first names are counted
/// separately, as in `cycles.parquet`.
#[derive(Clone, Debug, Default)]
pub struct Basins {
    /// Number of runs of each outcome that occurs in the cell.
    cells: Vec<Vec<(OutcomeNumber, u64)>>,
    /// Keyed by the length of the name, then by the name.
    classes: BTreeMap<(usize, String), OutcomeNumber>,
}

impl Basins {
    /// Creates this number of empty cells of equal size. With a single cell or more than 65,536 cells the design counts as
    /// not stratified.
    pub fn new(cells: u64) -> Self {
        Basins { cells: vec![Vec::new(); cells_counted(cells)], ..Basins::default() }
    }

    /// Counts a run; `class` is the class of its limit cycle. Failed runs are ignored.
    pub fn add(&mut self, cell: u64, label: Label, class: Option<&str>) {
        let cell = usize::try_from(cell).ok().filter(|&cell| cell < self.cells.len());
        let Some(cell) = cell.filter(|_| label != Label::Failed) else { return };
        let outcome = match class {
            Some(class) if label == Label::LimitCycle => self.number(class),
            _ => label as OutcomeNumber,
        };
        count(&mut self.cells[cell], outcome, 1);
    }

    /// Returns the number of a class of limit cycles.
    fn number(&mut self, class: &str) -> OutcomeNumber {
        let key = (class.len(), class.to_owned());
        if let Some(&number) = self.classes.get(&key) {
            return number;
        }
        let number = if self.classes.len() < MOST_CLASSES {
            (Label::ALL.len() + self.classes.len()) as OutcomeNumber
        } else {
            let last = self.classes.last_entry().filter(|last| *last.key() > key);
            let Some(last) = last else { return OTHER_CYCLES };
            let freed = last.remove();
            self.count_as_other(freed);
            freed
        };
        self.classes.insert(key, number);
        number
    }

    /// Counts the runs of a class of limit cycles with those of the classes that are not counted separately.
    fn count_as_other(&mut self, number: OutcomeNumber) {
        for cell in &mut self.cells {
            if let Some(place) = cell.iter().position(|(outcome, _)| *outcome == number) {
                let (_, runs) = cell.swap_remove(place);
                count(cell, OTHER_CYCLES, runs);
            }
        }
    }

    /// Returns the basin entropy: the mean over the cells with at least two runs that did not fail, or `None` if there is no
    /// such cell.
    pub fn entropy(&self) -> Option<f64> {
        let entropies = || self.cells.iter().filter_map(|cell| cell_entropy(cell));
        let cells = entropies().count();
        (cells > 0).then(|| entropies().sum::<f64>() / cells as f64)
    }
}

fn count(cell: &mut Vec<(OutcomeNumber, u64)>, outcome: OutcomeNumber, runs: u64) {
    match cell.iter_mut().find(|(other, _)| *other == outcome) {
        Some((_, counted)) => *counted += runs,
        None => cell.push((outcome, runs)),
    }
}

/// Returns Zhang's estimate of the entropy of a cell, or `None` with fewer than two runs.
fn cell_entropy(cell: &[(OutcomeNumber, u64)]) -> Option<f64> {
    let mut counts: Vec<u64> = cell.iter().map(|(_, runs)| *runs).collect();
    // The result does not depend on the order in which the outcomes occur.
    counts.sort_unstable();
    let runs: u64 = counts.iter().sum();
    let inverses = |from: u64| (from..runs).fold(0.0, |sum, j| sum + 1.0 / j as f64);
    let sum = counts.iter().fold(0.0, |sum, &of| sum + of as f64 * inverses(of));
    (runs >= 2).then(|| sum / runs as f64)
}
