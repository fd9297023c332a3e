//! One step of DOP853 in all lanes: in each its own start, length and smooth phase. The same method and
//! the same estimate of the error as in `motion::dop853`.

use fearless_simd::{Simd, prelude::*};

use super::equations::{Equations, Force, Linearised};
use super::{Flow, Lanes};
use crate::motion::dop853_tableau::{ERROR_FIFTH, ERROR_THIRD, SOLUTION, STAGES};

/// What came of a step that was tried.
#[derive(Clone, Copy)]
pub(crate) struct Tried<S: Simd, const N: usize> {
    /// State at its end.
    pub(super) end: Flow<S, N>,
    /// Rate of change there.
    pub(super) rate: Flow<S, N>,
    /// Forces there.
    pub(super) forces: [Force<S>; N],
    /// Square of the estimated error over what is allowed.
    pub(super) error_squared: Lanes<S>,
}

/// A linear combination of the stages' values of one component.
macro_rules! combined {
    ($terms:expr, $stages:expr, $($component:tt)+) => {{
        let (first, coefficient) = $terms[0];
        let simd = $stages[first].$($component)+.simd;
        let mut sum = $stages[first].$($component)+ * Lanes::splat(simd, coefficient);
        for &(stage, coefficient) in &$terms[1..] {
            let coefficient = Lanes::splat(simd, coefficient);
            sum = $stages[stage].$($component)+.mul_add_precise(coefficient, sum);
        }
        sum
    }};
}

/// `start + length · Σ a k` in each component.
macro_rules! moved {
    ($state:expr, $start:expr, $length:expr, $terms:expr, $stages:expr) => {
        for i in 0..4 {
            $state.table[i] =
                $length.mul_add_precise(combined!($terms, $stages, table[i]), $start.table[i]);
        }
        for i in 0..N {
            $state.angle[i] =
                $length.mul_add_precise(combined!($terms, $stages, angle[i]), $start.angle[i]);
            $state.speed[i] =
                $length.mul_add_precise(combined!($terms, $stages, speed[i]), $start.speed[i]);
        }
    };
}

/// Tries a step. `stages` is left with the rates of change at its stages; `linearised`, where it is
/// given, with what a displacement needs there.
#[inline(always)]
pub(super) fn attempt<S: Simd, const N: usize>(
    [relative, absolute]: [Lanes<S>; 2],
    equations: &Equations<S, N>,
    (start, rate): (&Flow<S, N>, &Flow<S, N>),
    length: Lanes<S>,
    stages: &mut [Flow<S, N>; 12],
    mut linearised: Option<&mut [Linearised<S, N>; 12]>,
    tried: &mut Tried<S, N>,
) {
    let simd = length.simd;
    stages[0] = *rate;
    let mut state = *start;
    if let Some(linearised) = &mut linearised {
        equations.rate_and_linearised(start, &mut stages[0], &mut linearised[0]);
        stages[0] = *rate;
    }
    macro_rules! stages {
        ($($index:literal)*) => {$(
            moved!(state, start, length, STAGES[$index], stages);
            if let Some(linearised) = &mut linearised {
                equations.rate_and_linearised(
                    &state,
                    &mut stages[$index + 1],
                    &mut linearised[$index + 1],
                );
            } else {
                equations.rate(&state, &mut stages[$index + 1]);
            }
        )*};
    }
    stages!(0 1 2 3 4 5 6 7 8 9 10);
    let mut end = *start;
    moved!(end, start, length, SOLUTION, stages);
    (tried.rate, tried.forces, _) = equations.evaluate(&end);
    tried.end = end;
    // Σ (e_i / s_i)², two components over one denominator: half of the divisions. Table and balls are
    // summed apart, so that two balls exchanged give the same to the last bit.
    macro_rules! part {
        ($scale:expr, $($component:tt)+) => {{
            let scale = $scale;
            let fifth = combined!(ERROR_FIFTH, stages, $($component)+);
            let third = combined!(ERROR_THIRD, stages, $($component)+);
            (scale * scale, fifth * fifth, third * third)
        }};
    }
    macro_rules! scale {
        ($($component:tt)+) => {
            relative
                .mul_add_precise(start.$($component)+.abs().max(end.$($component)+.abs()), absolute)
        };
    }
    macro_rules! pair {
        ($one:expr, $other:expr) => {{
            let (s_i, f_i, t_i) = $one;
            let (s_j, f_j, t_j) = $other;
            let inverse = Lanes::splat(simd, 1.0) / (s_i * s_j);
            ((f_i * s_j + f_j * s_i) * inverse, (t_i * s_j + t_j * s_i) * inverse)
        }};
    }
    let (fifth_1, third_1) =
        pair!(part!(scale!(table[0]), table[0]), part!(scale!(table[1]), table[1]));
    let (fifth_2, third_2) =
        pair!(part!(scale!(table[2]), table[2]), part!(scale!(table[3]), table[3]));
    let mut fifth = fifth_1 + fifth_2;
    let mut third = third_1 + third_2;
    let angular = relative + absolute;
    let (mut fifth_balls, mut third_balls) = (fifth, third);
    for i in 0..N {
        let (f, t) = pair!(part!(angular, angle[i]), part!(scale!(speed[i]), speed[i]));
        if i == 0 {
            (fifth_balls, third_balls) = (f, t);
        } else {
            (fifth_balls, third_balls) = (fifth_balls + f, third_balls + t);
        }
    }
    fifth += fifth_balls;
    third += third_balls;
    let tiny = Lanes::splat(simd, 1e-60);
    let weight = third.mul_add_precise(Lanes::splat(simd, 0.01), fifth + tiny);
    let scaled = length * fifth;
    let components = (4 + 2 * N) as f64;
    tried.error_squared = scaled * scaled / (weight * Lanes::splat(simd, components));
}

/// Carries a displacement over the step whose stages `linearised` has, in the lanes in which the step
/// stands; `rates` is room to work in.
#[inline(always)]
pub(super) fn carry<S: Simd, const N: usize>(
    equations: &Equations<S, N>,
    displacement: &Flow<S, N>,
    length: Lanes<S>,
    linearised: &[Linearised<S, N>; 12],
    rates: &mut [Flow<S, N>; 12],
) -> Flow<S, N> {
    equations.displacement_rate(&linearised[0], displacement, &mut rates[0]);
    let mut state = *displacement;
    macro_rules! stages {
        ($($index:literal)*) => {$(
            moved!(state, displacement, length, STAGES[$index], rates);
            equations.displacement_rate(&linearised[$index + 1], &state, &mut rates[$index + 1]);
        )*};
    }
    stages!(0 1 2 3 4 5 6 7 8 9 10);
    let mut end = *displacement;
    moved!(end, displacement, length, SOLUTION, rates);
    end
}
