//! Units of the non-dimensional values of a model.

use super::{Ground, Model};

/// Conversion of non-dimensional values of a model to SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Units {
    /// Natural frequency, rad/s: the reciprocal of the unit of time.
    pub natural_rad_s: f64,
    /// Unit of length, m.
    pub length_m: f64,
    /// Unit of a contact's position: 1 rad for a ball, the unit of length for a block.
    pub position: f64,
    /// Unit of force of each contact, N.
    pub force_n: Vec<f64>,
    /// Speed of the disc, rad/s; 0 without a disc.
    pub disc_rad_s: f64,
    /// Speed of the ground of a block, m/s; 0 for a ball.
    pub ground_m_s: f64,
}

impl Model {
    /// Returns the units of the model.
    pub fn units(&self) -> Units {
        let natural = self.natural_frequency_rad_s();
        match self {
            Model::Own(own) => own.own().units(own),
            Model::BallBalancer(machine) => Units {
                natural_rad_s: natural,
                length_m: machine.ring_radius_m,
                position: 1.0,
                force_n: (machine.balls.iter())
                    .map(|ball| ball.mass_kg * natural * natural * machine.ring_radius_m)
                    .collect(),
                disc_rad_s: machine.speed_rad_s,
                ground_m_s: 0.0,
            },
            Model::Block(block) => Units {
                natural_rad_s: natural,
                length_m: block.unit_length_m(),
                position: block.unit_length_m(),
                force_n: vec![block.normal_force_n],
                disc_rad_s: 0.0,
                ground_m_s: match block.ground {
                    Ground::Fixed => 0.0,
                    Ground::Belt { speed_m_s } => speed_m_s,
                },
            },
        }
    }
}
