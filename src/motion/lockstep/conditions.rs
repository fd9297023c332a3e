//! The conditions that hold while a phase lasts, in all lanes: three of each ball, with their slopes in
//! time. The same as in `motion::guard`:
//!
//! | | first | second | third |
//! |---|---|---|---|
//! | slip | out of the band | | pressed to the ring |
//! | stick | held against a forward force | held against a backward force | pressed |
//! | transition | in the band | accelerating in its direction | pressed |
//! | free | | | pressed |

use fearless_simd::{Simd, mask64x8, prelude::*};

use super::equations::{Equations, Force};
use super::locate::Conditions;
use super::{Flow, Lanes};
use crate::model::{Balancer, Forces, State};
use crate::motion::Phase;

/// What the conditions of a ball depend on.
#[derive(Clone, Copy)]
pub(super) struct Watched<S: Simd> {
    /// The first condition of a ball that does not stick is `sign β̇ + offset`.
    pub(super) sign: Lanes<S>,
    pub(super) offset: Lanes<S>,
    /// Direction of a transition; 0 in any other phase.
    pub(super) transition: Lanes<S>,
    /// 1 where it sticks, else 0.
    pub(super) stuck: Lanes<S>,
    /// Static coefficient of friction.
    pub(super) limit: Lanes<S>,
    /// Slack of the conditions on forces.
    pub(super) slack: Lanes<S>,
}

/// How a phase is watched: sign, offset, transition and stuck of [`Watched`].
pub(super) fn watched(phase: Phase, band: f64) -> [f64; 4] {
    match phase {
        Phase::Slip(direction) => [direction, -band, 0.0, 0.0],
        Phase::Transition(direction) => [-direction, band, direction, 0.0],
        Phase::Stick => [0.0, 1.0, 0.0, 1.0],
        Phase::Free => [0.0, 1.0, 0.0, 0.0],
    }
}

/// Values and slopes: of each ball, of each condition.
#[derive(Clone, Copy)]
pub(super) struct InLanes<S: Simd, const N: usize> {
    pub(super) values: [[Lanes<S>; 3]; N],
    pub(super) slopes: [[Lanes<S>; 3]; N],
}

impl<S: Simd, const N: usize> InLanes<S, N> {
    /// Met for ever in all lanes.
    #[inline(always)]
    pub(super) fn met(simd: S) -> Self {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        InLanes { values: [[one; 3]; N], slopes: [[zero; 3]; N] }
    }

    /// One run's.
    pub(super) fn lane(&self, lane: usize) -> Conditions<N> {
        let of = |all: &[[Lanes<S>; 3]; N]| -> [[f64; 3]; N] {
            std::array::from_fn(|ball| std::array::from_fn(|which| all[ball][which][lane]))
        };
        Conditions { values: of(&self.values), slopes: of(&self.slopes) }
    }

    /// Sets one run's.
    pub(super) fn set_lane(&mut self, lane: usize, conditions: &Conditions<N>) {
        for ball in 0..N {
            for which in 0..3 {
                self.values[ball][which][lane] = conditions.values[ball][which];
                self.slopes[ball][which][lane] = conditions.slopes[ball][which];
            }
        }
    }
}

