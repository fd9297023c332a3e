//! A kick: the table's velocity jumps, as by a blow with a hammer, and the balls jump with it.

use serde::Serialize;

use super::invalid_parameter::{InvalidParameter, invalid, not_negative, positive};
use super::parameter_name::member_name;

/// A jump of the table's velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Kick {
    /// The time, s.
    pub at_s: f64,
    /// The change of the table's velocity, m/s.
    pub speed_m_s: f64,
    /// The direction of the change, an angle in the frame at rest, rad; the imbalance has the angle 0 at the start.
    pub direction_rad: f64,
}

impl Kick {
    /// Checks that all values of the kick with this number, from 1, have a physical meaning.
    pub(super) fn validate(&self, number: usize) -> Result<(), InvalidParameter> {
        positive(&member_name("kick_at_s", "s", number), self.at_s)?;
        not_negative(&member_name("kick_speed_m_s", "m/s", number), self.speed_m_s)?;
        let direction = self.direction_rad;
        if direction.is_finite() {
            return Ok(());
        }
        let name = member_name("kick_direction_rad", "rad", number);
        Err(invalid(&name, &direction.to_string(), "a finite number"))
    }
}
