//! Small perturbations from the motions in lockstep: propagated by the linearised flow in vectors, with powers of time above
//! those of their series at negligible cost.
//!
//! The highest frequency in a perturbation is that of the table in the turning frame, `1 + |ω|`. In
//! the motion itself it has decayed, and steps are as long as the slower motion allows; but every
//! switch excites it anew in a perturbation, and truncated at the power 14 it would grow from step
//! to step. Its contribution is therefore continued to higher powers: the table's own equations,
//! linear with constant coefficients, and the table's effect on the balls at their angles at the
//! start of the step, with their drag. Neglected are the reaction on the table of balls with about
//! a ten-thousandth of its mass, and the motion of the balls within the step.

use fearless_simd::prelude::*;

use super::equations::Equations;
use super::recurrence::{Solving, products, solve};
use super::series::{BalancerSeries, HigherPowers};
use super::terms::BalancerLaneStates;
use crate::motion::lockstep::Lanes;
use crate::motion::lockstep::vector::{Fused, Vector, vectorized};

/// The highest power of time in the series of a perturbation's speeds.
const LINEAR: usize = 14;

/// Number of additional powers: the last one is `5^25 / 25!`, 2e-8, in the longest step.
const BEYOND: usize = 10;

/// k!
const FACTORIALS: [f64; LINEAR + BEYOND + 2] = {
    let mut all = [1.0; LINEAR + BEYOND + 2];
    let mut k = 1;
    while k < all.len() {
        all[k] = all[k - 1] * k as f64;
        k += 1;
    }
    all
};

impl<S: Vector, const N: usize> BalancerSeries<S, N> {
    /// Expands a perturbation from the expanded motion: the same equations to first order.
    #[inline(always)]
    fn expand_perturbation(
        &self,
        equations: &Equations<S, N>,
        start: &BalancerLaneStates<S, N>,
        perturbed: &mut Self,
    ) {
        let [x, y, x_dot, y_dot] = start.table;
        let [first, second, ..] = &mut perturbed.terms;
        first.table = [x, y];
        second.table = [x_dot, y_dot];
        let zero = Lanes::splat(x.simd, 0.0);
        let two = Lanes::splat(x.simd, 2.0);
        let double_speed = equations.double_speed;
        let mut residual = [[zero; 2]; 2];
        let mut left_over = zero;
        for i in 0..N {
            let ball = &equations.balls[i];
            let [real, imaginary] = self.terms[0].balls[i].direction;
            let base = self.terms[0].balls[i].speed;
            let angle = start.angle[i];
            let speed = ball.free * start.speed[i];
            let turned = [-(imaginary * angle), real * angle];
            first.balls[i].speed = speed;
            first.balls[i].direction = turned;
            second.balls[i].direction =
                [-base.fused(turned[1], speed * imaginary), base.fused(turned[0], speed * real)];
            // The residual speed of a sticking ball: (2ω r + r²) e, to first order.
            let [c, s] = self.solver.trigonometry[i];
            let left = self.solver.residual[i];
            let perturbed_left = start.speed[i] - speed;
            left_over = left_over.max(left.abs()).max(perturbed_left.abs());
            let forces = [
                [double_speed * perturbed_left, double_speed * left],
                [two * left * perturbed_left, left * left],
            ];
            for ([speed, turned], residual) in forces.into_iter().zip(&mut residual) {
                let turned = turned * angle;
                residual[0] += ball.mass * (speed * c - turned * s);
                residual[1] += ball.mass * (speed * s + turned * c);
            }
        }
        perturbed.residual = (!left_over.simd_eq(zero).all_true()).then_some(residual);
        if self.response.active {
            for k in 0..LINEAR {
                self.order_of_perturbation::<true>(equations, perturbed, k);
            }
        } else {
            for k in 0..LINEAR {
                self.order_of_perturbation::<false>(equations, perturbed, k);
            }
        }
    }

    #[inline(never)]
    fn order_of_perturbation<const TOUCHING: bool>(
        &self,
        equations: &Equations<S, N>,
        perturbed: &mut Self,
        k: usize,
    ) {
        vectorized!(equations.speed.simd, {
            let BalancerSeries { terms, residual, sums, .. } = perturbed;
            let [all, others] = sums;
            products(&self.terms, terms, k, all);
            products(terms, &self.terms, k, others);
            let [pull_x, pull_y] = self.terms[k].pull;
            for i in 0..N {
                let [real, imaginary] = terms[0].balls[i].direction;
                let next = self.terms[k + 1].balls[i].speed;
                let sums = &mut all[i];
                sums.turning[0] += next.fused(real, others[i].turning[0]);
                sums.turning[1] += next.fused(imaginary, others[i].turning[1]);
                sums.drawn += others[i].drawn + (imaginary * pull_x - real * pull_y);
                let mut squared = Lanes::splat(pull_x.simd, 0.0);
                let along = terms[..=k].iter().rev();
                for (term, along) in self.terms[..=k].iter().zip(along) {
                    squared = term.balls[i].speed.fused(along.balls[i].speed, squared);
                }
                sums.squared = squared + squared;
            }
            let start = Some(&self.terms[0]);
            let residual = residual.as_ref();
            let by = Solving { solver: &self.solver, start, residual, gaps: &self.response };
            solve::<S, N, TOUCHING>(terms, equations, &by, k, all);
        });
    }

