//! The conditions that hold during a smooth phase, and their tolerances.

use super::{Settings, event_driven, switch_model};
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
}
