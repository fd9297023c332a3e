//! The law of contact between neighbouring balls.
//!
//! Impacts follow Newton's law: the balls separate with a fraction of the speed of their approach, or more slowly where this
//! would add energy. Rolling does not last through an impact: a ball skids and rolls again, which leaves
//! `max(0, (e - 4J)/(1 + 4J))` of the material's coefficient `e` ([`rolling_restitution`]: the angular momentum about the
//! point of contact is kept while the ball skids).

use serde::Serialize;

use super::invalid_parameter::{InvalidParameter, invalid, not_negative};

/// The law of contact between balls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BallContact {
    /// The speed of separation over the speed of approach of rolling balls, 0 to 1.
    pub restitution: f64,
    /// The coefficient of friction between two balls.
    pub friction_coefficient: f64,
}

impl Default for BallContact {
    /// Steel balls: a restitution of 0.9 of the material, and dry friction.
    fn default() -> Self {
        BallContact { restitution: 0.36, friction_coefficient: 0.1 }
    }
}

impl BallContact {
    /// Checks that all values have a physical meaning.
    ///
    /// # Errors
    /// The first invalid parameter, by the name it has in a study file.
    pub fn validate(&self) -> Result<(), InvalidParameter> {
        if !(0.0..=1.0).contains(&self.restitution) {
            let found = self.restitution.to_string();
            return Err(invalid("contact_restitution", &found, "between 0 and 1"));
        }
        not_negative("contact_friction_coefficient", self.friction_coefficient)
    }
}

/// Polar moment of inertia of a homogeneous sphere over `m d²`.
pub const SPHERE_INERTIA: f64 = 0.1;

/// Returns the coefficient of restitution of rolling spheres from that of their material: they skid after the impact
/// until they roll again.
///
/// ```
/// use stickslip::model::rolling_restitution;
///
/// assert!((rolling_restitution(0.9) - 2.5 / 7.0).abs() < 1e-15);
/// assert_eq!(rolling_restitution(0.3), 0.0);
/// ```
pub fn rolling_restitution(material: f64) -> f64 {
    let rolling = 4.0 * SPHERE_INERTIA;
    ((material - rolling) / (1.0 + rolling)).max(0.0)
}
