//! The recurrence from the lower coefficients of all series to the next: products of series, and
//! the linear equations for the accelerations (`series`).

use fearless_simd::prelude::*;

use super::equations::Equations;
use super::gap_forces::{GapForceEffect, OfEach};
use super::terms::{DYING, PowerCoefficients, ResidualForce, Solver};
use crate::motion::lockstep::vector::{Fused, Vector};
use crate::motion::lockstep::{Lanes, TERMS};

/// 1/k.
pub(super) const RECIPROCALS: [f64; TERMS + 1] = {
    let mut all = [1.0; TERMS + 1];
    let mut k = 1;
    while k <= TERMS {
        all[k] = 1.0 / k as f64;
        k += 1;
    }
    all
};

/// The sums of products of lower orders, for one ball.
#[derive(Clone, Copy)]
pub(super) struct ProductSums<S: Vector> {
    /// Of Σ β̇_j U_{k+1-j}, U being the direction.
    pub(super) turning: [Lanes<S>; 2],
    /// Of u·a.
    pub(super) drawn: Lanes<S>,
    /// Of the speed's square.
    pub(super) squared: Lanes<S>,
}

impl<S: Vector> ProductSums<S> {
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        ProductSums { turning: [zero; 2], drawn: zero, squared: zero }
    }
}

/// Computes coefficient `k + 1` of the products of the speeds of one series and the directions of
/// another, and coefficient `k` of the products of its pull and the directions, without the terms
/// that have the directions at order 0. Several balls are computed together, as many as the registers hold.
#[inline(always)]
pub(super) fn products<S: Vector, const N: usize>(
    of: &[PowerCoefficients<S, N>; TERMS],
    with: &[PowerCoefficients<S, N>; TERMS],
    k: usize,
    sums: &mut [ProductSums<S>; N],
) {
    let mut first = 0;
    while S::HAS_MANY_REGISTERS && first + 4 <= N {
        products_of::<S, N, 4>(of, with, k, first, sums);
        first += 4;
    }
    while S::HAS_MANY_REGISTERS && first + 2 <= N {
        products_of::<S, N, 2>(of, with, k, first, sums);
        first += 2;
    }
    while first < N {
        products_of::<S, N, 1>(of, with, k, first, sums);
        first += 1;
    }
}

/// Computes [`products`] for `M` balls from `first` on.
#[inline(always)]
fn products_of<S: Vector, const N: usize, const M: usize>(
    of: &[PowerCoefficients<S, N>; TERMS],
    with: &[PowerCoefficients<S, N>; TERMS],
    k: usize,
    first: usize,
    sums: &mut [ProductSums<S>; N],
) {
    let zero = Lanes::splat(of[0].table[0].simd, 0.0);
    let (mut real, mut imaginary) = ([zero; M], [zero; M]);
    let mut along = [zero; M];
    let mut across = [zero; M];
    // The latest results are used last, to avoid waiting for them.
    let mut before = [[zero; 2]; M];
    for (before, ball) in before.iter_mut().zip(&with[k].balls[first..]) {
        *before = ball.direction;
    }
    if k > 0 {
        let [x, y] = of[0].pull;
        for i in 0..M {
            along[i] = before[i][1] * x;
            across[i] = before[i][0] * y;
        }
        let others = with[1..k].iter().rev();
        for (low, high) in of[1..k].iter().zip(others) {
            let [x, y] = low.pull;
            for i in 0..M {
                let speed = low.balls[first + i].speed;
                real[i] = speed.fused(before[i][0], real[i]);
                imaginary[i] = speed.fused(before[i][1], imaginary[i]);
                before[i] = high.balls[first + i].direction;
                along[i] = before[i][1].fused(x, along[i]);
                across[i] = before[i][0].fused(y, across[i]);
            }
        }
        for i in 0..M {
            let speed = of[k].balls[first + i].speed;
            let direction = with[1].balls[first + i].direction;
            real[i] = speed.fused(direction[0], real[i]);
            imaginary[i] = speed.fused(direction[1], imaginary[i]);
        }
    }
    for i in 0..M {
        let speed = of[0].balls[first + i].speed;
        let direction = with[k + 1].balls[first + i].direction;
        let real = speed.fused(direction[0], real[i]);
        let imaginary = speed.fused(direction[1], imaginary[i]);
        sums[first + i].turning = [real, imaginary];
        sums[first + i].drawn = along[i] - across[i];
    }
}

/// The constants of all orders of a series.
pub(super) struct Solving<'a, S: Vector, const N: usize> {
    pub(super) solver: &'a Solver<S, N>,
    /// The directions at the start of the motion, for a perturbation of it. Imbalance and resistance at speed 0 do not act on a
    /// perturbation.
    pub(super) start: Option<&'a PowerCoefficients<S, N>>,
    pub(super) residual: Option<&'a ResidualForce<S>>,
    /// The effect of forces in gaps.
    pub(super) gaps: &'a GapForceEffect<S, N>,
}

