//! Bounds of a condition over a step, from its values and slopes at both ends.

use fearless_simd::prelude::*;

use super::Lanes;
use super::root_isolation::{Bounds, FOURTH, PolynomialPoint};
use crate::motion::lockstep::vector::{Fused, Vector};

/// Values of a polynomial at both ends of a step, its slopes there times the step's length, and a
/// bound of its fourth derivative times the fourth power of the length.
#[derive(Clone, Copy)]
pub(super) struct LaneBounds<S: Vector> {
    pub(super) values: [Lanes<S>; 2],
    pub(super) changes: [Lanes<S>; 2],
    pub(super) bound: Lanes<S>,
}

impl<S: Vector> LaneBounds<S> {
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        LaneBounds { values: [zero; 2], changes: [zero; 2], bound: zero }
    }

    /// Returns the bounds of a series with these coefficients up to the power `highest`, over a step of this length.
    #[inline(always)]
    pub(super) fn of_series(
        length: Lanes<S>,
        highest: usize,
        coefficient: impl Fn(usize) -> Lanes<S>,
    ) -> Self {
        let zero = Lanes::splat(length.simd, 0.0);
        let (mut bound, mut value, mut slope) = (zero, zero, zero);
        for k in (0..=highest).rev() {
            let coefficient = coefficient(k);
            slope = slope.fused(length, value);
            value = value.fused(length, coefficient);
            if k >= 4 {
                let weight = Lanes::splat(length.simd, FOURTH[k]);
                bound = bound.fused(length, weight * coefficient.abs());
            }
        }
        let square = length * length;
        LaneBounds {
            values: [coefficient(0), value],
            changes: [coefficient(1) * length, slope * length],
            bound: bound * (square * square),
        }
    }

    /// Returns the bounds of one lane.
    #[inline(always)]
    pub(super) fn outline(&self, lane: usize) -> Bounds {
        let end = |which: usize| PolynomialPoint {
            at: which as f64,
            value: self.values[which][lane],
            slope: self.changes[which][lane],
        };
        Bounds { ends: [end(0), end(1)], fourth_derivative: self.bound[lane] }
    }

    /// Returns where it is certainly positive: no coefficient of its Bernstein form of degree four
    /// is negative (`root_isolation`).
    #[inline(always)]
    pub(super) fn holds(&self) -> fearless_simd::mask64x8<S> {
        let simd = self.bound.simd;
        let number = |value: f64| Lanes::splat(simd, value);
        let ([a, b], [p, q]) = (self.values, self.changes);
        let fourth = number(0.25);
        let early = p.fused(fourth, a);
        let late = q.fused(-fourth, b);
        let middle = (p - q).fused(number(1.0 / 3.0), a + b) * number(0.5);
        let middle = self.bound.fused(number(-1.0 / 144.0), middle);
        a.min(b).min(early.min(late)).min(middle).simd_ge(number(0.0))
    }
}
