//! How a motion is computed, and what it has cost.

use serde::{Deserialize, Serialize};

use super::dop853::Tolerance;
use crate::model::{Method, Simulation};

/// How a motion is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Switch model or its limit.
    pub method: Method,
    /// Half width `η` of the switch model's band, over `ω_n`.
    pub band: f64,
    /// Errors allowed per step.
    pub tolerance: Tolerance,
    /// Most steps, accepted and rejected, and switches together.
    pub effort_limit: u64,
}

impl Settings {
    /// The settings of a simulation.
    pub fn new(simulation: &Simulation, effort_limit: u64) -> Self {
        Settings {
            method: simulation.method,
            band: simulation.band,
            tolerance: Tolerance {
                relative: simulation.relative_tolerance,
                absolute: simulation.absolute_tolerance,
            },
            effort_limit,
        }
    }
}

/// What a motion has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Effort {
    /// Accepted steps.
    pub steps: u64,
    /// Steps tried and not taken: by error control, or in looking for a switch.
    pub rejected_steps: u64,
    /// Changes of a ball's phase.
    pub switches: u64,
}
