//! The conditions that hold while a phase lasts, as power series over a step. The same as in
//! `motion::guard`:
//!
//! | | first | second | third |
//! |---|---|---|---|
//! | slip | out of the band | | pressed to the ring |
//! | stick | held against a forward force | held against a backward force | pressed |
//! | transition | in the band | accelerating in its direction | pressed |
//! | free | | | pressed |
//!
//! In all lanes at once it is shown that none fails, where that is plain; the other lanes, one step in five,
//! are looked at one by one (`first_failure`).

use fearless_simd::{Simd, prelude::*};

use super::Lanes;
use super::equations::Equations;
use super::locate::FOURTH;
use super::recurrence::DYING;
use super::series::{ORDER, Series};
use crate::motion::Phase;

/// What the conditions of a ball depend on.
#[derive(Clone, Copy)]
pub(super) struct Watched<S: Simd> {
    /// The first condition of a ball that does not stick is `sign β̇ + offset`.
    pub(super) sign: Lanes<S>,
    pub(super) offset: Lanes<S>,
    /// 1 where it sticks, else 0.
    pub(super) stuck: Lanes<S>,
    /// Static coefficient of friction.
    pub(super) limit: Lanes<S>,
    /// Slack of the conditions on forces.
    pub(super) slack: Lanes<S>,
}

impl<S: Simd> Watched<S> {
    /// Nothing can fail.
    pub(super) fn nothing(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        Watched {
            sign: zero,
            offset: Lanes::splat(simd, 1.0),
            stuck: zero,
            limit: zero,
            slack: zero,
        }
    }

    /// Sets what is watched in a lane. All conditions count as failed where they are below zero by `aim`.
    pub(super) fn set(&mut self, lane: usize, phase: Phase, [band, slack, aim]: [f64; 3]) {
        let (sign, offset, stuck) = match phase {
            Phase::Slip(direction) => (direction, aim - band, 0.0),
            // In the band for moments only: always looked at.
            Phase::Transition(direction) => (-direction, -1.0, 0.0),
            Phase::Stick => (0.0, 1.0, 1.0),
            Phase::Free => (0.0, 1.0, 0.0),
        };
        self.sign[lane] = sign;
        self.offset[lane] = offset;
        self.stuck[lane] = stuck;
        self.slack[lane] = slack + aim;
    }
}

/// Lanes, as bit masks, that have to be looked at.
pub(super) struct Doubts<const N: usize> {
    /// A condition of the ball may fail.
    pub(super) of_balls: [u64; N],
    /// A ball may leave the ring.
    pub(super) loose: u64,
}

impl<const N: usize> Doubts<N> {
    /// Lanes in which anything may happen.
    pub(super) fn any(&self) -> u64 {
        self.of_balls.iter().fold(self.loose, |any, of_ball| any | of_ball)
    }
}

/// Values and slopes of a polynomial at both ends of a step, times its length, and a bound of its fourth
/// derivative times the fourth power of that.
struct Curve<S: Simd> {
    values: [Lanes<S>; 2],
    changes: [Lanes<S>; 2],
    bound: Lanes<S>,
}

impl<S: Simd> Curve<S> {
    /// Where it plainly stays above zero: no coefficient of its Bernstein form of degree four is negative
    /// (`locate`).
    #[inline(always)]
    fn holds(&self) -> fearless_simd::mask64x8<S> {
        let simd = self.bound.simd;
        let number = |value: f64| Lanes::splat(simd, value);
        let ([a, b], [p, q]) = (self.values, self.changes);
        let fourth = number(0.25);
        let early = p.mul_add_precise(fourth, a);
        let late = q.mul_add_precise(-fourth, b);
        let middle = (p - q).mul_add_precise(number(1.0 / 3.0), a + b) * number(0.5);
        let middle = self.bound.mul_add_precise(number(-1.0 / 144.0), middle);
        a.min(b).min(early.min(late)).min(middle).simd_ge(number(0.0))
    }
}

