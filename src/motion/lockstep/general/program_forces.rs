//! Forces of one run at one instant for assumed phases, by the programs of the motion: the modes of contacts are decided with
//! the same numbers with which the step begins.

use std::cell::RefCell;

use super::compiled::Compiled;
use super::operations::Operations;
use crate::graph::Program;
use crate::model::{Components, Dual, System};
use crate::motion::evaluator::{ContactForces, Evaluator, Forces};
use crate::motion::joint_decision::{AHEAD, ForceModel, RecordedForces};
use crate::motion::lockstep::lane::Lane;
use crate::motion::lockstep::vector::Vector;
use crate::motion::{Phase, Phases};

/// The largest number of assumptions about the phases of a run whose inputs are remembered.
const MOST_KNOWN: usize = 64;

/// What decisions in one lane of a group need.
#[derive(Default)]
pub(super) struct DecisionMemory {
    /// The cells of the programs, with the parameters of the run.
    pub(super) memory: Vec<f64>,
    /// Phases with the inputs that depend on them.
    known: Vec<(Phases, Vec<f64>)>,
    /// The phases whose forces the cells contain.
    latest: Option<Phases>,
}

impl DecisionMemory {
    /// Prepares the decisions of another run.
    pub(super) fn begin(&mut self, program: &Program) {
        self.known.clear();
        self.latest = None;
        if self.memory.is_empty() {
            self.memory = vec![0.0; program.cells];
            for (cell, number) in program.numbers.iter() {
                self.memory[*cell as usize] = *number;
            }
        }
    }

    /// Sets the inputs that depend on phases.
    ///
    /// # Panics
    /// Panics if a parameter depends on phases: a system with such a parameter is a programming error.
    pub(super) fn set_inputs(
        &mut self,
        operations: &Operations,
        system: &dyn System,
        phases: &[Phase],
    ) {
        let known = &mut self.known;
        let place = known.iter().position(|(of, _)| of[..] == *phases).unwrap_or_else(|| {
            let modes: Vec<_> = phases.iter().map(|phase| phase.mode()).collect();
            let all = system.inputs(&modes);
            for (cell, input) in &operations.inputs[1] {
                let [known, now] = [self.memory[*cell as usize], all[*input as usize]];
                let is_same = known.to_bits() == now.to_bits();
                assert!(is_same, "parameter {input} depends on modes: {known} and {now}");
            }
            let of_modes = operations.inputs[0].iter().map(|(_, input)| all[*input as usize]);
            if known.len() == MOST_KNOWN {
                known.clear();
            }
            known.push((Phases::from_slice(phases), of_modes.collect()));
            known.len() - 1
        });
        for ((cell, _), value) in operations.inputs[0].iter().zip(&known[place].1) {
            self.memory[*cell as usize] = *value;
        }
    }
}

/// A run at one instant. Friction forces are those that contacts require to stick.
pub(super) struct ProgramForces<'a, S: Vector> {
    simd: S,
    program: &'a Compiled,
    run: &'a Lane,
    evaluator: &'a Evaluator,
    state: &'a [f64],
    scratch: RefCell<&'a mut DecisionMemory>,
}

impl<'a, S: Vector> ProgramForces<'a, S> {
    /// Returns the run of a lane in a state.
    pub(super) fn new(
        (simd, program): (S, &'a Compiled),
        (run, evaluator): (&'a Lane, &'a Evaluator),
        state: &'a [f64],
        scratch: &'a mut DecisionMemory,
    ) -> Self {
        let Compiled { operations, programs, .. } = program;
        let first = operations.coefficient(0, 0) as usize;
        scratch.memory[first..][..state.len()].copy_from_slice(state);
        for (cell, component) in &operations.discrete {
            scratch.memory[*cell as usize] = state[*component as usize];
        }
        programs.instant.run(simd, &mut scratch.memory);
        scratch.latest = None;
        ProgramForces { simd, program, run, evaluator, state, scratch: RefCell::new(scratch) }
    }

    /// Computes rates and forces for assumed phases.
    fn assume(&self, phases: &[Phase]) {
        let scratch = &mut **self.scratch.borrow_mut();
        if scratch.latest.as_deref() == Some(phases) {
            return;
        }
        let Compiled { operations, programs, .. } = self.program;
        scratch.set_inputs(operations, self.run.system.as_ref(), phases);
        programs.decision.run(self.simd, &mut scratch.memory);
        scratch.latest = Some(Phases::from_slice(phases));
    }

    /// Returns the coefficients of speed, acceleration and forces of each contact of an order.
    fn coefficients(&self, k: usize) -> Forces {
        let operations = &self.program.operations;
        let scratch = self.scratch.borrow();
        let of_order = &scratch.memory[operations.coefficient(0, k) as usize..];
        let forces = |contact: &[u32; 4]| {
            let [speed, acceleration, normal, friction] =
                contact.map(|slot| of_order[slot as usize]);
            ContactForces { speed, acceleration, normal, friction }
        };
        operations.contacts.iter().map(forces).collect()
    }
}

impl<S: Vector> ForceModel for ProgramForces<'_, S> {
    fn limit(&self, contact: usize) -> f64 {
        self.run.limits[contact]
    }

    fn speed(&self, contact: usize) -> f64 {
        let operations = &self.program.operations;
        let cell = operations.coefficient(operations.contacts[contact][0], 0);
        self.scratch.borrow().memory[cell as usize]
    }

    fn forces(&self, phases: &[Phase]) -> Forces {
        self.assume(phases);
        self.coefficients(0)
    }

    fn rates(&self, phases: &[Phase]) -> Components {
        self.assume(phases);
        let operations = &self.program.operations;
        let scratch = self.scratch.borrow();
        let rate = |slot: &u32| scratch.memory[operations.coefficient(*slot, 0) as usize];
        operations.rates.iter().map(rate).collect()
    }

    fn forces_ahead(&self, phases: &[Phase]) -> Forces {
        self.assume(phases);
        let ahead = &self.program.programs.ahead;
        ahead.run(self.simd, &mut self.scratch.borrow_mut().memory);
        let mut forces = self.coefficients(0);
        for (now, change) in forces.iter_mut().zip(self.coefficients(1)) {
            now.speed += AHEAD * change.speed;
            now.acceleration += AHEAD * change.acceleration;
            now.normal += AHEAD * change.normal;
            now.friction += AHEAD * change.friction;
        }
        forces
    }

    fn speed_along(&self, contact: usize, direction: &[f64]) -> f64 {
        match self.evaluator.graph().speed_component(contact) {
            Some(component) => direction[component],
            None => RecordedForces::new(self.evaluator, self.state).speed_along(contact, direction),
        }
    }

    fn forces_along(&self, phases: &[Phase], direction: &[f64]) -> Forces<Dual> {
        self.evaluator.forces_along(phases, self.state, direction)
    }

    fn has_one_solution(&self) -> bool {
        self.run.surely_one_solution || self.run.system.one_solution_at(self.state)
    }

    fn force_scale(&self) -> f64 {
        self.run.force_scale
    }
}
