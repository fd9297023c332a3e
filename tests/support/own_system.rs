//! A system that a test writes down in a few lines.

use std::any::{Any, TypeId};

use stickslip::model::{
    Components, ContactMode, Friction, Recorder, Structure, System, SystemEquations,
};

/// A system of functions; its inputs are the parameters, then 1 for each contact that slips and the direction.
#[derive(Debug)]
pub struct OwnSystem {
    pub record: for<'r> fn(&'r Recorder) -> SystemEquations<'r>,
    pub parameters: Vec<f64>,
    pub friction: Vec<Friction>,
    pub longest_step: f64,
    /// Whether stick and slip are decided in exactly one way.
    pub unique: bool,
    /// The components that are outputs.
    pub outputs: &'static [usize],
}

impl OwnSystem {
    /// A system without outputs whose decisions are unique, with steps of at most 0.5.
    pub fn new(
        record: for<'r> fn(&'r Recorder) -> SystemEquations<'r>,
        parameters: Vec<f64>,
        friction: Vec<Friction>,
    ) -> Self {
        OwnSystem { record, parameters, friction, longest_step: 0.5, unique: true, outputs: &[] }
    }
}

impl System for OwnSystem {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        (self.record)(recorder)
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        let mode = |mode: &ContactMode| match *mode {
            ContactMode::Slip(direction) | ContactMode::BreakingAway(direction) => [1.0, direction],
            _ => [0.0, 0.0],
        };
        self.parameters.iter().copied().chain(modes.iter().flat_map(mode)).collect()
    }

    fn structure(&self) -> Option<Structure> {
        let equations = [self.record as usize, self.friction.len()];
        Some((TypeId::of::<Self>(), Vec::new(), equations.to_vec()))
    }

    fn contacts(&self) -> usize {
        self.friction.len()
    }

    fn friction(&self, contact: usize) -> &Friction {
        &self.friction[contact]
    }

    fn longest_step(&self) -> f64 {
        self.longest_step
    }

    fn fastest_rate(&self) -> f64 {
        1.0
    }

    fn surely_one_solution(&self) -> bool {
        self.unique
    }

    fn one_solution_at(&self, _state: &[f64]) -> bool {
        self.unique
    }

    fn force_scale(&self) -> f64 {
        1.0
    }

    fn outputs(&self, state: &[f64]) -> Components {
        self.outputs.iter().map(|component| state[*component]).collect()
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
