//! Forces of one run at one instant for assumed phases, by the programs of the motion: the modes of contacts are decided with
//! the same numbers with which the step begins.

use std::cell::RefCell;

use smallvec::SmallVec;

use super::{Compiled, General};
use crate::model::{Components, Dual, Friction};
use crate::motion::Phase;
use crate::motion::evaluator::{ContactForces, Forces};
use crate::motion::lockstep::Lanes;
use crate::motion::lockstep::lane::Lane;
use crate::motion::lockstep::vector::Vector;
use crate::motion::modes::{AHEAD, Evaluated, InState};

/// The first lane of a memory, in which one state is examined.
const LANE: usize = 0;

/// A run at one instant. Friction forces are those that contacts require to stick.
pub(super) struct Deciding<'a, S: Vector> {
    pub(super) general: &'a General<S>,
    pub(super) own: &'a Lane,
    pub(super) equations: Evaluated<'a>,
    /// The cells of the programs, with the state.
    pub(super) memory: RefCell<&'a mut [Lanes<S>]>,
}

impl<S: Vector> Deciding<'_, S> {
    /// Computes rates and forces for assumed phases.
    fn assume(&self, phases: &[Phase]) {
        let Compiled { operations, statics, instant, .. } = &*self.general.program;
        let memory = &mut **self.memory.borrow_mut();
        let inputs = self.equations.evaluator.inputs(phases);
        operations.statics.set(&inputs, self.equations.state, |id, value| {
            memory[id as usize][LANE] = value;
        });
        statics.run(self.general.simd, memory);
        instant.run(self.general.simd, memory);
    }

    /// Returns a coefficient of speed, acceleration and forces of each contact.
    fn coefficients(&self, k: usize) -> impl Iterator<Item = [f64; 4]> {
        let operations = &self.general.program.operations;
        let memory = self.memory.borrow();
        operations.contacts.iter().map(move |contact| {
            contact.map(|slot| memory[operations.coefficient(slot, k) as usize][LANE])
        })
    }
}

fn forces([speed, acceleration, normal, friction]: [f64; 4]) -> ContactForces {
    ContactForces { speed, acceleration, normal, friction }
}

impl<S: Vector> InState for Deciding<'_, S> {
    fn friction(&self, contact: usize) -> &Friction {
        self.own.system.friction(contact)
    }

    fn speed(&self, contact: usize) -> f64 {
        self.equations.speed(contact)
    }

    fn forces(&self, phases: &[Phase]) -> Forces {
        self.assume(phases);
        self.coefficients(0).map(forces).collect()
    }

    fn rates(&self, phases: &[Phase]) -> Components {
        self.assume(phases);
        let operations = &self.general.program.operations;
        let memory = self.memory.borrow();
        let rate = |slot: &u32| memory[operations.coefficient(*slot, 0) as usize][LANE];
        operations.rates.iter().map(rate).collect()
    }

    fn forces_ahead(&self, phases: &[Phase]) -> Forces {
        self.assume(phases);
        let now: SmallVec<[[f64; 4]; 8]> = self.coefficients(0).collect();
        self.general.program.ahead.run(self.general.simd, &mut self.memory.borrow_mut());
        let changes = now.iter().zip(self.coefficients(1));
        changes
            .map(|(now, change)| forces(std::array::from_fn(|i| now[i] + AHEAD * change[i])))
            .collect()
    }

    fn speed_along(&self, contact: usize, direction: &[f64]) -> f64 {
        self.equations.speed_along(contact, direction)
    }

    fn forces_along(&self, phases: &[Phase], direction: &[f64]) -> Forces<Dual> {
        self.equations.forces_along(phases, direction)
    }

    fn has_one_solution(&self) -> bool {
        self.own.surely_one_solution || self.own.system.one_solution_at(self.equations.state)
    }

    fn force_scale(&self) -> f64 {
        self.own.system.force_scale()
    }
}
