//! Why balls cannot balance a machine, as far as closed forms tell.

use super::closed_form::capacity_kg_m;
use super::conditions::is_held_everywhere;
use crate::model::Machine;

/// A reason why balls do not balance a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// The disc is slower than the natural frequency, where the balancing position is not stable.
    SlowDisc,
    /// The balls are too light to balance the imbalance in any position.
    LightBalls,
    /// Friction holds the balls in every position.
    HeldBalls,
}

impl Obstacle {
    /// All obstacles, in the order in which they are examined.
    pub const ALL: [Self; 3] = [Self::SlowDisc, Self::LightBalls, Self::HeldBalls];

    /// Returns the first obstacle of a machine whose equilibrium set is this fraction of all positions; `None` if closed
    /// forms show none.
    pub fn of(machine: &Machine, set_fraction: Option<f64>) -> Option<Self> {
        let imbalance_kg_m = machine.imbalance_mass_kg * machine.imbalance_radius_m;
        let is_there = |obstacle: &Self| match obstacle {
            Self::SlowDisc => machine.speed_rad_s.abs() < machine.natural_frequency_rad_s(),
            Self::LightBalls => capacity_kg_m(machine) < imbalance_kg_m,
            Self::HeldBalls => set_fraction.is_some_and(is_held_everywhere),
        };
        Self::ALL.into_iter().find(is_there)
    }
}
