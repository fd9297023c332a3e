//! A finished run as statistics see it, and runs counted by their labels.

use super::interval::simultaneous;
use crate::classification::{Label, Outcome};
use crate::model::Case;

/// A finished run, as far as statistics look at it.
#[derive(Clone, Copy, Debug)]
pub struct Observed<'a> {
    /// Its cell in the sampling design; looked at where the design is stratified.
    pub cell: u64,
    /// What was computed; none where the parameters drawn made no physical sense.
    pub case: Option<&'a Case>,
    /// How it ended.
    pub outcome: &'a Outcome,
    /// How it ended when it was computed a second time, if it was.
    pub audit: Option<Label>,
}

/// Runs per label, in the order of [`Label::ALL`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LabelCounts([u64; 5]);

impl LabelCounts {
    /// Counts one run.
    pub fn add(&mut self, label: Label) {
        self.0[label as usize] += 1;
    }

    /// Counts several runs.
    pub fn add_many(&mut self, label: Label, runs: u64) {
        self.0[label as usize] += runs;
    }

    /// Runs with this label.
    pub fn of(&self, label: Label) -> u64 {
        self.0[label as usize]
    }

    /// All runs.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    /// Fraction of all runs that have this label; 0 where there are no runs.
    pub fn fraction(&self, label: Label) -> f64 {
        match self.total() {
            0 => 0.0,
            total => self.of(label) as f64 / total as f64,
        }
    }

    /// Intervals of the fractions of all labels, in the order of [`Label::ALL`], that hold together with
    /// 95 % (see [`simultaneous`]). They count runs one by one; cells of a design make them wider
    /// than need be, not wrong.
    pub fn intervals(&self) -> [(f64, f64); 5] {
        simultaneous(self.0)
    }
}

impl std::ops::AddAssign for LabelCounts {
    fn add_assign(&mut self, other: Self) {
        for (count, more) in self.0.iter_mut().zip(other.0) {
            *count += more;
        }
    }
}
