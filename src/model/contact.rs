//! What a contact does in the equations of motion, as numbers and without branches.

use super::Number;

/// The friction of one ball, as numbers instead of cases, so that runs in lockstep can differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T = f64> {
    /// 1 where the ball may accelerate, 0 where it sticks.
    pub free: T,
    /// Friction force over normal force, with sign: `μ` times the direction that friction acts
    /// against; 0 where the ball sticks.
    pub signed_friction: T,
    /// Friction that does not depend on the normal force (viscous), with sign.
    pub drag: T,
}

impl Contact {
    /// A contact that sticks.
    pub const STICK: Contact = Contact { free: 0.0, signed_friction: 0.0, drag: 0.0 };

    /// Returns this contact in another arithmetic.
    #[inline]
    pub fn lifted<T: Number>(self) -> Contact<T> {
        Contact {
            free: T::constant(self.free),
            signed_friction: T::constant(self.signed_friction),
            drag: T::constant(self.drag),
        }
    }
}