/// Where a condition may fail in a step of this length.
#[inline(always)]
pub(super) fn doubtful<S: Simd, const N: usize>(
    series: &Series<S, N>,
    equations: &Equations<S, N>,
    watched: &[Watched<S>; N],
    length: Lanes<S>,
) -> Doubts<N> {
    let simd = length.simd;
    let number = |value: f64| Lanes::splat(simd, value);
    let zero = number(0.0);
    let [first, second, ..] = &series.terms;
    let square = length * length;
    let mut doubts = Doubts { of_balls: [0; N], loose: 0 };
    let mut pull = [zero; 2];
    for term in series.terms[..ORDER].iter().rev() {
        for (pull, coefficient) in pull.iter_mut().zip(term.pull) {
            *pull = pull.mul_add_precise(length, coefficient);
        }
    }
    // The table pulls a ball off with no more than this.
    let most = |[x, y]: [Lanes<S>; 2]| number(2.0) * (x.abs() + y.abs());
    let pulls = [most(first.pull), most(pull)];
    for i in 0..N {
        let Watched { sign, offset, .. } = watched[i];
        let (mut bound, mut speed, mut slope) = (zero, zero, zero);
        for (k, term) in series.terms[..=ORDER].iter().enumerate().rev() {
            let coefficient = term.balls[i].speed;
            slope = slope.mul_add_precise(length, speed);
            speed = speed.mul_add_precise(length, coefficient);
            if k >= 4 {
                let weight = number(FOURTH[k]);
                bound = bound.mul_add_precise(length, weight * coefficient.abs());
            }
        }
        let speeds = [first.balls[i].speed, speed];
        let along = sign * length;
        let curve = Curve {
            values: [
                sign.mul_add_precise(speeds[0], offset),
                sign.mul_add_precise(speeds[1], offset),
            ],
            changes: [along * second.balls[i].speed, along * slope],
            bound: sign.abs() * bound * (square * square),
        };
        let mut holds = curve.holds();
        let ball = &equations.balls[i];
        let mut pressed = ball.least_pressed.simd_gt(pulls[0].max(pulls[1]));
        if !pressed.all_true() {
            // How it is pressed is a parabola in its speed. On one side of the bottom, and not so near that
            // it may have been there on the way, the ends tell.
            let mut plain = length.simd_eq(length);
            let mut steepness = [zero; 2];
            for at in 0..2 {
                let half = ball.pressed[1] * speeds[at];
                steepness[at] = half + half + ball.pressed[0];
                let own =
                    (half + ball.pressed[0]).mul_add_precise(speeds[at], equations.speed_squared);
                plain &= own.simd_gt(pulls[at]);
            }
            let reach = second.balls[i].speed.abs().max(slope.abs()) * length * ball.pressed[1];
            plain &= (steepness[0] * steepness[1]).simd_gt(zero);
            plain &= steepness[0].abs().min(steepness[1].abs()).simd_gt(reach);
            pressed |= plain;
        }
        doubts.loose |= !pressed.to_bitmask();
        let stuck = watched[i].stuck.simd_gt(zero);
        if stuck.any_true() {
            let held = held(series, equations, watched, i, length);
            holds &= held[0].holds() & held[1].holds() | !stuck;
        }
        doubts.of_balls[i] = !holds.to_bitmask();
    }
    doubts
}

/// What is left of friction for a ball that sticks, against a forward and against a backward force.
#[inline(always)]
fn held<S: Simd, const N: usize>(
    series: &Series<S, N>,
    equations: &Equations<S, N>,
    watched: &[Watched<S>; N],
    i: usize,
    length: Lanes<S>,
) -> [Curve<S>; 2] {
    let simd = length.simd;
    let number = |value: f64| Lanes::splat(simd, value);
    let [c, s] = series.solver.trigonometry[i];
    let Watched { limit, slack, .. } = watched[i];
    let left = series.solver.residual[i];
    let ball = &equations.balls[i];
    let pressed = [ball.pressed[0] * left, ball.pressed[1] * (left * left)];
    // Reserve μ N and tangential force: value and slope at the end, at the start, and the bound.
    let mut all = [[number(0.0); 5]; 2];
    for (k, term) in series.terms[..ORDER].iter().enumerate().rev() {
        let [x, y] = term.pull;
        let [slower, faster] = DYING[k];
        let left = pressed[0].mul_add_precise(number(slower), pressed[1] * number(faster));
        let mut normal = left - c.mul_add_precise(x, s * y);
        if k == 0 {
            normal += equations.speed_squared;
        }
        let coefficients = [limit * normal, s.mul_add_precise(x, -(c * y))];
        for which in 0..2 {
            let coefficient = coefficients[which];
            let [value, slope, at_start, slope_at_start, bound] = &mut all[which];
            *slope = slope.mul_add_precise(length, *value);
            *value = value.mul_add_precise(length, coefficient);
            (*slope_at_start, *at_start) = (*at_start, coefficient);
            if k >= 4 {
                let weight = number(FOURTH[k]);
                *bound = bound.mul_add_precise(length, weight * coefficient.abs());
            }
        }
    }
    let square = length * length;
    let [reserve, tangential] = all;
    let bound = (reserve[4] + tangential[4]) * (square * square);
    [
        Curve {
            values: [reserve[2] - tangential[2] + slack, reserve[0] - tangential[0] + slack],
            changes: [(reserve[3] - tangential[3]) * length, (reserve[1] - tangential[1]) * length],
            bound,
        },
        Curve {
            values: [reserve[2] + tangential[2] + slack, reserve[0] + tangential[0] + slack],
            changes: [(reserve[3] + tangential[3]) * length, (reserve[1] + tangential[1]) * length],
            bound,
        },
    ]
}
