//! Settings of the computation of a motion, and its effort.

use serde::{Deserialize, Serialize};

use crate::model::{Method, Simulation, Tolerance};

/// Speed, over `ω_n`, below which a contact counts as slow.
pub const SLOW: f64 = 1e-6;

/// Settings of the computation of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Switch model or its limit.
    pub method: Method,
    /// Half width `η` of the switch model's band, over `ω_n`.
    pub band: f64,
    /// Errors allowed per step: `absolute + relative · |component|`.
    pub tolerance: Tolerance,
    /// Maximum total number of steps, accepted and rejected, and switches; fewer early in a motion
    /// (see [`most_steps_by`]).
    pub effort_limit: u64,
}

impl Settings {
    /// The settings of a simulation.
    pub fn new(simulation: &Simulation, effort_limit: u64) -> Self {
        Settings {
            method: simulation.method,
            band: simulation.band,
            tolerance: simulation.tolerance,
            effort_limit,
        }
    }
}

/// Returns the maximum number of steps and switches until a time, at the fastest rate of a system: a
/// hundred times the number of a well-behaved motion, which takes about ten steps per unit of time
/// and fastest rate. The limit grows with time, so that a motion whose steps shrink without bound is given
/// up early, and a long one is not.
pub fn most_steps_by(time: f64, fastest_rate: f64) -> u64 {
    MOST_AT_ONCE.saturating_add((MOST_PER_TIME * fastest_rate * time) as u64)
}

/// Number of events allowed within a unit of time over the fastest rate. A motion with more does not go on, and each
/// event may take as long as a hundred steps.
pub(super) const MOST_EVENTS_AT_ONCE: u32 = 10_000;
/// Number of steps allowed at time 0.
pub(super) const MOST_AT_ONCE: u64 = 100_000;
/// Number of steps allowed per unit of time and fastest rate.
pub(super) const MOST_PER_TIME: f64 = 1000.0;

/// How the contacts of a system with gaps have touched so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touches {
    /// The number of impacts: how often a gap that was open has closed.
    pub impacts: u64,
    /// The number of contacts that an impact has lifted off their support, which the model does not follow.
    pub lifted_off: u64,
    /// The time in which any gap was closed.
    pub time: f64,
}

/// The effort of a motion so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Effort {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps: by error control, or in the search for a switch.
    pub rejected_steps: u64,
    /// Changes of a ball's phase.
    pub switches: u64,
}

impl Effort {
    /// Returns the total number of steps, accepted and rejected, and switches.
    pub fn total(self) -> u64 {
        self.steps + self.rejected_steps + self.switches
    }
}
