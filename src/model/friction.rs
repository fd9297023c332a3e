//! Friction laws: the friction force as a function of sliding speed and normal force.
//!
//! Coulomb, with equal coefficients for rest and motion; Stribeck, whose coefficient falls from a
//! static to a kinetic value with speed (thesis figure 3.3); a smooth law that cannot stick (thesis
//! section 3.3.1, the earlier work); viscous drag without dry friction (thesis section 5.1).

use serde::Serialize;

use super::invalid_parameter::{invalid, not_negative, positive};
use super::{Contact, InvalidParameter};

/// A friction law in SI units. Speeds are sliding speeds: rad/s for a ball relative to the ring,
/// m/s for a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum FrictionLaw {
    /// Dry friction with one coefficient `μ`: in slip `μ f_n`, in stick at most that.
    Coulomb,
    /// `μ(v) = μ + (μ_s - μ) e^{-|v|/v_s}`: at most `μ_s f_n` in stick, tending to `μ f_n` with
    /// growing speed. With `v_s = 0` the coefficient drops immediately (static and kinetic
    /// friction).
    Stribeck {
        /// `μ_s`, not below the (kinetic) friction coefficient.
        static_friction_coefficient: f64,
        /// `v_s`, zero or more.
        stribeck_speed: f64,
    },
    /// `μ f_n (2/π) atan(v / v_0)`: without a force at rest, so that nothing ever sticks.
    Smooth {
        /// `v_0`, positive: the speed at which half of the limit is reached.
        smoothing_speed: f64,
    },
    /// A drag in proportion to speed and independent of the normal force; no dry friction.
    Viscous {
        /// Drag over sliding speed (of the ball's centre along the ring, or of the block), N s/m.
        viscous_coefficient_n_s_m: f64,
    },
}

impl FrictionLaw {
    /// The law's name in a study file.
    pub fn name(&self) -> &'static str {
        match self {
            FrictionLaw::Coulomb => "coulomb",
            FrictionLaw::Stribeck { .. } => "stribeck",
            FrictionLaw::Smooth { .. } => "smooth",
            FrictionLaw::Viscous { .. } => "viscous",
        }
    }

    /// Returns whether bodies can stick: whether the force at rest can take any value in an
    /// interval.
    pub fn can_stick(&self) -> bool {
        matches!(self, FrictionLaw::Coulomb | FrictionLaw::Stribeck { .. })
    }

    /// Whether friction in slip is a fixed part of the normal force and a drag in proportion to speed, for
    /// a contact with this (kinetic) coefficient.
    pub fn is_linear(&self, friction_coefficient: f64) -> bool {
        match *self {
            FrictionLaw::Coulomb | FrictionLaw::Viscous { .. } => true,
            FrictionLaw::Stribeck { static_friction_coefficient, stribeck_speed } => {
                stribeck_speed == 0.0 || static_friction_coefficient == friction_coefficient
            }
            FrictionLaw::Smooth { .. } => false,
        }
    }

    /// Returns the largest ratio of friction to normal force, at rest or at any speed, of a contact
    /// with this (kinetic) coefficient.
    pub fn largest_ratio(&self, friction_coefficient: f64) -> f64 {
        match *self {
            FrictionLaw::Coulomb | FrictionLaw::Smooth { .. } => friction_coefficient,
            FrictionLaw::Stribeck { static_friction_coefficient, .. } => {
                static_friction_coefficient
            }
            FrictionLaw::Viscous { .. } => 0.0,
        }
    }

    /// Checks that all values have a physical meaning, for a contact with this (kinetic)
    /// coefficient.
    ///
    /// # Errors
    /// The first invalid parameter; `speed_unit` ends the names of speeds, as in a study file.
    pub(super) fn validate(
        &self,
        friction_coefficient: f64,
        speed_unit: &str,
    ) -> Result<(), InvalidParameter> {
        let with_unit = |error: InvalidParameter| InvalidParameter {
            name: format!("{}_{speed_unit}", error.name),
            ..error
        };
        match *self {
            FrictionLaw::Coulomb => Ok(()),
            FrictionLaw::Stribeck { static_friction_coefficient: fixed, stribeck_speed } => {
                if !fixed.is_finite() || fixed < friction_coefficient {
                    let allowed = "a finite number, not below the friction coefficient";
                    return Err(invalid(
                        "static_friction_coefficient",
                        &fixed.to_string(),
                        allowed,
                    ));
                }
                not_negative("stribeck_speed", stribeck_speed).map_err(with_unit)
            }
            FrictionLaw::Smooth { smoothing_speed } => {
                positive("smoothing_speed", smoothing_speed).map_err(with_unit)
            }
            FrictionLaw::Viscous { viscous_coefficient_n_s_m } => {
                not_negative("viscous_coefficient_n_s_m", viscous_coefficient_n_s_m)
            }
        }
    }

    /// Returns the non-dimensional friction of a contact with the (kinetic) coefficient
    /// `coefficient`, the unit of sliding speed `speed_unit` (SI) and the unit of the viscous
    /// coefficient `drag_unit` (N s/m).
    pub(super) fn contact(&self, coefficient: f64, speed_unit: f64, drag_unit: f64) -> Friction {
        let dry = |limit, sliding| Friction { coefficient, limit, sliding };
        match *self {
            FrictionLaw::Coulomb => dry(coefficient, Sliding::Coulomb),
            FrictionLaw::Stribeck { static_friction_coefficient, stribeck_speed } => {
                let speed = stribeck_speed / speed_unit;
                dry(static_friction_coefficient, Sliding::Stribeck { speed })
            }
            FrictionLaw::Smooth { smoothing_speed } => {
                dry(0.0, Sliding::Smooth { speed: smoothing_speed / speed_unit })
            }
            FrictionLaw::Viscous { viscous_coefficient_n_s_m } => {
                let drag = viscous_coefficient_n_s_m / drag_unit;
                Friction { coefficient: 0.0, limit: 0.0, sliding: Sliding::Viscous { drag } }
            }
        }
    }
}

