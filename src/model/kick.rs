//! A kick: the table's velocity jumps, as by a blow with a hammer, and the balls jump with it.
//!
//! If the velocity of the table jumps by `(Δẋ, Δẏ)`, the ring's impulse on a ball, over its mass, is `P = -c Δẋ - s Δẏ`,
//! and the ball's speed jumps by
//!
//! ```text
//! (1 + 4J) Δβ̇ = s Δẋ - c Δẏ - q,    q ∈ μ P Sign(β̇⁺)
//! ```
//!
//! with the friction impulse `q` (the equations of motion, integrated over the blow). Where `P` is negative, the blow lifts
//! the ball off the ring, which the model does not follow: there is no friction impulse, and such balls are counted.

use serde::Serialize;

use super::invalid_parameter::{InvalidParameter, invalid, not_negative, positive};
use super::kind::member_name;
use super::{Balancer, BalancerBall};

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

impl<const N: usize> Balancer<N> {
    /// Changes the components of a state by a jump of the table's velocity, non-dimensional, in the turning frame. Returns
    /// the number of balls that the blow lifts off the ring.
    pub(super) fn jump_of_balls(&self, components: &mut [f64], jump: [f64; 2]) -> u32 {
        let [x_jump, y_jump] = jump;
        let (table, balls) = components.split_at_mut(4);
        table[2] += x_jump;
        table[3] += y_jump;
        let (angles, speeds) = balls.split_at_mut(N);
        let mut lifted = 0;
        for ((ball, angle), speed) in self.balls.iter().zip(angles).zip(speeds) {
            let BalancerBall { mobility, friction, .. } = ball;
            let (sine, cosine) = libm::sincos(*angle);
            let pressed = -cosine * x_jump - sine * y_jump;
            let without_friction = *speed + mobility * (sine * x_jump - cosine * y_jump);
            let friction = mobility * friction.limit * pressed.max(0.0);
            *speed = without_friction.signum() * (without_friction.abs() - friction).max(0.0);
            lifted += u32::from(pressed < 0.0);
        }
        lifted
    }
}
