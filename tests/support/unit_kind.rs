//! The frame of a kind of model that a test writes down, with units of 1.

use std::sync::Arc;

use stickslip::classification::{Outcome, simulate};
use stickslip::model::{
    Capabilities, Case, Components, ContactNames, ContactUnits, Coordinate, DefaultModel,
    ModelKind, OutputUnits, OwnKind, OwnModel, ParameterDescriptor, Simulation, SlidingSpeed,
    Start, System, Units,
};

/// A kind whose start states follow a phase that is 0.
pub struct UnitKind {
    /// The number of coordinates; each has a position and a velocity.
    pub coordinates: usize,
    /// The number of components before the coordinates.
    pub phases: usize,
    pub contacts: usize,
    pub system: fn(&OwnModel) -> Arc<dyn System>,
}

/// Returns a kind of model with this name.
pub const fn unit_kind(
    name: &'static str,
    parameters: &'static [ParameterDescriptor],
    kind: &'static dyn OwnKind,
) -> ModelKind {
    ModelKind {
        name,
        meaning: "A kind of a test.",
        parameters,
        body: "body",
        sliding_speed: SlidingSpeed::MS,
        offers: Capabilities::MOTION,
        default: DefaultModel::Own(kind),
    }
}

impl OwnKind for UnitKind {
    fn coordinates(&self, _: &OwnModel) -> Vec<Coordinate> {
        let of = |name: &'static str, unit: &'static str| {
            (1..=self.coordinates)
                .map(move |body| Coordinate::of_body(name, body, unit, "start value", [-1.0, 1.0]))
        };
        of("position_m", "m").chain(of("velocity_m_s", "m/s")).collect()
    }

    fn units(&self, _: &OwnModel) -> Units {
        Units {
            natural_rad_s: 1.0,
            length_m: 1.0,
            contacts: vec![ContactUnits::new(1.0, 1.0, 1.0); self.contacts],
            disc_rad_s: 0.0,
            outputs: vec![
                OutputUnits { size: 1.0, angular: false, has_amplitude: true };
                self.coordinates
            ],
        }
    }

    fn contact_names(&self, _: &OwnModel) -> Vec<ContactNames> {
        numbered_contacts(self.contacts)
    }

    fn system(&self, model: &OwnModel) -> Arc<dyn System> {
        (self.system)(model)
    }

    fn start_state(&self, _: &OwnModel, start: &[f64]) -> Components {
        let phases = std::iter::repeat_n(0.0, self.phases);
        phases.chain(start.iter().copied()).collect()
    }
}

/// Returns names of contacts that have numbers and move coordinates in m.
pub fn numbered_contacts(contacts: usize) -> Vec<ContactNames> {
    let name = |number: usize| ContactNames {
        contact: number.to_string(),
        position: (format!("position_{number}_m"), "m"),
        speed_unit: "m/s".to_owned(),
        force_unit: "N".to_owned(),
    };
    (1..=contacts).map(name).collect()
}

/// Simulates a model of a kind with these parameters, in their order; the others have their defaults.
pub fn simulate_kind(
    kind: &'static ModelKind,
    parameters: &[f64],
    start: &[f64],
    simulation: Simulation,
) -> Outcome {
    let mut model = kind.default_model();
    for (parameter, value) in kind.parameters.iter().zip(parameters) {
        parameter.numbers(&mut model, None).into_iter().for_each(|number| *number = *value);
    }
    simulate(&Case { model, start: Start(start.to_vec()), simulation })
}