/// Values and slopes in a state, from the rate of change and the forces there.
#[inline(always)]
pub(super) fn conditions<S: Simd, const N: usize>(
    equations: &Equations<S, N>,
    watched: &[Watched<S>; N],
    (state, rate, forces): (&Flow<S, N>, &Flow<S, N>, &[Force<S>; N]),
) -> InLanes<S, N> {
    let simd = state.table[0].simd;
    let zero = Lanes::splat(simd, 0.0);
    let one = Lanes::splat(simd, 1.0);
    let two = Lanes::splat(simd, 2.0);
    let [_, _, x_dot, y_dot] = state.table;
    let [_, _, x_ddot, y_ddot] = rate.table;
    // The rate of change of the table's absolute acceleration, but for what the rates of change of the
    // balls' accelerations add: their share is small, and slopes only lead to where to look.
    // The balls' shares are summed apart, so that two balls exchanged give the same to the last bit.
    let (mut balls_x, mut balls_y) = (zero, zero);
    for (i, ball) in equations.balls.iter().enumerate() {
        let Force { sine, cosine, .. } = forces[i];
        let (speed, acceleration) = (state.speed[i], rate.speed[i]);
        let w = equations.speed + speed;
        let along = ball.mass * (acceleration * w.mul_add_precise(two, speed));
        let across = ball.mass * (speed * (w * w));
        balls_x += cosine * along - sine * across;
        balls_y += sine * along + cosine * across;
    }
    let jerk_x = balls_x - x_dot - (equations.drag * x_ddot - equations.drag_speed * y_dot);
    let jerk_y = balls_y - y_dot - (equations.drag * y_ddot + equations.drag_speed * x_dot);
    let mut found = InLanes::met(simd);
    for i in 0..N {
        let Force { sine, cosine, normal, tangential } = forces[i];
        let (speed, acceleration) = (state.speed[i], rate.speed[i]);
        let ball = &equations.balls[i];
        let watched = &watched[i];
        let stuck = watched.stuck.simd_gt(zero);
        let w = equations.speed + speed;
        let rolling = (ball.rolling_quadratic * two).mul_add_precise(speed, ball.rolling_linear);
        let pressed_rate = two.mul_add_precise(w, rolling) * acceleration;
        // A ball that moves along the ring turns the directions that forces on it are resolved in; where
        // the tangential force matters, in stick and transition, it does not move.
        let normal_rate = pressed_rate + speed * tangential - (cosine * jerk_x + sine * jerk_y);
        let tangential_rate = sine * jerk_x - cosine * jerk_y;
        let reserve = watched.limit * normal + watched.slack;
        let reserve_rate = watched.limit * normal_rate;
        let friction_rate = ball.friction.mul_add_precise(normal_rate, ball.drag * acceleration);
        let changing = ball.mobility * (tangential_rate - friction_rate);
        let transition = watched.transition;
        let in_transition = transition.abs().simd_gt(zero);
        let speeds = watched.sign.mul_add_precise(speed, watched.offset);
        let accelerates = transition.mul_add_precise(acceleration, watched.slack);
        found.values[i] = [
            stuck.select(reserve - tangential, speeds),
            stuck.select(reserve + tangential, in_transition.select(accelerates, one)),
            normal,
        ];
        found.slopes[i] = [
            stuck.select(reserve_rate - tangential_rate, watched.sign * acceleration),
            stuck.select(reserve_rate + tangential_rate, transition * changing),
            normal_rate,
        ];
    }
    found
}

/// In which lanes a condition has failed at the end of a step, or seems to have dipped below zero in it.
#[inline(always)]
pub(super) fn suspicious<S: Simd, const N: usize>(
    length: Lanes<S>,
    start: &InLanes<S, N>,
    end: &InLanes<S, N>,
) -> mask64x8<S> {
    let zero = Lanes::splat(length.simd, 0.0);
    let half = Lanes::splat(length.simd, 0.5);
    let three = Lanes::splat(length.simd, 3.0);
    let mut suspects = length.simd_lt(zero);
    for ball in 0..N {
        for which in 0..3 {
            let values = [start.values[ball][which], end.values[ball][which]];
            let least = values[0].min(values[1]);
            let changes =
                [start.slopes[ball][which], end.slopes[ball][which]].map(|slope| slope * length);
            let risen = (values[1] - values[0]) * three;
            let up = changes[0].simd_ge(zero);
            let (up_end, down_end) = (changes[1].simd_ge(zero), changes[1].simd_le(zero));
            // A plain hump, or a cubic that only rises (F. N. Fritsch, R. E. Carlson, SIAM J. Numer.
            // Anal. 17 (1980) 238, doi:10.1137/0717021), or only falls.
            let hump = up & down_end;
            let rises = up & up_end & changes[0].simd_le(risen) & changes[1].simd_le(risen);
            let falls = changes[0].simd_le(zero)
                & down_end
                & changes[0].simd_ge(risen)
                & changes[1].simd_ge(risen);
            let most = changes[0].abs().max(changes[1].abs());
            let near = least.simd_lt(half * most) & !(hump | rises | falls);
            if near.any_true() {
                suspects |= near & dips(values, changes);
            }
            suspects |= values[1].simd_lt(zero);
        }
    }
    suspects
}

