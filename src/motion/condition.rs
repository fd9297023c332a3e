//! The conditions that hold during a smooth phase, and their tolerances. Those of a contact are:
//!
//! | | first | second | third |
//! |---|---|---|---|
//! | slip | out of the band | | closed |
//! | stick | held against a forward force | held against a backward force | closed |
//! | transition | in the band | accelerating in its direction | closed |
//! | free | | | closed |
//! | apart | | | apart |

use super::{Phase, Settings, event_driven, switch_model};
use crate::model::Method;

/// A condition of a smooth phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Condition {
    /// Of a contact: its first, its second, or that the contact is closed.
    Contact { contact: usize, which: usize },
    /// An event that resets the state has not happened.
    Event(usize),
    /// An open gap has not closed.
    Gap(usize),
    /// A contact that is apart has not closed.
    Landing(usize),
    /// A closed gap is under pressure.
    Pressed(usize),
    /// Friction holds this contact and those that it touches.
    Held(usize),
}

impl Condition {
    /// Returns whether its failure resets the state.
    pub(super) fn resets(self) -> bool {
        matches!(self, Condition::Event(_) | Condition::Gap(_) | Condition::Landing(_))
    }
}

/// Tolerances of the conditions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margins {
    /// Half width of the band around zero speed; 0 in the exact motion.
    pub(super) band: f64,
    /// Slack of the conditions on forces and accelerations.
    pub(super) slack: f64,
}

impl Margins {
    /// Returns the tolerances for forces of this size.
    pub(super) fn new(settings: &Settings, force_scale: f64) -> Self {
        match settings.method {
            Method::Switch => Margins { band: settings.band, slack: switch_model::SLACK },
            Method::Event => Margins { band: 0.0, slack: event_driven::release_slack(force_scale) },
        }
    }

    /// Returns the sign and the offset of the first condition of a contact that does not stick, `sign v + offset` with its
    /// sliding speed `v`, and 1 if the contact sticks, else 0. The condition counts as failed if it is negative by `aim`.
    #[inline]
    pub(super) fn first_condition(&self, phase: Phase, aim: f64) -> [f64; 3] {
        match phase {
            Phase::Slip(direction) => [direction.sign(), aim - self.band, 0.0],
            // A contact is in the band only briefly: always examined.
            Phase::Transition(direction) => [-direction.sign(), -1.0, 0.0],
            Phase::Stick => [0.0, 1.0, 1.0],
            Phase::Free | Phase::Apart | Phase::Open | Phase::Closed => [0.0, 1.0, 0.0],
        }
    }
}
