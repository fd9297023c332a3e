//! The conditions of the phases ([`crate::motion::condition`]) as power series over a step.
//!
//! For all lanes it is first shown which conditions obviously hold; the remaining lanes, in one
//! step out of five, are examined one at a time (`first_event`).

use fearless_simd::prelude::*;

use super::equations::Equations;
use super::gap_forces::GapForceEquations;
use super::series::{BalancerSeries, decay};
use crate::motion::Phase;
use crate::motion::condition::Margins;
use crate::motion::lockstep::lane_bounds::LaneBounds;
use crate::motion::lockstep::root_isolation::FOURTH;
use crate::motion::lockstep::vector::{Fused, Vector, vectorized};
use crate::motion::lockstep::{Lanes, ORDER};

/// The coefficients of a ball's conditions.
#[derive(Clone, Copy)]
pub(super) struct ConditionCoefficients<S: Vector> {
    /// The first condition of a ball that does not stick is `sign β̇ + offset`.
    pub(super) sign: Lanes<S>,
    pub(super) offset: Lanes<S>,
    /// 1 if it sticks, else 0.
    pub(super) stuck: Lanes<S>,
    /// Static coefficient of friction.
    pub(super) limit: Lanes<S>,
    /// Slack of the conditions on forces.
    pub(super) slack: Lanes<S>,
}

impl<S: Vector> ConditionCoefficients<S> {
    /// Conditions that cannot fail.
    pub(super) fn nothing(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        ConditionCoefficients {
            sign: zero,
            offset: Lanes::splat(simd, 1.0),
            stuck: zero,
            limit: zero,
            slack: zero,
        }
    }

    /// Sets the conditions of a lane. A condition counts as failed if it is negative by `aim`.
    pub(super) fn set(&mut self, lane: usize, phase: Phase, (margins, aim): (&Margins, f64)) {
        let [sign, offset, stuck] = margins.first_condition(phase, aim);
        self.sign[lane] = sign;
        self.offset[lane] = offset;
        self.stuck[lane] = stuck;
        self.slack[lane] = margins.slack + aim;
    }
}

/// Lanes, as bit masks, that must be examined, with bounds for their conditions.
pub(super) struct LanesToExamine<S: Vector, const N: usize> {
    /// A condition of the ball may fail.
    pub(super) of_balls: [u64; N],
    /// A ball may leave the ring.
    pub(super) loose: u64,
    /// Bounds of the condition that a slipping ball continues to slip.
    pub(super) slips: [LaneBounds<S>; N],
    /// Bounds of the conditions that a sticking ball is held against a forward and against a
    /// backward force.
    pub(super) held: [[LaneBounds<S>; 2]; N],
    /// A closed gap may open.
    pub(super) of_gaps: [u64; N],
    /// Bounds of the normal force on each ball by the forces in gaps, if there are any.
    pushed: [Lanes<S>; N],
}

impl<S: Vector, const N: usize> LanesToExamine<S, N> {
    /// No lanes.
    pub(super) fn none(simd: S) -> Self {
        let blank = LaneBounds::zero(simd);
        LanesToExamine {
            of_balls: [0; N],
            loose: 0,
            slips: [blank; N],
            held: [[blank; 2]; N],
            of_gaps: [0; N],
            pushed: [Lanes::splat(simd, 0.0); N],
        }
    }

    /// Returns the lanes in which any condition may fail.
    pub(super) fn any(&self) -> u64 {
        self.of_balls.iter().chain(&self.of_gaps).fold(self.loose, |any, lanes| any | lanes)
    }

