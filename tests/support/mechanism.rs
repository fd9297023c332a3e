//! A mechanism that a test writes down in a few lines.

use std::any::{Any, TypeId};

use stickslip::model::{
    ContactMode, Friction, ImpactLaw, Mechanism, Recorder, Structure, System, SystemEquations,
    add_mechanism_inputs,
};

/// A mechanism whose record begins with its parameters.
#[derive(Debug)]
pub struct OwnMechanism {
    pub record: for<'r> fn(&'r Recorder, &[Friction]) -> Mechanism<'r>,
    pub parameters: Vec<f64>,
    /// The friction of each contact, whether it opens, and its law of impact.
    pub contacts: Vec<(Friction, bool, ImpactLaw)>,
    pub friction: Vec<Friction>,
}

impl OwnMechanism {
    pub fn new(
        record: for<'r> fn(&'r Recorder, &[Friction]) -> Mechanism<'r>,
        parameters: Vec<f64>,
        contacts: Vec<(Friction, bool, ImpactLaw)>,
    ) -> Self {
        let friction = contacts.iter().map(|(friction, ..)| *friction).collect();
        OwnMechanism { record, parameters, contacts, friction }
    }
}

impl System for OwnMechanism {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        (self.record)(recorder, &self.friction).record(recorder)
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        let mut inputs = self.parameters.clone();
        for ((friction, opens, _), mode) in self.contacts.iter().zip(modes) {
            add_mechanism_inputs(&mut inputs, *mode, friction, *opens);
        }
        inputs
    }

    fn structure(&self) -> Option<Structure> {
        let laws = self.friction.iter().map(Friction::law_name).collect();
        Some((TypeId::of::<Self>(), laws, vec![self.record as usize]))
    }

    fn contacts(&self) -> usize {
        self.contacts.len()
    }

    fn friction(&self, contact: usize) -> &Friction {
        &self.friction[contact]
    }

    fn impact_law(&self, contact: usize) -> ImpactLaw {
        self.contacts[contact].2
    }

    fn longest_step(&self) -> f64 {
        0.5
    }

    fn fastest_rate(&self) -> f64 {
        1.0
    }

    fn surely_one_solution(&self) -> bool {
        false
    }

    fn one_solution_at(&self, _state: &[f64]) -> bool {
        false
    }

    fn force_scale(&self) -> f64 {
        1.0
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
