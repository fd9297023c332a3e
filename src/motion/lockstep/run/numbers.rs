//! What a cell of a program contains: a number of each lane, or a number of one run.

use std::ops::{Div, Mul, Neg};

use fearless_simd::prelude::*;

use crate::graph::Cell;
use crate::model::Function;
use crate::motion::lockstep::trigonometry::sin_cos;
use crate::motion::lockstep::vector::{Fused, Vector, Width};
use crate::motion::lockstep::{LANES, Lanes};

/// The operations of programs. Each is correctly rounded, or computed by the same operations for all kinds of numbers.
pub(in crate::motion::lockstep) trait Numbers<S: Vector>:
    Copy + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Returns the width of machine code for these numbers.
    fn width() -> Option<Width>;
    /// Returns this number, in all lanes.
    fn of(simd: S, number: f64) -> Self;
    /// Returns `self b + c`, rounded once.
    fn times_plus(self, b: Self, c: Self) -> Self;
    /// Returns the square root.
    fn root(self) -> Self;
    /// Returns the absolute value.
    fn size(self) -> Self;
    /// Returns `then` where `less[0] < less[1]`, and `other` elsewhere.
    fn choice(less: [Self; 2], then: Self, other: Self) -> Self;
    /// Writes sines and cosines to cells; each of `turns` names both cells and that of the angle, which is none of the others.
    fn sines_cosines(simd: S, memory: &mut [Self], turns: &[[Cell; 3]]);
    /// Returns the value of an elementary function.
    fn image(self, function: Function) -> Self;
}

impl<S: Vector> Numbers<S> for Lanes<S> {
    fn width() -> Option<Width> {
        S::WIDTH.map(Width::widest)
    }

    #[inline(always)]
    fn of(simd: S, number: f64) -> Self {
        Lanes::splat(simd, number)
    }

    #[inline(always)]
    fn times_plus(self, b: Self, c: Self) -> Self {
        self.fused(b, c)
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn size(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn choice([a, b]: [Self; 2], then: Self, other: Self) -> Self {
        a.simd_lt(b).select(then, other)
    }

    #[inline(always)]
    fn sines_cosines(_simd: S, memory: &mut [Self], turns: &[[Cell; 3]]) {
        for [sine, cosine, of] in turns {
            let (s, c) = sin_cos(memory[*of as usize]);
            memory[*sine as usize] = s;
            memory[*cosine as usize] = c;
        }
    }

    fn image(mut self, function: Function) -> Self {
        for lane in 0..LANES {
            self[lane] = function.of(self[lane]);
        }
        self
    }
}

impl<S: Vector> Numbers<S> for f64 {
    fn width() -> Option<Width> {
        S::WIDTH.map(|_| Width::One)
    }

    #[inline(always)]
    fn of(_simd: S, number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn times_plus(self, b: Self, c: Self) -> Self {
        self.mul_add(b, c)
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn size(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn choice([a, b]: [Self; 2], then: Self, other: Self) -> Self {
        if a < b { then } else { other }
    }

    #[inline(always)]
    fn sines_cosines(simd: S, memory: &mut [Self], turns: &[[Cell; 3]]) {
        for turns in turns.chunks(LANES) {
            // A vector of the angles of one run, not of lanes.
            let mut angles = Lanes::splat(simd, 0.0);
            for (place, [_, _, of]) in turns.iter().enumerate() {
                angles[place] = memory[*of as usize];
            }
            let (sines, cosines) = sin_cos(angles);
            for (place, [sine, cosine, _]) in turns.iter().enumerate() {
                memory[*sine as usize] = sines[place];
                memory[*cosine as usize] = cosines[place];
            }
        }
    }

    fn image(self, function: Function) -> Self {
        function.of(self)
    }
}
