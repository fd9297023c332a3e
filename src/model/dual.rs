//! Dual numbers: a value and its rate of change along a direction, for exact derivatives.
//!
//! The equations of motion are written once, for any [`Number`]; evaluated with these they give the
//! linearised equations as well (forward-mode differentiation; A. Griewank, A. Walther, *Evaluating
//! Derivatives*, 2nd ed., SIAM 2008, section 3.1, doi:10.1137/1.9780898717761).

use std::ops::{Add, Mul, Neg, Sub};

use super::{Elementary, Function, Number, State};

/// `value + slope ε` with `ε² = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T = f64> {
    /// The number itself.
    pub value: T,
    /// Its rate of change along the direction.
    pub slope: T,
}

impl<T: Add<Output = T>> Add for Dual<T> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Dual { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<T: Sub<Output = T>> Sub for Dual<T> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Dual { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<T: Copy + Add<Output = T> + Mul<Output = T>> Mul for Dual<T> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Dual {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
        }
    }
}

impl<T: Neg<Output = T>> Neg for Dual<T> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
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

impl<T: Mul<Output = T>> Dual<T> {
    /// The function value with the slope of the function times that of its argument.
    pub(super) fn chain(self, value: T, slope: T) -> Self {
        Dual { value, slope: slope * self.slope }
    }
}

impl Elementary for Dual {
    fn value(self) -> f64 {
        self.value
    }

    fn is_zero(self) -> bool {
        self.value == 0.0 && self.slope == 0.0
    }

    fn sqrt(self) -> Dual {
        let root = libm::sqrt(self.value);
        self.chain(root, 0.5 / root)
    }

    fn function(self, function: Function) -> Dual {
        let value = function.of(self.value);
        let slope = match function {
            Function::Exponential => value,
            Function::ArcTangent => 1.0 / (1.0 + self.value * self.value),
            Function::Logarithm => 1.0 / self.value,
        };
        self.chain(value, slope)
    }
}

impl<const N: usize> State<N> {
    /// Returns this state, moving along a direction.
    pub fn along(&self, direction: &Self) -> State<N, Dual> {
        let dual = |value: f64, slope: f64| Dual { value, slope };
        State {
            position: std::array::from_fn(|i| dual(self.position[i], direction.position[i])),
            velocity: std::array::from_fn(|i| dual(self.velocity[i], direction.velocity[i])),
            beta: std::array::from_fn(|i| dual(self.beta[i], direction.beta[i])),
            beta_dot: std::array::from_fn(|i| dual(self.beta_dot[i], direction.beta_dot[i])),
        }
    }
}

impl<const N: usize> State<N, Dual> {
    /// The direction in which the state moves.
    pub fn slope(&self) -> State<N> {
        State {
            position: self.position.map(|number| number.slope),
            velocity: self.velocity.map(|number| number.slope),
            beta: self.beta.map(|number| number.slope),
            beta_dot: self.beta_dot.map(|number| number.slope),
        }
    }
}
