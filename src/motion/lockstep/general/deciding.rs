//! Forces of one run at one instant for assumed phases, by the programs of the motion: the modes of contacts are decided with
//! the same numbers with which the step begins.
//!
//! Each lane has another assumption about the phases: the first that is asked for, and those that are likely to be asked for
//! next.

use std::cell::RefCell;

use fearless_simd::prelude::*;
use smallvec::SmallVec;

use super::operations::Operations;
use super::{Compiled, General};
use crate::graph::Program;
use crate::model::{Components, Dual, Friction, Method, System};
use crate::motion::evaluator::{ContactForces, Forces};
use crate::motion::lockstep::lane::Lane;
use crate::motion::lockstep::vector::Vector;
use crate::motion::lockstep::{LANES, Lanes};
use crate::motion::modes::{AHEAD, Evaluated, InState};
use crate::motion::{Direction, Phase, Phases};

/// The largest number of assumptions about the phases of a run whose inputs are remembered.
const MOST_KNOWN: usize = 64;

/// What decisions in one lane of a group need.
pub(super) struct Scratch<S: Vector> {
    /// The cells of the programs, with the parameters of the run.
    pub(super) memory: Vec<Lanes<S>>,
    /// Phases with the inputs that depend on them.
    known: Vec<(Phases, Vec<f64>)>,
    batches: Vec<Batch<S>>,
    /// The place of the batch whose results the cells contain.
    latest: Option<usize>,
}

/// Assumptions about the phases that are examined together.
struct Batch<S: Vector> {
    /// Bit mask of the contacts at rest.
    at_rest: u64,
    /// The phases in each lane of the memory, those that are asked for first.
    phases: Vec<Phases>,
    /// The inputs that depend on phases.
    inputs: Vec<Lanes<S>>,
}

impl<S: Vector> Scratch<S> {
    pub(super) fn new() -> Self {
        Scratch { memory: Vec::new(), known: Vec::new(), batches: Vec::new(), latest: None }
    }

    /// Prepares the decisions of another run.
    pub(super) fn begin(&mut self, simd: S, program: &Program) {
        self.known.clear();
        self.batches.clear();
        if self.memory.is_empty() {
            self.memory = vec![Lanes::splat(simd, 0.0); program.cells];
            for (cell, number) in program.numbers.iter() {
                self.memory[*cell as usize] = Lanes::splat(simd, *number);
            }
        }
    }