    /// Reports where a condition may fail in a step of this length.
    #[inline(always)]
    pub(super) fn screen_conditions(
        &mut self,
        series: &BalancerSeries<S, N>,
        equations: &Equations<S, N>,
        (watched, gaps): (&[ConditionCoefficients<S>; N], &GapForceEquations<S, N>),
        length: Lanes<S>,
    ) {
        let simd = length.simd;
        let number = |value: f64| Lanes::splat(simd, value);
        let zero = number(0.0);
        let [first, second, ..] = &series.terms;
        let square = length * length;
        self.loose = 0;
        let mut sticks = zero.simd_gt(zero);
        for watched in watched {
            sticks |= watched.stuck.simd_gt(zero);
        }
        let pull = TableAcceleration::over(series, length, sticks.any_true());
        // Bound of the table's pull on a ball.
        let most = |[x, y]: [Lanes<S>; 2]| number(2.0) * (x.abs() + y.abs());
        let of_table = [most(first.pull), most(pull.end)];
        self.of_gaps = [0; N];
        if series.response.active {
            self.screen_gaps(series, gaps, length);
        }
        for i in 0..N {
            let mut pulls = of_table;
            if series.response.active {
                pulls = [pulls[0] + self.pushed[i], pulls[1] + self.pushed[i]];
            }
            let ConditionCoefficients { sign, offset, .. } = watched[i];
            let (mut bound, mut speed, mut slope) = (zero, zero, zero);
            for (k, term) in series.terms[..=ORDER].iter().enumerate().rev() {
                let coefficient = term.balls[i].speed;
                slope = slope.fused(length, speed);
                speed = speed.fused(length, coefficient);
                if k >= 4 {
                    let weight = number(FOURTH[k]);
                    bound = bound.fused(length, weight * coefficient.abs());
                }
            }
            let speeds = [first.balls[i].speed, speed];
            let along = sign * length;
            let curve = LaneBounds {
                values: [sign.fused(speeds[0], offset), sign.fused(speeds[1], offset)],
                changes: [along * second.balls[i].speed, along * slope],
                bound: sign.abs() * bound * (square * square),
            };
            let mut holds = curve.holds();
            self.slips[i] = curve;
            let ball = &equations.balls[i];
            let mut pressed = ball.least_pressed.simd_gt(pulls[0].max(pulls[1]));
            if !pressed.all_true() {
                // The normal force is a parabola in the ball's speed. On one side of its minimum, and
                // not so near that the ball may have passed it, the ends decide.
                let mut plain = length.simd_eq(length);
                let mut steepness = [zero; 2];
                for at in 0..2 {
                    let half = ball.pressed[1] * speeds[at];
                    steepness[at] = half + half + ball.pressed[0];
                    let outward =
                        (half + ball.pressed[0]).fused(speeds[at], equations.speed_squared);
                    plain &= outward.simd_gt(pulls[at]);
                }
                let reach = second.balls[i].speed.abs().max(slope.abs()) * length * ball.pressed[1];
                plain &= (steepness[0] * steepness[1]).simd_gt(zero);
                plain &= steepness[0].abs().min(steepness[1].abs()).simd_gt(reach);
                pressed |= plain;
            }
            self.loose |= !pressed.to_bitmask();
            let stuck = watched[i].stuck.simd_gt(zero);
            if stuck.any_true() {
                let held = held(series, equations, watched, (i, &pull), length);
                holds &= held[0].holds() & held[1].holds() | !stuck;
                self.held[i] = held;
            }
            self.of_balls[i] = !holds.to_bitmask();
        }
    }

    /// Reports where a closed gap may open, and bounds the normal force on each ball by the forces in gaps. Not inlined, like
    /// everything that few steps need: it would take registers from the rest.
    #[inline(never)]
    fn screen_gaps(
        &mut self,
        series: &BalancerSeries<S, N>,
        gaps: &GapForceEquations<S, N>,
        length: Lanes<S>,
    ) {
        vectorized!(length.simd, {
            self.pushed = [Lanes::splat(length.simd, 0.0); N];
            for (g, gap) in gaps.gaps.iter().enumerate() {
                let force = LaneBounds::of_series(
                    length,
                    ORDER - 1,
                    #[inline(always)]
                    |k| series.forces[k][g],
                );
                self.of_gaps[g] = !gap.pressure.over(&force).holds().to_bitmask();
                let [start, end] = force.values;
                let most = Lanes::splat(length.simd, 2.0) * start.abs().max(end.abs());
                for (pushed, outward) in self.pushed.iter_mut().zip(gap.outward) {
                    *pushed += outward.abs() * most;
                }
            }
        });
    }
}

