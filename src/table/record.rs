//! One row of the run table: what was planned and what came out.

use crate::analysis::Observed;
use crate::classification::{Evidence, Outcome};
use crate::study::PlannedRun;

/// A run with its outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRecord {
    /// The run as planned.
    pub planned: PlannedRun,
    /// How it ended.
    pub outcome: Outcome,
    /// Why it ended as it did when it was computed a second time, if it was.
    pub audit: Option<Evidence>,
}

impl RunRecord {
    /// The run as statistics see it.
    pub fn observed(&self) -> Observed<'_> {
        Observed {
            cell: self.planned.cell,
            case: self.planned.case.as_ref().ok(),
            outcome: &self.outcome,
            audit: self.audit.map(Evidence::label),
        }
    }
}