/// In which lanes the cubic with these values and changes (slopes times length) at a step's ends goes
/// below zero inside. The same test, in the same order, as that of one run (`locate`).
#[inline(always)]
fn dips<S: Simd>(values: [Lanes<S>; 2], changes: [Lanes<S>; 2]) -> mask64x8<S> {
    let simd = values[0].simd;
    macro_rules! c {
        ($value:expr) => {
            Lanes::splat(simd, $value)
        };
    }
    let ([a, b], [p, q]) = (values, changes);
    let c = c!(3.0) * (b - a) - c!(2.0) * p - q;
    let d = c!(2.0) * (a - b) + p + q;
    let discriminant = c * c - c!(3.0) * p * d;
    let root = discriminant.max(c!(0.0)).sqrt();
    let upwards = c.simd_gt(c!(0.0));
    let t = upwards.select(-p, root - c) / upwards.select(c + root, c!(3.0) * d);
    let least = ((d * t + c) * t + p) * t + a;
    discriminant.simd_gt(c!(0.0))
        & t.simd_gt(c!(1e-6))
        & t.simd_lt(c!(1.0 - 1e-6))
        & least.simd_lt(c!(0.0))
}

/// The same conditions of one run.
pub(super) fn of_one<const N: usize>(
    balancer: &Balancer<N>,
    phases: &[Phase; N],
    [band, slack]: [f64; 2],
    (state, rate, forces): (&State<N>, &State<N>, &Forces<N>),
) -> Conditions<N> {
    let drag = 2.0 * balancer.damping_ratio;
    let [x_dot, y_dot] = state.velocity;
    let [x_ddot, y_ddot] = rate.velocity;
    let trigonometry = state.beta.map(libm::sincos);
    let (mut balls_x, mut balls_y) = (0.0, 0.0);
    for (i, &(sine, cosine)) in trigonometry.iter().enumerate() {
        let (speed, acceleration) = (state.beta_dot[i], rate.beta_dot[i]);
        let mass = balancer.balls[i].mass;
        let w = balancer.speed + speed;
        let along = mass * (acceleration * (2.0 * w + speed));
        let across = mass * (speed * (w * w));
        balls_x += cosine * along - sine * across;
        balls_y += sine * along + cosine * across;
    }
    let jerk_x = balls_x - x_dot - drag * (x_ddot - balancer.speed * y_dot);
    let jerk_y = balls_y - y_dot - drag * (y_ddot + balancer.speed * x_dot);
    let mut found = Conditions { values: [[1.0; 3]; N], slopes: [[0.0; 3]; N] };
    for i in 0..N {
        let ball = &balancer.balls[i];
        let (sine, cosine) = trigonometry[i];
        let (speed, acceleration) = (state.beta_dot[i], rate.beta_dot[i]);
        let normal = forces.normal[i];
        let [a_x, a_y] = forces.table_acceleration;
        let tangential = sine * a_x - cosine * a_y;
        let w = balancer.speed + speed;
        let pressed = 2.0 * w - ball.rolling_linear - 2.0 * ball.rolling_quadratic * speed;
        let normal_rate =
            pressed * acceleration + speed * tangential - (cosine * jerk_x + sine * jerk_y);
        let tangential_rate = sine * jerk_x - cosine * jerk_y;
        let limit = ball.friction.limit;
        let [sign, offset, transition, _] = watched(phases[i], band);
        (found.values[i], found.slopes[i]) = match phases[i] {
            Phase::Stick => {
                let reserve = limit * normal + slack;
                (
                    [reserve - tangential, reserve + tangential, normal],
                    [
                        limit * normal_rate - tangential_rate,
                        limit * normal_rate + tangential_rate,
                        normal_rate,
                    ],
                )
            }
            Phase::Transition(direction) => {
                let friction = ball.friction.slip(direction, speed);
                let changing =
                    ball.mobility * (tangential_rate - friction.signed_friction * normal_rate);
                (
                    [sign * speed + offset, transition * acceleration + slack, normal],
                    [sign * acceleration, transition * changing, normal_rate],
                )
            }
            Phase::Slip(_) | Phase::Free => {
                ([sign * speed + offset, 1.0, normal], [sign * acceleration, 0.0, normal_rate])
            }
        };
    }
    found
}
