//! A motion at an instant, for recording.

use super::evaluator::Forces;
use super::{PerContact, Phases};
use crate::model::Components;

/// A motion at an instant.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Non-dimensional time.
    pub time: f64,
    /// The state. Angles lie within a step of [0, 2π).
    pub state: Components,
    /// Positions of the contacts; angles with the whole turns made since the start, rad.
    pub unwrapped: PerContact,
    /// The phase of each contact.
    pub phases: Phases,
    /// Speeds, accelerations and forces of the contacts.
    pub forces: Forces,
}
