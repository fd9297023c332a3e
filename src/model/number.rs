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
