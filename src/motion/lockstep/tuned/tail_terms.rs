//! Powers of a perturbation above those of its series (`tangent`), at negligible cost.
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
use super::series::{BalancerSeries, HigherPowers};
use super::tangent::LINEAR;
use crate::motion::lockstep::Lanes;
use crate::motion::lockstep::vector::{Fused, Vector};

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
    /// Returns the powers of a perturbation above those of its series, for steps of this length.
    #[inline(always)]
    pub(super) fn beyond(
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