/// Non-dimensional friction of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Ratio of friction to normal force in fast slip, `μ`; 0 without dry friction.
    pub coefficient: f64,
    /// Largest ratio of friction to normal force in stick, `μ_s`; 0 if the contact cannot stick.
    pub limit: f64,
    /// How friction in slip depends on speed.
    pub sliding: Sliding,
}

/// How friction in slip depends on the non-dimensional sliding speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sliding {
    /// No dependence.
    Coulomb,
    /// The coefficient falls from the limit to the kinetic value.
    Stribeck {
        /// The characteristic speed of the fall; at 0 it is a jump.
        speed: f64,
    },
    /// The coefficient grows from 0 to its final value.
    Smooth {
        /// The speed at which half of it is reached.
        speed: f64,
    },
    /// Viscous drag, independent of the normal force.
    Viscous {
        /// Drag over speed.
        drag: f64,
    },
}

impl Friction {
    /// Coulomb friction.
    pub fn coulomb(coefficient: f64) -> Self {
        Friction { coefficient, limit: coefficient, sliding: Sliding::Coulomb }
    }

    /// Returns the largest ratio of friction to normal force, at rest or at any speed.
    #[inline]
    pub fn largest_ratio(&self) -> f64 {
        self.limit.max(self.coefficient)
    }

    /// Whether friction in slip does not depend on speed.
    #[inline]
    pub fn is_constant(&self) -> bool {
        matches!(self.sliding, Sliding::Coulomb)
    }

    /// Whether the contact can stick.
    pub fn can_stick(&self) -> bool {
        matches!(self.sliding, Sliding::Coulomb | Sliding::Stribeck { .. })
    }

    /// Returns the largest damping rate by friction that grows with speed, non-dimensional, for a
    /// contact of mass 1 under this normal force: a measure of the stiffness of the equations of
    /// motion.
    pub fn damping_rate(&self, normal: f64) -> f64 {
        match self.sliding {
            Sliding::Coulomb | Sliding::Stribeck { .. } => 0.0,
            Sliding::Smooth { speed } => {
                self.coefficient * normal * std::f64::consts::FRAC_2_PI / speed
            }
            Sliding::Viscous { drag } => drag,
        }
    }

    /// Returns the friction of a contact that moves, or is about to move, in a direction (1 or -1)
    /// at a speed. A law that cannot stick ignores the direction.
    #[inline]
    pub fn slip(&self, direction: f64, speed: f64) -> Contact {
        let (signed_friction, drag) = match self.sliding {
            Sliding::Coulomb => (direction * self.coefficient, 0.0),
            Sliding::Stribeck { speed: reference } => {
                // Inside the band of the switch model, a speed against the direction is rounding or
                // rest.
                let sliding = (direction * speed).max(0.0);
                let excess = if reference > 0.0 { libm::exp(-sliding / reference) } else { 0.0 };
                let ratio = self.coefficient + (self.limit - self.coefficient) * excess;
                (direction * ratio, 0.0)
            }
            Sliding::Smooth { speed: reference } => {
                let share = libm::atan(speed / reference) * std::f64::consts::FRAC_2_PI;
                (self.coefficient * share, 0.0)
            }
            Sliding::Viscous { drag } => (0.0, drag * speed),
        };
        Contact { free: 1.0, signed_friction, drag }
    }
}
