//! A system that a test writes down in a few lines.

use std::any::{Any, TypeId};

use stickslip::model::{
    ContactMode, Friction, ImpactLaw, Mechanism, Recorder, Structure, System, SystemEquations,
    add_mechanism_inputs,
};

/// What records the equations of a system.
#[derive(Debug)]
enum Equations {
    /// Functions, whose inputs are the parameters, then 1 for each contact that slips and the direction.
    Functions(for<'r> fn(&'r Recorder) -> SystemEquations<'r>),
    /// A mechanism, whose record begins with its parameters. Contacts may open.
    Mechanism(for<'r> fn(&'r Recorder, &[Friction]) -> Mechanism<'r>, Vec<(bool, ImpactLaw)>),
}

/// A system of a test.
#[derive(Debug)]
pub struct OwnSystem {
    equations: Equations,
    parameters: Vec<f64>,
    friction: Vec<Friction>,
    /// Whether stick and slip are decided in exactly one way.
    pub unique: bool,
}

impl OwnSystem {
    /// A system whose decisions are unique.
    pub fn new(
        record: for<'r> fn(&'r Recorder) -> SystemEquations<'r>,
        parameters: Vec<f64>,
        friction: Vec<Friction>,
    ) -> Self {
        let equations = Equations::Functions(record);
        OwnSystem { equations, parameters, friction, unique: true }
    }

    /// A mechanism with the friction of each contact, whether it opens, and its law of impact.
    pub fn mechanism(
        record: for<'r> fn(&'r Recorder, &[Friction]) -> Mechanism<'r>,
        parameters: Vec<f64>,
        contacts: Vec<(Friction, bool, ImpactLaw)>,
    ) -> Self {
        let friction = contacts.iter().map(|(friction, ..)| *friction).collect();
        let laws = contacts.into_iter().map(|(_, opens, law)| (opens, law)).collect();
        let equations = Equations::Mechanism(record, laws);
        OwnSystem { equations, parameters, friction, unique: false }
    }
}

impl System for OwnSystem {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        match &self.equations {
            Equations::Functions(record) => record(recorder),
            Equations::Mechanism(record, _) => record(recorder, &self.friction).record(recorder),
        }
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        let mut inputs = self.parameters.clone();
        for (contact, mode) in modes.iter().enumerate() {
            match (&self.equations, *mode) {
                (Equations::Mechanism(_, laws), mode) => {
                    let (friction, opens) = (&self.friction[contact], laws[contact].0);
                    add_mechanism_inputs(&mut inputs, mode, friction, opens);
                }
                (_, ContactMode::Slip(direction) | ContactMode::BreakingAway(direction)) => {
                    inputs.extend([1.0, direction]);
                }
                _ => inputs.extend([0.0, 0.0]),
            }
        }
        inputs
    }

    fn structure(&self) -> Option<Structure> {
        let record = match self.equations {
            Equations::Functions(record) => record as usize,
            Equations::Mechanism(record, _) => record as usize,
        };
        let laws = self.friction.iter().map(Friction::law_name).collect();
        Some((TypeId::of::<Self>(), laws, vec![record, self.friction.len()]))
    }

    fn contacts(&self) -> usize {
        self.friction.len()
    }

    fn friction(&self, contact: usize) -> &Friction {
        &self.friction[contact]
    }

    fn impact_law(&self, contact: usize) -> ImpactLaw {
        match &self.equations {
            Equations::Functions(_) => ImpactLaw::default(),
            Equations::Mechanism(_, laws) => laws[contact].1,
        }
    }

    fn longest_step(&self) -> f64 {
        0.5
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

    fn as_any(&self) -> &dyn Any {
        self
    }
}
