//! How often a run gets another label when it is computed by a second method.

use super::interval::{Z_95, wilson};
use crate::classification::Label;

/// Counts of audited runs and flips. A flip is a run whose second computation has another label, or
/// in which only one of the two computations fails.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AuditCounts {
    /// Runs that were computed twice.
    pub runs: u64,
    /// Runs whose two labels differ.
    pub flips: u64,
    /// Flips that are an equilibrium in exactly one of the two computations. Only these change the
    /// fraction of equilibria.
    pub rest_flips: u64,
}

impl AuditCounts {
    /// Counts a run with the labels of its two computations.
    pub fn add(&mut self, first: Label, second: Label) {
        self.runs += 1;
        self.flips += u64::from(first != second);
        let rests = [first, second].map(|label| label == Label::Equilibrium);
        self.rest_flips += u64::from(rests[0] != rests[1]);
    }

    /// Returns the fraction of the audited runs that flip, or `None` if no run was audited.
    pub fn flip_rate(&self) -> Option<f64> {
        (self.runs > 0).then(|| self.flips as f64 / self.runs as f64)
    }

    /// Returns the 95 % Wilson interval of the flip rate; [0, 1] if no run was audited.
    pub fn interval(&self) -> (f64, f64) {
        wilson(self.flips, self.runs, Z_95)
    }
}
