//! One step of DOP853 in lockstep: in each lane its own start, length and smooth phase.

use fearless_simd::{Simd, f64x8, prelude::*};

use crate::equations::{Contact, N, Phase, Vector};
use crate::tableau::{ERROR_FIFTH, ERROR_THIRD, SOLUTION, STAGES, Term};

/// Errors allowed: the same in all lanes.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    pub relative: f64,
    pub absolute: f64,
}

/// Where in a step the balls' speeds and accelerations are kept: at three stages.
pub const INNER: [f64; 3] = [1.0 / 3.0, 127.0 / 195.0, 6.0 / 7.0];

/// What came of a step in eight lanes.
#[derive(Clone, Copy)]
pub struct Tried<S: Simd> {
    pub end: Vector<S>,
    pub derivative: Vector<S>,
    pub contacts: [Contact<S>; 2],
    /// Square of the estimated error over what is allowed.
    pub error_squared: f64x8<S>,
    /// Both speeds and both accelerations at `INNER`.
    pub inner: [[f64x8<S>; 4]; 3],
}

#[inline(always)]
pub fn combine<S: Simd>(terms: &[Term], component: usize, stages: &[Vector<S>; 12]) -> f64x8<S> {
    let simd = stages[0][0].simd;
    let (first, coefficient) = terms[0];
    let mut sum = stages[first][component] * f64x8::splat(simd, coefficient);
    for &(stage, coefficient) in &terms[1..] {
        sum = stages[stage][component].mul_add_precise(f64x8::splat(simd, coefficient), sum);
    }
    sum
}

/// Tries a step. `stages` is room to work in.
#[inline(always)]
pub fn attempt<S: Simd>(
    tolerance: Tolerance,
    phase: &Phase<S>,
    start: &Vector<S>,
    derivative: &Vector<S>,
    length: f64x8<S>,
    stages: &mut [Vector<S>; 12],
    tried: &mut Tried<S>,
) {
    stages[0] = *derivative;
    let mut state = *start;
    macro_rules! stage {
        ($($index:literal)*) => {$(
            for i in 0..N {
                let slope = combine(STAGES[$index], i, stages);
                state[i] = length.mul_add_precise(slope, start[i]);
            }
            phase.derivative(&state, &mut stages[$index + 1]);
        )*};
    }
    macro_rules! look {
        ($to:literal $stage:literal) => {
            tried.inner[$to] = [state[6], state[7], stages[$stage][6], stages[$stage][7]];
        };
    }
    stage!(0 1 2 3 4);
    look!(0 5);
    stage!(5 6 7);
    look!(1 8);
    stage!(8 9);
    look!(2 10);
    stage!(10);
    {
        let mut end = *start;
        for i in 0..N {
            let slope = combine(SOLUTION, i, stages);
            end[i] = length.mul_add_precise(slope, end[i]);
        }
        (tried.derivative, tried.contacts) = phase.full(&end);
        tried.end = end;
    }
    tried.error_squared = error_squared(tolerance, length, start, &tried.end, stages);
}

/// Square of the estimated error over what is allowed.
#[inline(always)]
pub fn error_squared<S: Simd>(
    tolerance: Tolerance,
    length: f64x8<S>,
    start: &Vector<S>,
    end: &Vector<S>,
    stages: &[Vector<S>; 12],
) -> f64x8<S> {
    let simd = length.simd;
    {
        let relative = f64x8::splat(simd, tolerance.relative);
        let absolute = f64x8::splat(simd, tolerance.absolute);
        // Σ (e_i / s_i)² as fractions with one denominator for two components: half the divisions.
        macro_rules! part {
            ($i:expr) => {{
                let size = start[$i].abs().max(end[$i].abs());
                let scale = if $i == 4 || $i == 5 {
                    relative + absolute
                } else {
                    relative.mul_add_precise(size, absolute)
                };
                let fifth = combine(ERROR_FIFTH, $i, stages);
                let third = combine(ERROR_THIRD, $i, stages);
                (scale * scale, fifth * fifth, third * third)
            }};
        }
        let mut fifth = f64x8::splat(simd, 0.0);
        let mut third = fifth;
        for (i, j) in [(0, 1), (2, 3), (4, 5), (6, 7)] {
            let (s_i, f_i, t_i) = part!(i);
            let (s_j, f_j, t_j) = part!(j);
            let inverse = f64x8::splat(simd, 1.0) / (s_i * s_j);
            fifth = fifth + (f_i * s_j + f_j * s_i) * inverse;
            third = third + (t_i * s_j + t_j * s_i) * inverse;
        }
        let tiny = f64x8::splat(simd, 1e-60);
        let weight = third.mul_add_precise(f64x8::splat(simd, 0.01), fifth + tiny);
        let scaled = length * fifth;
        scaled * scaled / (weight * f64x8::splat(simd, N as f64))
    }
}
