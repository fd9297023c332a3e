//! Tolerances of the conditions that hold during a smooth phase.

use super::{Settings, event_driven, switch_model};
use crate::model::Method;

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
