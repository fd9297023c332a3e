//! The forces and rates of a system in one state for assumed phases, as decisions between stick and slip need them.

use smallvec::SmallVec;

use super::evaluator::Forces;
use super::{Evaluator, Phase};
use crate::model::{Components, Dual};

/// A system in one state, for which the phases of its contacts are decided.
pub(super) trait ForceModel {
    /// Returns the static coefficient of friction of a contact.
    fn limit(&self, contact: usize) -> f64;
    /// Returns the sliding speed of a contact.
    fn speed(&self, contact: usize) -> f64;
    /// Returns the forces for assumed phases.
    fn forces(&self, phases: &[Phase]) -> Forces;
    /// Returns the time derivative of the state for assumed phases.
    fn rates(&self, phases: &[Phase]) -> Components;
    /// Returns the forces at the time [`AHEAD`] later, to first order, if the phases last.
    fn forces_ahead(&self, phases: &[Phase]) -> Forces;
    /// Returns the change of the sliding speed of a contact along a direction.
    fn speed_along(&self, contact: usize, direction: &[f64]) -> f64;
    /// Returns the forces with their changes along a direction.
    fn forces_along(&self, phases: &[Phase], direction: &[f64]) -> Forces<Dual>;
    /// Returns whether the phases are decided in exactly one way for any forces.
    fn has_one_solution(&self) -> bool;
    /// Returns the size of the forces, to which rounding errors are relative.
    fn force_scale(&self) -> f64;
}

/// Time interval for the rate of change of a condition, non-dimensional.
pub(super) const AHEAD: f64 = 1e-6;

/// A system in one state, by its recorded equations.
pub(super) struct RecordedForces<'a> {
    pub(super) evaluator: &'a Evaluator,
    pub(super) state: &'a [f64],
    pub(super) speeds: SmallVec<[f64; 8]>,
}

impl<'a> RecordedForces<'a> {
    pub(super) fn new(evaluator: &'a Evaluator, state: &'a [f64]) -> Self {
        RecordedForces { evaluator, state, speeds: evaluator.speeds(state) }
    }
}

impl ForceModel for RecordedForces<'_> {
    fn limit(&self, contact: usize) -> f64 {
        self.evaluator.system().friction(contact).limit
    }

    fn speed(&self, contact: usize) -> f64 {
        self.speeds[contact]
    }

    fn forces(&self, phases: &[Phase]) -> Forces {
        self.evaluator.forces(phases, self.state)
    }

    fn rates(&self, phases: &[Phase]) -> Components {
        self.evaluator.rates(phases, self.state)
    }

    fn forces_ahead(&self, phases: &[Phase]) -> Forces {
        let rates = self.rates(phases);
        let ahead = self.state.iter().zip(&rates).map(|(value, rate)| value + AHEAD * rate);
        self.evaluator.forces(phases, &ahead.collect::<Components>())
    }

    fn speed_along(&self, contact: usize, direction: &[f64]) -> f64 {
        match self.evaluator.graph().speed_component(contact) {
            Some(component) => direction[component],
            // Sliding speeds do not depend on phases.
            None => {
                let phases = self.evaluator.no_phases();
                self.forces_along(&phases, direction)[contact].speed.slope
            }
        }
    }

    fn forces_along(&self, phases: &[Phase], direction: &[f64]) -> Forces<Dual> {
        self.evaluator.forces_along(phases, self.state, direction)
    }

    fn has_one_solution(&self) -> bool {
        let system = self.evaluator.system();
        system.surely_one_solution() || system.one_solution_at(self.state)
    }

    fn force_scale(&self) -> f64 {
        self.evaluator.system().force_scale()
    }
}
