//! A block on a spring, on rigid ground or on a moving belt: systems with dry friction that have a
//! closed-form solution.
//!
//! `m ẍ = -k x - f_w`, with friction `f_w` against the block's speed relative to what it lies on.
//! On rigid ground with Coulomb friction (thesis figure 4.2) each half swing is shorter than the
//! one before by twice `μ F_n / k`, and the block stops for good in the interval
//! `|x| ≤ μ F_n / k`. On a belt, with a static coefficient above the kinetic one, it sticks and
//! slips in a limit cycle (R. I. Leine, D. H. van Campen, A. de Kraker, L. van den Steen,
//! "Stick-slip vibrations induced by alternate friction models", Nonlinear Dynamics 16 (1998) 41,
//! doi:10.1023/A:1008289604683).
//!
//! Without dimensions: lengths over `F_n / k`, time times `ω_n = sqrt(k / m)`; then
//! `ẍ = -x - f_w` with normal force 1.

use serde::Serialize;

use super::invalid_parameter::{not_negative, positive};
use super::kind::{Capabilities, DefaultModel, Field, ModelKind, ParameterDescriptor};
use super::{
    Contact, Forces, Friction, FrictionLaw, InvalidParameter, Model, Number, SlidingSpeed, State,
};

/// The support of a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Ground {
    /// Rigid ground.
    Fixed,
    /// A belt that moves with constant speed.
    Belt {
        /// The belt's speed, m/s.
        speed_m_s: f64,
    },
}

const MASS: ParameterDescriptor = ParameterDescriptor {
    name: "mass_kg",
    unit: "kg",
    meaning: "mass of the block",
    field: Field::Block(|block| Some(&mut block.mass_kg)),
};

const STIFFNESS: ParameterDescriptor = ParameterDescriptor {
    name: "stiffness_n_m",
    unit: "N/m",
    meaning: "stiffness of the spring",
    field: Field::Block(|block| Some(&mut block.stiffness_n_m)),
};

const NORMAL_FORCE: ParameterDescriptor = ParameterDescriptor {
    name: "normal_force_n",
    unit: "N",
    meaning: "force that presses the block on the ground",
    field: Field::Block(|block| Some(&mut block.normal_force_n)),
};

const FRICTION_COEFFICIENT: ParameterDescriptor = ParameterDescriptor {
    name: "friction_coefficient",
    unit: "1",
    meaning: "coefficient of friction",
    field: Field::Block(|block| Some(&mut block.friction_coefficient)),
};

const BELT_SPEED: ParameterDescriptor = ParameterDescriptor {
    name: "belt_speed_m_s",
    unit: "m/s",
    meaning: "speed of the belt",
    field: Field::Block(|block| match &mut block.ground {
        Ground::Fixed => None,
        Ground::Belt { speed_m_s } => Some(speed_m_s),
    }),
};

/// A block on a spring, on rigid ground.
pub(super) static ON_SPRING: ModelKind = ModelKind {
    name: "block_on_spring",
    meaning: "A block on a spring, on rigid ground.",
    parameters: &[MASS, STIFFNESS, NORMAL_FORCE, FRICTION_COEFFICIENT],
    body: "block",
    sliding_speed: SlidingSpeed::MS,
    offers: Capabilities::MOTION,
    default: DefaultModel::BuiltIn(|| Model::Block(Block::on_spring())),
};

/// A block on a spring, on a moving belt.
pub(super) static ON_BELT: ModelKind = ModelKind {
    name: "block_on_belt",
    meaning: "A block on a spring, on a moving belt.",
    parameters: &[MASS, STIFFNESS, NORMAL_FORCE, FRICTION_COEFFICIENT, BELT_SPEED],
    body: "block",
    sliding_speed: SlidingSpeed::MS,
    offers: Capabilities::MOTION,
    default: DefaultModel::BuiltIn(|| Model::Block(Block::on_belt())),
};