/// The table's acceleration over a step.
struct TableAcceleration<S: Vector> {
    end: [Lanes<S>; 2],
    /// Its change there, with the step's length as the unit of time.
    change: [Lanes<S>; 2],
    /// A bound of its fourth derivative, likewise.
    bound: [Lanes<S>; 2],
}

impl<S: Vector> TableAcceleration<S> {
    /// Evaluates the pull at the end of a step; other than its value only if `whole`.
    #[inline(always)]
    fn over<const N: usize>(series: &BalancerSeries<S, N>, length: Lanes<S>, whole: bool) -> Self {
        let zero = Lanes::splat(length.simd, 0.0);
        let (mut end, mut change, mut bound) = ([zero; 2], [zero; 2], [zero; 2]);
        let terms = &series.terms[..ORDER];
        if !whole {
            for term in terms.iter().rev() {
                for (end, coefficient) in end.iter_mut().zip(term.pull) {
                    *end = end.fused(length, coefficient);
                }
            }
            return TableAcceleration { end, change, bound };
        }
        for axis in 0..2 {
            // Sums of their own: those in the arrays would be stored in each iteration.
            let (mut value, mut slope, mut most) = (zero, zero, zero);
            for (k, term) in terms.iter().enumerate().rev() {
                let coefficient = term.pull[axis];
                slope = slope.fused(length, value);
                value = value.fused(length, coefficient);
                let weight = Lanes::splat(length.simd, FOURTH[k]);
                most = most.fused(length, weight * coefficient.abs());
            }
            (end[axis], change[axis], bound[axis]) = (value, slope * length, most);
        }
        TableAcceleration { end, change, bound }
    }
}

/// Returns the remaining friction of a sticking ball, against a forward and against a backward
/// force: the rotated acceleration of the table.
#[inline(always)]
fn held<S: Vector, const N: usize>(
    series: &BalancerSeries<S, N>,
    equations: &Equations<S, N>,
    watched: &[ConditionCoefficients<S>; N],
    (i, pull): (usize, &TableAcceleration<S>),
    length: Lanes<S>,
) -> [LaneBounds<S>; 2] {
    let number = |value: f64| Lanes::splat(length.simd, value);
    let [first, second, ..] = &series.terms;
    let [c, s] = series.solver.trigonometry[i];
    let ConditionCoefficients { limit, slack, .. } = watched[i];
    // The residual speed also affects the normal force, and decays.
    let left = series.solver.residual[i];
    let mut pressed = [number(0.0); 5];
    if !left.simd_eq(number(0.0)).all_true() {
        let ball = &equations.balls[i];
        let [slower, faster] = [ball.pressed[0] * left, ball.pressed[1] * (left * left)];
        let dying = decay(length);
        let [slow_end, fast_end] = [slower * dying, faster * (dying * dying)];
        let square = length * length;
        pressed = [
            slower + faster,
            slow_end + fast_end,
            -(length * (slower + number(2.0) * faster)),
            -(length * (slow_end + number(2.0) * fast_end)),
            (slower.abs() + number(16.0) * faster.abs()) * (square * square),
        ];
    }
    let along = |[x, y]: [Lanes<S>; 2]| c.fused(x, s * y);
    let across = |[x, y]: [Lanes<S>; 2]| s.fused(x, -(c * y));
    let change = [second.pull[0] * length, second.pull[1] * length];
    let reserves = [
        limit * (equations.speed_squared + pressed[0] - along(first.pull)) + slack,
        limit * (equations.speed_squared + pressed[1] - along(pull.end)) + slack,
        limit * (pressed[2] - along(change)),
        limit * (pressed[3] - along(pull.change)),
    ];
    let forces = [across(first.pull), across(pull.end), across(change), across(pull.change)];
    let (size_c, size_s) = (c.abs(), s.abs());
    let weights = [limit.fused(size_c, size_s), limit.fused(size_s, size_c)];
    let bound = weights[0].fused(pull.bound[0], weights[1] * pull.bound[1]);
    let bound = limit.fused(pressed[4], bound);
    let [a, b, p, q] = reserves;
    let [f, g, u, v] = forces;
    [
        LaneBounds { values: [a - f, b - g], changes: [p - u, q - v], bound },
        LaneBounds { values: [a + f, b + g], changes: [p + u, q + v], bound },
    ]
}
