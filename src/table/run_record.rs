//! One row of the run table: the planned run and its outcome.

use crate::analysis::{Observed, relative_amplitude};
use crate::classification::{Evidence, Outcome};
use crate::study::PlannedRun;

/// A run with its outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRecord {
    /// The run as planned.
    pub planned: PlannedRun,
    /// How it ended.
    pub outcome: Outcome,
    /// Evidence of the audit, if the run was recomputed.
    pub audit: Option<Evidence>,
}

impl RunRecord {
    /// Returns the run as the statistics use it.
    pub fn observed(&self) -> Observed<'_> {
        Observed {
            cell: self.planned.cell,
            case: self.planned.case.as_ref().ok(),
            outcome: &self.outcome,
            audit: self.audit.as_ref().map(Evidence::label),
        }
    }

    /// Returns the amplitude divided by that of the run's own machine without balls, see [`relative_amplitude`].
    pub fn relative_amplitude(&self) -> Option<f64> {
        let machine = self.planned.case.as_ref().ok()?.model.ball_balancer()?;
        relative_amplitude(machine, self.outcome.amplitude_m?)
    }
}