    /// Returns the powers of a perturbation above those of its series, for steps of this length.
    #[inline(always)]
    fn beyond(
        &self,
        equations: &Equations<S, N>,
        perturbed: &Self,
        length: Lanes<S>,
    ) -> HigherPowers<S, N> {
        let number = |value: f64| Lanes::splat(length.simd, value);
        let [a, b, c, d] = self.solver.inverse;
        // z̈ from position, velocity and the turning frame.
        let Equations { minus_drag, drag_speed, minus_drag_speed, .. } = *equations;
        let by_place = [
            b.fused(minus_drag_speed, -a),
            a.fused(drag_speed, -b),
            d.fused(minus_drag_speed, -c),
            c.fused(drag_speed, -d),
        ];
        let by_speed = [a * minus_drag, b * minus_drag, c * minus_drag, d * minus_drag];
        let frame = [equations.double_speed, equations.minus_double_speed];
        let [whole_b, whole_c] = [by_speed[1] + frame[0], by_speed[2] + frame[1]];
        let of = |matrix: [Lanes<S>; 4], [x, y]: [Lanes<S>; 2]| {
            [matrix[0].fused(x, matrix[1] * y), matrix[2].fused(x, matrix[3] * y)]
        };
        // Derivatives, not coefficients: their recurrence has no factors.
        let factorial = number(FACTORIALS[LINEAR]);
        let next_factorial = number(FACTORIALS[LINEAR + 1]);
        let [x, y] = perturbed.terms[LINEAR].table;
        let [x_dot, y_dot] = perturbed.terms[LINEAR + 1].table;
        let mut place = [x * factorial, y * factorial];
        let mut speed = [x_dot * next_factorial, y_dot * next_factorial];
        let mut turning = [number(0.0); N];
        for (turning, ball) in turning.iter_mut().zip(&perturbed.terms[LINEAR].balls) {
            *turning = ball.speed * factorial;
        }
        let mut table = [[number(0.0); 2]; BEYOND];
        let mut speeds = [[number(0.0); N]; BEYOND];
        for at in 0..BEYOND {
            let drawn_by_place = of(by_place, place);
            let rest = [
                equations.speed_squared.fused(place[0], drawn_by_place[0]),
                equations.speed_squared.fused(place[1], drawn_by_place[1]),
            ];
            let pull = [
                by_speed[0].fused(speed[0], by_speed[1].fused(speed[1], drawn_by_place[0])),
                by_speed[2].fused(speed[0], by_speed[3].fused(speed[1], drawn_by_place[1])),
            ];
            let acceleration = [
                by_speed[0].fused(speed[0], whole_b.fused(speed[1], rest[0])),
                by_speed[3].fused(speed[1], whole_c.fused(speed[0], rest[1])),
            ];
            let balls = equations.balls.iter().zip(self.solver.drawn);
            for (turning, (ball, [along, across])) in turning.iter_mut().zip(balls) {
                let drawn = along.fused(pull[0], across * pull[1]);
                *turning = (-ball.held[1]).fused(*turning, drawn);
            }
            if self.response.active {
                // Balls that touch turn together; their reaction on the table is neglected.
                self.response.join(&mut turning, &mut [number(0.0); 2]);
            }
            speeds[at] = turning;
            (place, speed) = (speed, acceleration);
            table[at] = acceleration;
        }
        let mut higher = HigherPowers::none(length.simd);
        for (at, (table, speeds)) in table.iter().zip(&speeds).enumerate().rev() {
            let part = number(1.0 / FACTORIALS[LINEAR + at + 2]);
            for (axis, derivative) in table.iter().enumerate() {
                let position = higher.position[axis];
                higher.slope[axis] = higher.slope[axis].fused(length, position);
                higher.position[axis] = position.fused(length, part * *derivative);
            }
            let of_speed = number(1.0 / FACTORIALS[LINEAR + at + 1]);
            for (i, derivative) in speeds.iter().enumerate() {
                let [speed, angle] = [of_speed * *derivative, part * *derivative];
                higher.speed[i] = higher.speed[i].fused(length, speed);
                higher.angle[i] = higher.angle[i].fused(length, angle);
            }
        }
        higher
    }
}

/// Propagates perturbations over a step of this length, in all lanes; `perturbed` is work space.
#[inline(always)]
pub(super) fn propagate<S: Vector, const N: usize>(
    series: &BalancerSeries<S, N>,
    equations: &Equations<S, N>,
    perturbation: &BalancerLaneStates<S, N>,
    length: Lanes<S>,
    perturbed: &mut BalancerSeries<S, N>,
) -> BalancerLaneStates<S, N> {
    series.expand_perturbation(equations, perturbation, perturbed);
    let higher = series.beyond(equations, perturbed, length);
    perturbed.at(equations, perturbation, length, LINEAR, higher)
}
