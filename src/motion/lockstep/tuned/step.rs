//! The length of a step of the balancer, from the last coefficients of the speeds.

use fearless_simd::prelude::*;

use super::series::BalancerSeries;
use crate::motion::lockstep::step_length::{longest_step, reciprocal};
use crate::motion::lockstep::vector::{Fused, Vector};
use crate::motion::lockstep::{Lanes, ORDER};

/// Returns the longest step within the tolerance; `before` is that of the previous step.
#[inline(always)]
pub(super) fn within_tolerance<S: Vector, const N: usize>(
    series: &BalancerSeries<S, N>,
    [relative, absolute]: [Lanes<S>; 2],
    before: Lanes<S>,
) -> Lanes<S> {
    let simd = before.simd;
    let terms = &series.terms;
    let highest = Lanes::splat(simd, (ORDER + 1) as f64);
    let second = Lanes::splat(simd, ORDER as f64);
    let mut last = Lanes::splat(simd, 0.0);
    let mut last_but_one = last;
    // The larger of the table's two velocities counts.
    let table = |k: usize| terms[k].table[0].abs().max(terms[k].table[1].abs());
    for i in 0..=N {
        let (size, ultimate, penultimate) = if i == N {
            (table(1), highest * table(ORDER + 1), second * table(ORDER))
        } else {
            let speed = |k: usize| terms[k].balls[i].speed.abs();
            (speed(0), speed(ORDER), speed(ORDER - 1))
        };
        let scale = reciprocal(relative.fused(size, absolute));
        last = last.max(ultimate * scale);
        last_but_one = last_but_one.max(penultimate * scale);
    }
    longest_step([last, last_but_one], before)
}
