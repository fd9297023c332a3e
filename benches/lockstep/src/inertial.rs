//! One step of DOP853 with the table's place in a frame at rest, aligned with the turning frame at the
//! step's start: the same interface as `step::attempt`.
//!
//! The table's own frequency is 1 there and the balls push it at w = ω + β̇, so that nothing is as fast as
//! the 1 + |ω| of the turning frame. The imbalance turns instead. Angles and speeds of the balls stay
//! relative to the ring, so that a ball that sticks keeps its angle to the last bit.

use fearless_simd::{Simd, f64x8, prelude::*};

use crate::equations::{N, Phase, Vector};
use crate::sincos::sin_cos;
use crate::step::{Tolerance, Tried, combine, error_squared};
use crate::tableau::{NODES, SOLUTION, STAGES};

/// Derivative at one stage; `turned` is ωτ.
#[inline]
fn derivative<S: Simd>(phase: &Phase<S>, turned: f64x8<S>, state: &Vector<S>, out: &mut Vector<S>) {
    phase.omega.simd.vectorize(
        #[inline(always)]
        || {
            let [x, y, v_x, v_y, b1, b2, w1, w2] = *state;
            let (sine, cosine) = sin_cos(turned);
            let force = [
                (-phase.drag).mul_add_precise(v_x, phase.imbalance.mul_add_precise(cosine, -x)),
                (-phase.drag).mul_add_precise(v_y, phase.imbalance.mul_add_precise(sine, -y)),
            ];
            let (a, alpha, _) =
                phase.accelerations(force, [sin_cos(b1 + turned), sin_cos(b2 + turned)], [w1, w2]);
            *out = [v_x, v_y, a[0], a[1], w1, w2, alpha[0], alpha[1]];
        },
    );
}

/// Tries a step, as `step::attempt`.
#[inline(always)]
pub fn attempt<S: Simd>(
    tolerance: Tolerance,
    phase: &Phase<S>,
    start: &Vector<S>,
    slope: &Vector<S>,
    length: f64x8<S>,
    stages: &mut [Vector<S>; 12],
    tried: &mut Tried<S>,
) {
    let omega = phase.omega;
    let mut base = *start;
    base[2] = start[2] - omega * start[1];
    base[3] = start[3] + omega * start[0];
    stages[0] = *slope;
    stages[0][0] = base[2];
    stages[0][1] = base[3];
    stages[0][2] = slope[2] - (phase.two_omega * start[3] + phase.omega_squared * start[0]);
    stages[0][3] = slope[3] + (phase.two_omega * start[2] - phase.omega_squared * start[1]);
    let mut state = base;
    let turned = omega * length;
    macro_rules! stage {
        ($($index:literal)*) => {$(
            for i in 0..N {
                let slope = combine(STAGES[$index], i, stages);
                state[i] = length.mul_add_precise(slope, base[i]);
            }
            let node = turned * f64x8::splat(length.simd, NODES[$index]);
            derivative(phase, node, &state, &mut stages[$index + 1]);
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
    let mut end = base;
    for i in 0..N {
        let slope = combine(SOLUTION, i, stages);
        end[i] = length.mul_add_precise(slope, end[i]);
    }
    tried.error_squared = error_squared(tolerance, length, &base, &end, stages);
    let (s, c) = sin_cos(turned);
    let [x, y, v_x, v_y, ..] = end;
    end[0] = c.mul_add_precise(x, s * y);
    end[1] = c.mul_add_precise(y, -(s * x));
    end[2] = c.mul_add_precise(v_x, s * v_y) + omega * end[1];
    end[3] = c.mul_add_precise(v_y, -(s * v_x)) - omega * end[0];
    (tried.derivative, tried.contacts) = phase.full(&end);
    tried.end = end;
}
