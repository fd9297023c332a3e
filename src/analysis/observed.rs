//! A finished run as statistics see it, and runs counted by their labels and by the labels of a second method.

use std::collections::BTreeMap;

use super::interval::{Z_95, simultaneous, wilson};
use crate::classification::{Evidence, Label, Outcome};
use crate::model::Case;

/// The parts of a finished run that the statistics use.
#[derive(Clone, Copy, Debug)]
pub struct ObservedRun<'a> {
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
