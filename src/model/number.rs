//! The arithmetic of the equations of motion, so that they are written once for one run (`f64`) and
//! for several runs in lockstep (a vector of lanes).

use std::ops::{Add, Mul, Neg, Sub};

/// A real number, or a vector of independent real numbers.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Returns a constant in all lanes.
    fn constant(value: f64) -> Self;
    /// Sine and cosine, angle in rad.
    fn sin_cos(self) -> (Self, Self);
    /// One over the number.
    fn reciprocal(self) -> Self;
}

/// A number with elementary functions.
pub trait Elementary: Number {
    /// The number without its slope.
    fn value(self) -> f64;
    /// Whether it is zero, with its slope.
    fn is_zero(self) -> bool;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Another elementary function.
    fn function(self, function: Function) -> Self;
}

/// An elementary function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Function {
    /// `exp a`
    Exponential,
    /// `atan a`
    ArcTangent,
    /// The natural logarithm; not a number for an argument below 0.
    Logarithm,
}

/// Exponential functions of larger arguments have the value at this one.
const LARGEST_EXPONENT: f64 = 300.0;

impl Function {
    /// Returns the value of the function.
    pub fn of(self, number: f64) -> f64 {
        match self {
            // One over it is then below rounding, and powers of it do not overflow: `tanh 1000` is 1.
            Function::Exponential if number > LARGEST_EXPONENT => libm::exp(LARGEST_EXPONENT),
            Function::Exponential => libm::exp(number),
            Function::ArcTangent => libm::atan(number),
            Function::Logarithm => libm::log(number),
        }
    }
}

impl Elementary for f64 {
    fn value(self) -> f64 {
        self
    }

    fn is_zero(self) -> bool {
        self == 0.0
    }

    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }

    fn function(self, function: Function) -> Self {
        function.of(self)
    }
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    /// Computed by a library in plain Rust rather than the platform's, so that the last bit of a
    /// result does not depend on the operating system.
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }

    fn reciprocal(self) -> Self {
        1.0 / self
    }
}