/// A block on a spring in SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Block {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Spring stiffness, N/m.
    pub stiffness_n_m: f64,
    /// Force that presses the block on the ground, N.
    pub normal_force_n: f64,
    /// Coefficient of friction; the kinetic one if the law also has a static one.
    pub friction_coefficient: f64,
    /// The law of friction.
    pub friction: FrictionLaw,
    /// The support of the block.
    pub ground: Ground,
}

impl Block {
    /// A block of 1 kg on a spring of 100 N/m, pressed on rigid ground with 10 N, `μ = 0.1`.
    pub fn on_spring() -> Self {
        Block {
            mass_kg: 1.0,
            stiffness_n_m: 100.0,
            normal_force_n: 10.0,
            friction_coefficient: 0.1,
            friction: FrictionLaw::COULOMB,
            ground: Ground::Fixed,
        }
    }

    /// A block like [`Block::on_spring`], on a belt of 0.1 m/s.
    pub fn on_belt() -> Self {
        Block { ground: Ground::Belt { speed_m_s: 0.1 }, ..Block::on_spring() }
    }

    /// Checks that all values have a physical meaning.
    ///
    /// # Errors
    /// The first invalid parameter, by the name it has in a study file.
    pub fn validate(&self) -> Result<(), InvalidParameter> {
        positive("mass_kg", self.mass_kg)?;
        positive("stiffness_n_m", self.stiffness_n_m)?;
        positive("normal_force_n", self.normal_force_n)?;
        not_negative("friction_coefficient", self.friction_coefficient)?;
        self.friction.validate(self.friction_coefficient, SlidingSpeed::MS)?;
        match self.ground {
            Ground::Fixed => Ok(()),
            Ground::Belt { speed_m_s } => positive("belt_speed_m_s", speed_m_s),
        }
    }

    /// The natural frequency `ω_n = sqrt(k / m)`, rad/s.
    pub fn natural_frequency_rad_s(&self) -> f64 {
        (self.stiffness_n_m / self.mass_kg).sqrt()
    }

    /// The unit of length, `F_n / k`, m.
    pub fn unit_length_m(&self) -> f64 {
        self.normal_force_n / self.stiffness_n_m
    }

    /// Returns the non-dimensional form.
    pub fn slider(&self) -> Slider {
        let natural = self.natural_frequency_rad_s();
        let speed_unit = self.unit_length_m() * natural;
        let drag_unit = self.mass_kg * natural;
        Slider {
            friction: self.friction.contact(self.friction_coefficient, speed_unit, drag_unit),
            belt_speed: match self.ground {
                Ground::Fixed => 0.0,
                Ground::Belt { speed_m_s } => speed_m_s / speed_unit,
            },
        }
    }
}

/// The block without dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slider {
    /// Friction between block and ground.
    pub friction: Friction,
    /// Speed of the ground; 0 if the ground does not move.
    pub belt_speed: f64,
}

/// Position (`beta`) and speed relative to the support (`beta_dot`) of a block.
pub type SliderState = State<1, f64, 0>;

impl Slider {
    pub(super) fn forces_of<T: Number>(
        state: &State<1, T, 0>,
        contacts: &[Contact<T>; 1],
    ) -> Forces<1, T, 0> {
        let [Contact { free, signed_friction, drag }] = *contacts;
        let spring = -state.beta[0];
        let slipping = signed_friction + drag;
        Forces {
            table_acceleration: [],
            beta_ddot: [free * (spring - slipping)],
            normal: [T::constant(1.0)],
            friction: [free * slipping + (T::constant(1.0) - free) * spring],
        }
    }

    pub(super) fn derivative_of<T: Number>(
        belt_speed: T,
        state: &State<1, T, 0>,
        contacts: &[Contact<T>; 1],
        forces: &Forces<1, T, 0>,
    ) -> State<1, T, 0> {
        let free = contacts[0].free;
        let stuck = T::constant(1.0) - free;
        State {
            position: [],
            velocity: [],
            beta: [belt_speed + free * state.beta_dot[0]],
            beta_dot: [forces.beta_ddot[0] - stuck * state.beta_dot[0]],
        }
    }
}