/// Solves the equations for coefficient `k` of the accelerations, and stores the dependent
/// coefficients. Returns the coefficients of the forces in gaps, if there are any. If not `TOUCHING`,
/// no balls touch: the instructions for their forces would take registers from the others.
#[inline(always)]
pub(super) fn solve<S: Vector, const N: usize, const TOUCHING: bool>(
    terms: &mut [PowerCoefficients<S, N>; TERMS],
    equations: &Equations<S, N>,
    by: &Solving<S, N>,
    k: usize,
    sums: &[ProductSums<S>; N],
) -> Option<OfEach<S, N>> {
    let simd = equations.speed.simd;
    let number = |value: f64| Lanes::splat(simd, value);
    let (of_next, of_after) = (RECIPROCALS[k + 1], RECIPROCALS[k + 2]);
    let (factor, minus) = (number((k + 1) as f64), number(-((k + 1) as f64)));
    let (lower, higher) = terms.split_at_mut(k + 1);
    let (now, [next, after, ..]) = (&mut lower[k], higher) else { return None };
    let solver = by.solver;
    let whole = by.start.is_none() && k == 0;
    let [x, y] = now.table;
    let [x_dot, y_dot] = [next.table[0] * factor, next.table[1] * factor];
    // Avoids a signed zero, which residual speeds in other lanes would change.
    let zero = number(0.0);
    let mut force_x = equations.drag_speed.fused(y, zero - x);
    let mut force_y = equations.minus_drag_speed.fused(x, zero - y);
    if whole {
        force_x += equations.constant[0];
        force_y += equations.constant[1];
    }
    force_x = equations.minus_drag.fused(x_dot, force_x);
    force_y = equations.minus_drag.fused(y_dot, force_y);
    if let Some(residual) = by.residual {
        let dying = [number(DYING[k][0]), number(DYING[k][1])];
        for (force, dying) in residual.iter().zip(dying) {
            force_x = dying.fused(force[0], force_x);
            force_y = dying.fused(force[1], force_y);
        }
    }
    let mut without_table = [zero; N];
    let (mut push_x, mut push_y) = (zero, zero);
    for i in 0..N {
        let ball = &equations.balls[i];
        let ProductSums { turning, drawn, squared } = sums[i];
        let speed = now.balls[i].speed;
        let [c, s] = now.balls[i].direction;
        let [c_next, s_next] = next.balls[i].direction;
        let mut held = ball.held[1].fused(speed, ball.held[2] * squared);
        if whole {
            held += ball.held[0];
        }
        without_table[i] = ball.drawing.fused(drawn, -held);
        // -(ë + 2iω ė - ω² e) without the contribution of the acceleration itself, times 1 + ip.
        let real = equations.double_speed.fused(c_next, turning[0]);
        let imaginary = equations.double_speed.fused(s_next, turning[1]);
        let around_x = factor.fused(imaginary, equations.speed_squared * c);
        let around_y = minus.fused(real, equations.speed_squared * s);
        // The sum times 1 only, with the contribution of the acceleration.
        let [along, across] = solver.reaction[i];
        let of_ball_x = ball.friction.fused(around_y, around_x);
        let of_ball_x = along.fused(without_table[i], of_ball_x);
        let of_ball_y = ball.minus_friction.fused(around_x, around_y);
        let of_ball_y = across.fused(without_table[i], of_ball_y);
        if i == 0 {
            (push_x, push_y) = (of_ball_x, of_ball_y);
        } else {
            (push_x, push_y) = (push_x + of_ball_x, push_y + of_ball_y);
        }
    }
    force_x += push_x;
    force_y += push_y;
    let [a, b, c, d] = solver.inverse;
    let mut pull = [a.fused(force_x, b * force_y), d.fused(force_y, c * force_x)];
    let mut accelerations = without_table;
    for i in 0..N {
        let [along, across] = solver.drawn[i];
        accelerations[i] = along.fused(pull[0], across.fused(pull[1], without_table[i]));
    }
    // A branch, not a closure: the fused multiply-add must be inlined.
    let forces = if TOUCHING { Some(by.gaps.join(&mut accelerations, &mut pull)) } else { None };
    let [pull_x, pull_y] = pull;
    now.pull = pull;
    let mut frame_x = equations.double_speed.fused(y_dot, equations.speed_squared * x);
    let mut frame_y = equations.minus_double_speed.fused(x_dot, equations.speed_squared * y);
    if whole {
        frame_x += equations.runout[0];
        frame_y += equations.runout[1];
    }
    let twice = number(of_next * of_after);
    after.table = [twice * (pull_x + frame_x), twice * (pull_y + frame_y)];
    for i in 0..N {
        let speed = number(of_next) * accelerations[i];
        next.balls[i].speed = speed;
        let [real, imaginary] = by.start.unwrap_or(&lower[0]).balls[i].direction;
        let turning = sums[i].turning;
        after.balls[i].direction = [
            number(-of_after) * speed.fused(imaginary, turning[1]),
            number(of_after) * speed.fused(real, turning[0]),
        ];
    }
    forces
}
