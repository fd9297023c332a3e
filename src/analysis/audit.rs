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

#[cfg(test)]
mod tests {
    use super::AuditCounts;
    use crate::classification::Label;

    #[test]
    fn other_labels_and_failures_on_one_side_are_flips() {
        let mut counts = AuditCounts::default();
        assert_eq!((counts.flip_rate(), counts.interval()), (None, (0.0, 1.0)));
        for first in Label::ALL {
            for second in Label::ALL {
                counts.add(first, second);
            }
        }
        assert_eq!(counts, AuditCounts { runs: 25, flips: 20, rest_flips: 8 });
        assert_eq!(counts.flip_rate(), Some(0.8));
        // The roots of |p - 0.8| = z sqrt(p (1 - p) / 25).
        let (low, high) = counts.interval();
        for end in [low, high] {
            let score =
                (end - 0.8).abs() - 1.959_963_984_540_054 * (end * (1.0 - end) / 25.0).sqrt();
            assert!(score.abs() < 1e-12, "{end}");
        }
    }
}
