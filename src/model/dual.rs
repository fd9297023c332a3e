//! Dual numbers: a value and its rate of change along a direction, for exact derivatives.
//!
//! The equations of motion are written once, for any [`Number`]; evaluated with these they give the
//! linearised equations as well (forward-mode differentiation; A. Griewank, A. Walther, *Evaluating
//! Derivatives*, 2nd ed., SIAM 2008, section 3.1, doi:10.1137/1.9780898717761).

use std::ops::{Add, Mul, Neg, Sub};

use super::{Contact, Friction, Number, Sliding, State};

/// `value + slope ε` with `ε² = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    /// The number itself.
    pub value: f64,
    /// Its rate of change along the direction.
    pub slope: f64,
}

impl Add for Dual {
    type Output = Dual;

    #[inline]
    fn add(self, other: Dual) -> Dual {
        Dual { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl Sub for Dual {
    type Output = Dual;

    #[inline]
    fn sub(self, other: Dual) -> Dual {
        Dual { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl Mul for Dual {
    type Output = Dual;

    #[inline]
    fn mul(self, other: Dual) -> Dual {
        Dual {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
        }
    }
}

impl Neg for Dual {
    type Output = Dual;

    #[inline]
    fn neg(self) -> Dual {
        Dual { value: -self.value, slope: -self.slope }
    }
}

impl Number for Dual {
    #[inline]
    fn constant(value: f64) -> Dual {
        Dual { value, slope: 0.0 }
    }

    #[inline]
    fn sin_cos(self) -> (Dual, Dual) {
        let (sine, cosine) = libm::sincos(self.value);
        (
            Dual { value: sine, slope: self.slope * cosine },
            Dual { value: cosine, slope: -self.slope * sine },
        )
    }

    #[inline]
    fn reciprocal(self) -> Dual {
        let value = 1.0 / self.value;
        Dual { value, slope: -self.slope * value * value }
    }
}

impl<const N: usize, const FREE: usize> State<N, f64, FREE> {
    /// Returns this state, moving along a direction.
    pub fn along(&self, direction: &Self) -> State<N, Dual, FREE> {
        let dual = |value: f64, slope: f64| Dual { value, slope };
        State {
            position: std::array::from_fn(|i| dual(self.position[i], direction.position[i])),
            velocity: std::array::from_fn(|i| dual(self.velocity[i], direction.velocity[i])),
            beta: std::array::from_fn(|i| dual(self.beta[i], direction.beta[i])),
            beta_dot: std::array::from_fn(|i| dual(self.beta_dot[i], direction.beta_dot[i])),
        }
    }
}

impl<const N: usize, const FREE: usize> State<N, Dual, FREE> {
    /// The direction in which the state moves.
    pub fn slope(&self) -> State<N, f64, FREE> {
        State {
            position: self.position.map(|number| number.slope),
            velocity: self.velocity.map(|number| number.slope),
            beta: self.beta.map(|number| number.slope),
            beta_dot: self.beta_dot.map(|number| number.slope),
        }
    }
}

impl Friction {
    /// [`Friction::slip`] to first order in the speed.
    pub fn slip_along(&self, direction: f64, speed: Dual) -> Contact<Dual> {
        let Contact { free, signed_friction, drag } = self.slip(direction, speed.value);
        let (friction_slope, drag_slope) = match self.sliding {
            Sliding::Coulomb => (0.0, 0.0),
            Sliding::Stribeck { speed: reference } => {
                let falls = reference > 0.0 && direction * speed.value >= 0.0;
                let excess = signed_friction - direction * self.coefficient;
                (if falls { -direction * excess / reference } else { 0.0 }, 0.0)
            }
            Sliding::Smooth { speed: reference } => {
                let ratio = speed.value / reference;
                let bend = std::f64::consts::FRAC_2_PI / (reference * (1.0 + ratio * ratio));
                (self.coefficient * bend, 0.0)
            }
            Sliding::Viscous { drag } => (0.0, drag),
        };
        Contact {
            free: Dual::constant(free),
            signed_friction: Dual { value: signed_friction, slope: friction_slope * speed.slope },
            drag: Dual { value: drag, slope: drag_slope * speed.slope },
        }
    }
}
