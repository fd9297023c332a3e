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
    /// Most steps, accepted and rejected, and switches together; fewer early in a motion (see
    /// [`most_steps_by`]).
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

/// Far more steps and switches than any sound motion has taken by a time, at the pace of its system: sound ones
/// take some ten steps per unit of time and pace. The time counts, and not the motion's end: one whose steps
/// become ever shorter is given up soon, and one that goes on for long is not.
pub fn most_steps_by(time: f64, pace: f64) -> u64 {
    MOST_AT_ONCE.saturating_add((MOST_PER_TIME * pace * time) as u64)
}

/// Steps that a motion may take in no time.
pub(super) const MOST_AT_ONCE: u64 = 100_000;
/// Steps that it may take per unit of time and pace.
pub(super) const MOST_PER_TIME: f64 = 1000.0;

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

impl Effort {
    /// Steps, taken or not, and switches together.
    pub fn total(self) -> u64 {
        self.steps + self.rejected_steps + self.switches
    }
}
