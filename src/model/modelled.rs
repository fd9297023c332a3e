//! The mechanical systems that a study can simulate, in SI units.

use std::sync::Arc;

use serde::Serialize;
use thiserror::Error;

use super::{
    BALL_BALANCER, Components, Coordinate, DefaultModel, Drawing, FrictionLaw, InvalidParameter,
    Machine, ModelKind, NaturalFrequencies, OwnModel, SPEED_TERMS, Start, System, Units,
};

impl ModelKind {
    /// Returns a model with the default values.
    pub fn default_model(&'static self) -> Model {
        match self.default {
            DefaultModel::BallBalancer(machine) => machine().into(),
            DefaultModel::Own(kind) => OwnModel::new(self, kind).into(),
        }
    }
}

/// One of the mechanical systems with its parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Model {
    /// The automatic ball balancer.
    BallBalancer(Machine),
    /// A model that a system file or a program outside this crate defines.
    Own(OwnModel),
}

/// A start state has other coordinates than its model.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct OtherCoordinates(String);

impl From<Machine> for Model {
    fn from(machine: Machine) -> Self {
        Model::BallBalancer(machine)
    }
}

impl From<OwnModel> for Model {
    fn from(model: OwnModel) -> Self {
        Model::Own(model)
    }
}

impl Model {
    /// The model's kind.
    pub fn kind(&self) -> &'static ModelKind {
        match self {
            Model::BallBalancer(_) => &BALL_BALANCER,
            Model::Own(model) => model.kind(),
        }
    }

    /// Checks that all values have a physical meaning.
    ///
    /// # Errors
    /// The first invalid parameter, by the name it has in a study file.
    pub fn validate(&self) -> Result<(), InvalidParameter> {
        match self {
            Model::BallBalancer(machine) => machine.validate(),
            Model::Own(model) => model.validate(),
        }
    }

    /// Checks that all values of the speed profile and of the kicks have a physical meaning.
    ///
    /// # Errors
    /// The first invalid parameter, by the name it has in a study file.
    pub fn validate_stages(&self) -> Result<(), InvalidParameter> {
        match self {
            Model::BallBalancer(machine) => machine.validate_stages(),
            Model::Own(model) => model.validate_stages(),
        }
    }

    /// Checks that each value alone has a physical meaning.
    ///
    /// # Errors
    /// The first invalid parameter, by the name it has in a study file.
    pub fn validate_values(&self) -> Result<(), InvalidParameter> {
        match self {
            Model::BallBalancer(machine) => machine.validate(),
            Model::Own(model) => model.validate_values(),
        }
    }

    /// Returns the system without dimensions; `None` for a machine with an unsupported number of balls. Balls with
    /// contact are in their order along the ring, from the first ball on.
    pub fn system(&self) -> Option<Arc<dyn System>> {
        let order: Vec<f64> = (0..self.balls()).map(|ball| ball as f64 * 0.1).collect();
        self.system_in_order(&order)
    }

    /// Returns the system without dimensions for a start state, which determines the order of balls with contact along
    /// the ring; `None` for a machine with an unsupported number of balls.
    pub fn system_for(&self, start: &Start) -> Option<Arc<dyn System>> {
        match self.balls() {
            0 => self.system(),
            balls => self.system_in_order(start.0.get(2..2 + balls)?),
        }
    }

    /// Returns the contacts behind and ahead of each gap, in the order of the gaps of [`Model::system_for`]; `None` for a
    /// system without gaps.
    pub fn gaps(&self, start: &Start) -> Option<Vec<[usize; 2]>> {
        let system = self.system_for(start)?;
        Some(system.touching()?.gaps().iter().map(|gap| gap.contacts).collect())
    }

    /// Returns the pictures of the machine for an animation of a run from this state; `None` for a model without pictures.
    pub fn drawing(&self, start: &Start) -> Option<Drawing> {
        match self {
            Model::BallBalancer(machine) => {
                Some(machine.drawing(&self.gaps(start).unwrap_or_default()))
            }
            Model::Own(model) => model.own_kind.drawing(model),
        }
    }

    pub(super) fn system_in_order(&self, angles: &[f64]) -> Option<Arc<dyn System>> {
        match self {
            Model::BallBalancer(machine) => machine.driven(angles, None::<[f64; SPEED_TERMS]>),
            Model::Own(model) => Some(model.own_kind.system(model)),
        }
    }

    /// Returns a start state in the components of [`Model::system`].
    ///
    /// # Errors
    /// An error in words if the start state has another number of coordinates.
    pub fn start_state(&self, start: &Start) -> Result<Components, OtherCoordinates> {
        self.components(start).ok_or_else(|| {
            OtherCoordinates(match self {
                Model::BallBalancer(_) => {
                    "the start state has another number of balls than the machine".to_owned()
                }
                Model::Own(model) => {
                    let names = self.coordinates().into_iter().map(|coordinate| coordinate.name);
                    let names: Vec<String> = names.collect();
                    format!("the start state of {} is {}", model.kind().name, names.join(", "))
                }
            })
        })
    }

    /// The coordinates of a start state, in order.
    pub fn coordinates(&self) -> Vec<Coordinate> {
        match self {
            Model::BallBalancer(machine) => machine.coordinates(),
            Model::Own(model) => model.own_kind.coordinates(model),
        }
    }

    /// Returns the units of the model.
    pub fn units(&self) -> Units {
        match self {
            Model::BallBalancer(machine) => machine.units(),
            Model::Own(model) => model.own_kind.units(model),
        }
    }

    /// Returns the number of coordinates of a start state.
    pub fn coordinate_count(&self) -> usize {
        match self {
            Model::Own(model) => model.own_kind.coordinate_count(model),
            Model::BallBalancer(machine) => 4 + 2 * machine.balls.len(),
        }
    }

    fn components(&self, start: &Start) -> Option<Components> {
        match (self, start.0.as_slice()) {
            // Both have position, angles, velocity, angular speeds; components end with angles and their speeds.
            (Model::BallBalancer(machine), values)
                if values.len() == 4 + 2 * machine.balls.len() =>
            {
                let (position, rest) = values.split_at(2);
                let (beta, rest) = rest.split_at(machine.balls.len());
                let (velocity, beta_dot) = rest.split_at(2);
                Some([position, velocity, beta, beta_dot].concat().into())
            }
            (Model::Own(model), values) if values.len() == self.coordinate_count() => {
                Some(model.own_kind.start_state(model, values))
            }
            _ => None,
        }
    }

    /// Returns the machine; `None` if the model is not the ball balancer.
    pub fn ball_balancer(&self) -> Option<&Machine> {
        match self {
            Model::BallBalancer(machine) => Some(machine),
            Model::Own(_) => None,
        }
    }

    /// Returns the machine mutably; `None` if the model is not the ball balancer.
    pub fn ball_balancer_mut(&mut self) -> Option<&mut Machine> {
        match self {
            Model::BallBalancer(machine) => Some(machine),
            Model::Own(_) => None,
        }
    }

    /// Returns the version of the equations of a model that is defined outside this crate. The equations of the other
    /// models have the version of the program.
    pub fn own_version(&self) -> Option<u32> {
        match self {
            Model::BallBalancer(_) => None,
            Model::Own(model) => Some(model.own_kind.version()),
        }
    }

    /// Returns the number of balls; 0 for a model without balls.
    pub fn balls(&self) -> usize {
        self.ball_balancer().map_or(0, |machine| machine.balls.len())
    }

    /// Number of contacts with friction.
    pub fn contacts(&self) -> usize {
        match self {
            Model::BallBalancer(machine) => machine.balls.len().max(1),
            Model::Own(_) => self.units().contacts.len(),
        }
    }

    /// The law of friction.
    pub fn friction(&self) -> &FrictionLaw {
        match self {
            Model::BallBalancer(machine) => &machine.friction,
            Model::Own(model) => model.friction(),
        }
    }

    /// Returns the law of friction, mutably.
    pub fn friction_mut(&mut self) -> &mut FrictionLaw {
        match self {
            Model::BallBalancer(machine) => &mut machine.friction,
            Model::Own(model) => &mut model.friction,
        }
    }

    /// Returns the (kinetic) coefficient of friction that all contacts share; `None` for balls, which have their own.
    pub fn friction_coefficient(&self) -> Option<f64> {
        match self {
            Model::BallBalancer(_) => None,
            Model::Own(model) => model.friction_coefficient(),
        }
    }

    /// The natural frequency, rad/s.
    pub fn natural_frequency_rad_s(&self) -> f64 {
        match self {
            Model::BallBalancer(machine) => machine.natural_frequency_rad_s(),
            Model::Own(model) => model.own_kind.units(model).natural_rad_s,
        }
    }

    /// Returns the natural frequencies that people read: of a ball balancer, that of its suspension.
    pub fn natural_frequencies(&self) -> NaturalFrequencies {
        match self {
            Model::Own(model) => model.own_kind.small_motions(model).natural_frequencies(),
            Model::BallBalancer(machine) => NaturalFrequencies {
                held_rad_s: None,
                free_rad_s: Some(vec![machine.natural_frequency_rad_s()]),
            },
        }
    }

    /// Returns the names of the laws of friction of all contacts.
    pub fn friction_in_words(&self) -> String {
        let Some(system) = self.system().filter(|_| !self.kind().has_law_of_study()) else {
            return self.friction().name().to_owned();
        };
        let mut laws: Vec<&str> =
            (0..system.contacts()).map(|contact| system.friction(contact).law_name()).collect();
        laws.dedup();
        laws.join(", ")
    }

    /// Returns the largest damping rate of a contact by friction that grows with speed, over the
    /// natural frequency.
    pub fn damping_rate(&self) -> f64 {
        match self {
            Model::BallBalancer(machine) => {
                let weight = (machine.speed_rad_s / machine.natural_frequency_rad_s()).powi(2);
                let friction = machine.balls.iter().map(|ball| machine.ball_friction(ball));
                friction.map(|friction| friction.damping_rate(weight)).fold(0.0, f64::max)
            }
            Model::Own(model) => {
                let system = model.own_kind.system(model);
                let friction = (0..system.contacts()).map(|contact| system.friction(contact));
                friction.map(|friction| friction.damping_rate(1.0)).fold(0.0, f64::max)
            }
        }
    }
}
