//! The block on a spring of a system file, with its parameters by name.

use std::sync::Arc;
use stickslip::model::{FrictionLaw, Model, System};
use stickslip::study::model_kind;

/// The support of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    Fixed,
    Belt { speed_m_s: f64 },
}

/// A block on a spring in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    pub mass_kg: f64,
    pub stiffness_n_m: f64,
    pub normal_force_n: f64,
    pub friction_coefficient: f64,
    pub friction: FrictionLaw,
    pub ground: Ground,
}

impl Block {
    /// A block of 1 kg on a spring of 100 N/m, pressed on rigid ground with 10 N, with `μ = 0.1`.
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

    /// A block like [`Block::on_spring`] whose units are those of its equations without dimensions.
    pub fn without_units(friction: FrictionLaw) -> Self {
        let [mass_kg, stiffness_n_m, normal_force_n] = [1.0; 3];
        Block { mass_kg, stiffness_n_m, normal_force_n, friction, ..Block::on_spring() }
    }

    /// The block of a model; `None` for another kind.
    pub fn of(model: &Model) -> Option<Self> {
        let number = |name: &str| {
            let mut parameters = model.kind().parameters.iter();
            let parameter = parameters.find(|parameter| parameter.name == name)?;
            parameter.numbers(&mut model.clone(), None).first().map(|number| **number)
        };
        let belt = number("belt_speed_m_s").map(|speed_m_s| Ground::Belt { speed_m_s });
        model.kind().name.starts_with("block_on_").then_some(())?;
        Some(Block {
            mass_kg: number("mass_kg")?,
            stiffness_n_m: number("stiffness_n_m")?,
            normal_force_n: number("normal_force_n")?,
            friction_coefficient: number("friction_coefficient")?,
            friction: *model.friction(),
            ground: belt.unwrap_or(Ground::Fixed),
        })
    }

    /// The natural frequency `ω_n = sqrt(k / m)`, rad/s.
    pub fn natural_frequency_rad_s(&self) -> f64 {
        (self.stiffness_n_m / self.mass_kg).sqrt()
    }

    /// The unit of length, `F_n / k`, m.
    pub fn unit_length_m(&self) -> f64 {
        self.normal_force_n / self.stiffness_n_m
    }

    /// The system without dimensions.
    pub fn system(&self) -> Arc<dyn System> {
        Model::from(self.clone()).system().expect("a block has a system")
    }
}

impl From<Block> for Model {
    fn from(block: Block) -> Self {
        let (kind, belt_speed) = match block.ground {
            Ground::Fixed => ("block_on_spring", None),
            Ground::Belt { speed_m_s } => ("block_on_belt", Some(speed_m_s)),
        };
        let kind = model_kind(kind).expect("a built-in kind");
        let mut model = kind.default_model();
        *model.friction_mut() = block.friction;
        let parameters = [
            ("mass_kg", Some(block.mass_kg)),
            ("stiffness_n_m", Some(block.stiffness_n_m)),
            ("normal_force_n", Some(block.normal_force_n)),
            ("friction_coefficient", Some(block.friction_coefficient)),
            ("belt_speed_m_s", belt_speed),
        ];
        for (name, value) in parameters {
            let parameter = kind.parameters.iter().find(|parameter| parameter.name == name);
            if let (Some(parameter), Some(value)) = (parameter, value) {
                parameter.numbers(&mut model, None).into_iter().for_each(|number| *number = value);
            }
        }
        model
    }
}