    /// Returns the inputs that depend on phases.
    ///
    /// # Panics
    /// Panics if a parameter depends on phases: a system with such a parameter is a programming error.
    pub(super) fn inputs(
        &mut self,
        operations: &Operations,
        system: &dyn System,
        phases: &[Phase],
    ) -> &[f64] {
        let known = &mut self.known;
        let place = known.iter().position(|(of, _)| of[..] == *phases).unwrap_or_else(|| {
            let modes: SmallVec<[_; 8]> = phases.iter().map(|phase| phase.mode()).collect();
            let all = system.inputs(&modes);
            for (cell, input) in &operations.inputs[1] {
                let [known, now] = [self.memory[*cell as usize][0], all[*input as usize]];
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
        &known[place].1
    }
}

/// A run at one instant. Friction forces are those that contacts require to stick.
pub(super) struct Deciding<'a, S: Vector> {
    general: &'a General<S>,
    own: &'a Lane,
    equations: Evaluated<'a>,
    scratch: RefCell<&'a mut Scratch<S>>,
}

impl<'a, S: Vector> Deciding<'a, S> {
    /// Returns the run of a lane in a state.
    pub(super) fn new(
        general: &'a General<S>,
        own: &'a Lane,
        equations: Evaluated<'a>,
        scratch: &'a mut Scratch<S>,
    ) -> Self {
        let Compiled { operations, instant, .. } = &*general.program;
        let splat = |value: f64| Lanes::splat(general.simd, value);
        for (slot, value) in (0..).zip(equations.state) {
            scratch.memory[operations.coefficient(slot, 0) as usize] = splat(*value);
        }
        for (cell, component) in &operations.discrete {
            scratch.memory[*cell as usize] = splat(equations.state[*component as usize]);
        }
        instant.run(general.simd, &mut scratch.memory);
        scratch.latest = None;
        Deciding { general, own, equations, scratch: RefCell::new(scratch) }
    }

    /// Computes rates and forces for assumed phases. Returns their lane.
    fn assume(&self, phases: &[Phase]) -> usize {
        let scratch = &mut **self.scratch.borrow_mut();
        if let Some(latest) = scratch.latest {
            let all = &scratch.batches[latest].phases;
            if let Some(lane) = all.iter().position(|one| one[..] == *phases) {
                return lane;
            }
        }
        let at_rest = self.at_rest(phases);
        let is_same = |batch: &Batch<S>| batch.at_rest == at_rest && batch.phases[0][..] == *phases;
        let place = match scratch.batches.iter().position(is_same) {
            Some(place) => place,
            None => self.add_batch(scratch, phases, at_rest),
        };
        let Compiled { operations, decision, .. } = &*self.general.program;
        let Scratch { memory, batches, .. } = scratch;
        for ((cell, _), inputs) in operations.inputs[0].iter().zip(&batches[place].inputs) {
            memory[*cell as usize] = *inputs;
        }
        scratch.latest = Some(place);
        decision.run(self.general.simd, &mut scratch.memory);
        0
    }

    /// Returns which contacts are at rest, as a bit mask.
    fn at_rest(&self, phases: &[Phase]) -> u64 {
        let mut mask = 0;
        let contacts = self.general.speeds.len().min(64);
        for (contact, phase) in phases[..contacts].iter().enumerate() {
            let is_at_rest = match phase {
                Phase::Stick | Phase::Transition(_) => true,
                Phase::Slip(_) => self.equations.speed(contact) == 0.0,
                Phase::Free | Phase::Open | Phase::Closed => false,
            };
            mask |= u64::from(is_at_rest) << contact;
        }
        mask
    }

    /// Adds phases, with others that differ from them in one contact at rest, and returns their place.
    fn add_batch(&self, scratch: &mut Scratch<S>, phases: &[Phase], at_rest: u64) -> usize {
        let both = [Direction::Forward, Direction::Backward];
        let sets_off = match self.own.settings.method {
            Method::Event => both.map(Phase::Slip),
            Method::Switch => both.map(Phase::Transition),
        };
        let mut all = vec![Phases::from_slice(phases)];
        for contact in (0..64).filter(|contact| at_rest & 1 << contact != 0) {
            for phase in [sets_off[0], sets_off[1], Phase::Stick] {
                if phase != phases[contact] && all.len() < LANES {
                    let mut other = Phases::from_slice(phases);
                    other[contact] = phase;
                    all.push(other);
                }
            }
        }
        let operations = &self.general.program.operations;
        let zero = Lanes::splat(self.general.simd, 0.0);
        let mut inputs = vec![zero; operations.inputs[0].len()];
        for (lane, phases) in all.iter().enumerate() {
            let values = scratch.inputs(operations, self.own.system.as_ref(), phases);
            for (input, value) in inputs.iter_mut().zip(values) {
                input[lane] = *value;
            }
        }
        if scratch.batches.len() == MOST_KNOWN {
            scratch.batches.clear();
        }
        scratch.batches.push(Batch { at_rest, phases: all, inputs });
        scratch.batches.len() - 1
    }

    /// Returns a coefficient of speed, acceleration and forces of each contact.
    fn coefficients(&self, k: usize, lane: usize) -> impl Iterator<Item = [f64; 4]> {
        let operations = &self.general.program.operations;
        let scratch = self.scratch.borrow();
        operations.contacts.iter().map(move |contact| {
            contact.map(|slot| scratch.memory[operations.coefficient(slot, k) as usize][lane])
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
        let lane = self.assume(phases);
        self.coefficients(0, lane).map(forces).collect()
    }

    fn rates(&self, phases: &[Phase]) -> Components {
        let lane = self.assume(phases);
        let operations = &self.general.program.operations;
        let scratch = self.scratch.borrow();
        let rate = |slot: &u32| scratch.memory[operations.coefficient(*slot, 0) as usize][lane];
        operations.rates.iter().map(rate).collect()
    }

    fn forces_ahead(&self, phases: &[Phase]) -> Forces {
        let lane = self.assume(phases);
        let now: SmallVec<[[f64; 4]; 8]> = self.coefficients(0, lane).collect();
        let ahead = &self.general.program.ahead;
        ahead.run(self.general.simd, &mut self.scratch.borrow_mut().memory);
        let changes = now.iter().zip(self.coefficients(1, lane));
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
