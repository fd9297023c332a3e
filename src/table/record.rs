//! One row of the run table: what was planned and what came out.

use crate::analysis::{Nearest, Observed};
use crate::ending::Outcome;
use crate::study::PlannedRun;

/// A run with its outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRecord {
    /// The run as planned.
    pub planned: PlannedRun,
    /// How it ended.
    pub outcome: Outcome,
    /// The stable equilibrium without friction that is nearest to where it came to rest.
    pub nearest: Option<Nearest>,
}

impl RunRecord {
    /// The run as statistics see it.
    pub fn observed(&self) -> Observed<'_> {
        Observed {
            cell: self.planned.cell,
            case: self.planned.case.as_ref().ok(),
            outcome: &self.outcome,
            nearest: self.nearest,
        }
    }
}
