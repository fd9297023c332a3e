//! A finished run as statistics see it, and runs counted by their labels.

use std::collections::BTreeMap;

use super::interval::simultaneous;
use crate::classification::{Evidence, Label, Outcome};
use crate::model::Case;

/// The parts of a finished run that the statistics use.
#[derive(Clone, Copy, Debug)]
pub struct Observed<'a> {
    /// Number of the run's cell in the sampling design; used only if the design is stratified.
    pub cell: u64,
    /// The simulated case; `None` if the sampled parameters were physically invalid.
    pub case: Option<&'a Case>,
    /// How the run ended.
    pub outcome: &'a Outcome,
    /// Label of the second computation, if the run was audited.
    pub audit: Option<Label>,
}

/// Number of runs per label, in the order of [`Label::ALL`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LabelCounts([u64; LABELS]);

/// The number of labels.
const LABELS: usize = Label::ALL.len();

impl LabelCounts {
    /// Counts one run.
    pub fn add(&mut self, label: Label) {
        self.0[label as usize] += 1;
    }

    /// Counts several runs.
    pub fn add_many(&mut self, label: Label, runs: u64) {
        self.0[label as usize] += runs;
    }

    /// Returns the number of runs with this label.
    pub fn of(&self, label: Label) -> u64 {
        self.0[label as usize]
    }

    /// Returns the number of all runs.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    /// Returns the fraction of all runs with this label; 0 if there are no runs.
    pub fn fraction(&self, label: Label) -> f64 {
        match self.total() {
            0 => 0.0,
            total => self.of(label) as f64 / total as f64,
        }
    }

    /// Returns intervals of the fractions of all labels, in the order of [`Label::ALL`], that hold
    /// jointly at 95 % (see [`simultaneous`]). They treat runs as independent; with a stratified
    /// design they are valid, but wider than necessary.
    pub fn intervals(&self) -> [(f64, f64); LABELS] {
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

/// Number of failed runs by the kind of failure.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FailureCounts(BTreeMap<&'static str, u64>);

impl FailureCounts {
    /// Counts a run if it failed.
    pub fn add(&mut self, evidence: &Evidence) {
        if evidence.label() == Label::Failed {
            *self.0.entry(evidence.name()).or_default() += 1;
        }
    }

    /// Returns the number of runs of each kind that occurred, by the name of its evidence.
    pub fn by_name(&self) -> BTreeMap<String, u64> {
        self.0.iter().map(|(name, runs)| ((*name).to_owned(), *runs)).collect()
    }
}
