//! A disc whose speed is a polynomial of time.
//!
//! The speed has few coefficients, so that products with it are short sums. With the acceleration `α` of the disc, the Euler
//! forces of `model::equations` add `iα e` to the acceleration of a ball, `-iα z` to that of the table, and a force that draws
//! the balls against the turning ring.

use fearless_simd::prelude::*;

use super::terms::{DYING, PowerCoefficients};
use crate::model::{Balancer, BalancerBall, SPEED_TERMS};
use crate::motion::lockstep::vector::{Fused, Vector, vectorized};
use crate::motion::lockstep::{Lanes, TERMS};

/// The number of coefficients of the square of the speed.
pub(super) const SQUARED_TERMS: usize = 2 * SPEED_TERMS - 1;

/// The parameters of the disc and of balls on a disc whose speed changes, in all lanes.
pub(super) struct Drive<S: Vector, const N: usize> {
    /// The coefficients of the speed as a polynomial of the time in its segment.
    terms: [Lanes<S>; SPEED_TERMS],
    /// m_I e
    unbalance: Lanes<S>,
    /// ε, and the mass of the table without balls.
    runout: [Lanes<S>; 2],
    table: Lanes<S>,
    /// 2ζ
    drag: Lanes<S>,
    balls: [DrivenBall<S>; N],
}

/// The coefficients of a ball's equation; those of forces along the ring times the mobility.
#[derive(Clone, Copy)]
struct DrivenBall<S: Vector> {
    on_disc: BallOnDisc<S>,
    /// The friction by `ω²` and by `ω β̇`, and the force by the acceleration of the disc.
    by_square: Lanes<S>,
    by_product: Lanes<S>,
    by_acceleration: Lanes<S>,
}

impl<S: Vector, const N: usize> Drive<S, N> {
    pub(super) fn blank(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let on_disc = BallOnDisc { pressed: zero, least: zero, euler: zero };
        let ball = DrivenBall { on_disc, by_square: zero, by_product: zero, by_acceleration: zero };
        Drive {
            terms: [zero; SPEED_TERMS],
            unbalance: zero,
            runout: [zero; 2],
            table: zero,
            drag: zero,
            balls: [ball; N],
        }
    }

    /// Sets the machine of a lane and the speed of its disc.
    pub(super) fn set_machine(
        &mut self,
        lane: usize,
        balancer: &Balancer<N>,
        speed: &[f64; SPEED_TERMS],
    ) {
        for (of_all, term) in self.terms.iter_mut().zip(speed) {
            of_all[lane] = *term;
        }
        self.unbalance[lane] = balancer.imbalance;
        let [along, across] = balancer.runout.unwrap_or_default();
        self.runout[0][lane] = along;
        self.runout[1][lane] = across;
        self.table[lane] = 1.0 - balancer.balls.iter().fold(0.0, |sum, ball| sum + ball.mass);
        self.drag[lane] = 2.0 * balancer.damping_ratio;
        for (of_ball, ball) in self.balls.iter_mut().zip(&balancer.balls) {
            let pressed = 2.0 - ball.rolling_by_speed();
            let on_disc = &mut of_ball.on_disc;
            on_disc.pressed[lane] = pressed;
            on_disc.least[lane] = 1.0 - pressed * pressed / (4.0 * (1.0 - ball.rolling_quadratic));
            on_disc.euler[lane] = 1.0 - 2.0 * ball.inertia * ball.diameter;
        }
    }

    /// Sets the coefficients that depend on whether a ball sticks and on its friction.
    pub(super) fn set_ball(&mut self, lane: usize, ball: usize, [mobility, friction]: [f64; 2]) {
        let of_ball = &mut self.balls[ball];
        of_ball.by_square[lane] = mobility * friction;
        of_ball.by_product[lane] = mobility * (friction * of_ball.on_disc.pressed[lane]);
        of_ball.by_acceleration[lane] = mobility * of_ball.on_disc.euler[lane];
    }

    /// Returns the speed of the disc from a time in its segment on.
    #[inline(never)]
    pub(super) fn turning(&self, elapsed: Lanes<S>) -> DiscSpeedSeries<S, N> {
        vectorized!(elapsed.simd, self.turning_in_vectors(elapsed))
    }

    #[inline(always)]
    fn turning_in_vectors(&self, elapsed: Lanes<S>) -> DiscSpeedSeries<S, N> {
        let zero = Lanes::splat(elapsed.simd, 0.0);
        // Taylor's shift, by Horner's scheme.
        let mut speed = self.terms;
        for first in 0..SPEED_TERMS {
            for k in (first..SPEED_TERMS - 1).rev() {
                speed[k] = speed[k + 1].fused(elapsed, speed[k]);
            }
        }
        let mut acceleration = [zero; SPEED_TERMS - 1];
        for (k, acceleration) in acceleration.iter_mut().enumerate() {
            *acceleration = Lanes::splat(elapsed.simd, (k + 1) as f64) * speed[k + 1];
        }
        let mut squared = [zero; SQUARED_TERMS];
        for (one, first) in speed.into_iter().enumerate() {
            for (other, second) in speed.into_iter().enumerate() {
                squared[one + other] = first.fused(second, squared[one + other]);
            }
        }
        let mut curved = zero;
        for term in &speed[2..] {
            curved = curved.max(term.abs());
        }
        let number = if curved.simd_gt(zero).any_true() { SPEED_TERMS } else { 2 };
        let mut of_balls = [self.balls[0].on_disc; N];
        for (of_all, ball) in of_balls.iter_mut().zip(&self.balls) {
            *of_all = ball.on_disc;
        }
        DiscSpeedSeries { speed, squared, acceleration, number, balls: of_balls }
    }

    /// Returns the forces of a power of time by the speed and the acceleration of the disc alone.
    #[inline(always)]
    pub(super) fn own_forces(&self, turning: &DiscSpeedSeries<S, N>, k: usize) -> DiscForces<S, N> {
        let zero = Lanes::splat(self.drag.simd, 0.0);
        let mut balls = [zero; N];
        if k >= SQUARED_TERMS {
            return DiscForces { table: [zero; 2], balls, runout: [zero; 2] };
        }
        let square = turning.squared[k];
        let acceleration = if k < SPEED_TERMS - 1 { turning.acceleration[k] } else { zero };
        for (force, ball) in balls.iter_mut().zip(&self.balls) {
            *force = ball.by_square.fused(square, ball.by_acceleration * acceleration);
        }
        let [e_x, e_y] = self.runout;
        let runout =
            [square.fused(e_x, acceleration * e_y), square.fused(e_y, zero - acceleration * e_x)];
        let imbalance = [self.unbalance * square, zero - self.unbalance * acceleration];
        let table = [imbalance[0] - self.table * runout[0], imbalance[1] - self.table * runout[1]];
        DiscForces { table, balls, runout }
    }

    /// Returns the products of a power of time of the speed with the motion.
    #[inline(always)]
    pub(super) fn products(
        &self,
        turning: &DiscSpeedSeries<S, N>,
        terms: &[PowerCoefficients<S, N>; TERMS],
        k: usize,
    ) -> TurningProducts<S, N> {
        let simd = self.drag.simd;
        let zero = Lanes::splat(simd, 0.0);
        let (mut drag, mut frame) = ([zero; 2], [zero; 2]);
        let (mut around, mut by_ball) = ([[zero; 2]; N], [zero; N]);
        let DiscSpeedSeries { speed, squared, acceleration, number, .. } = turning;
        // With the rates of change.
        for j in 0..=k.min(number - 1) {
            let low = &terms[k - j];
            let next = &terms[k - j + 1];
            let double = Lanes::splat(simd, 2.0 * (k - j + 1) as f64) * speed[j];
            drag[0] = speed[j].fused(low.table[1], drag[0]);
            drag[1] = speed[j].fused(low.table[0], drag[1]);
            frame[0] = double.fused(next.table[1], frame[0]);
            frame[1] = (zero - double).fused(next.table[0], frame[1]);
            for (around, ball) in around.iter_mut().zip(&next.balls) {
                let [c, s] = ball.direction;
                around[0] = double.fused(s, around[0]);
                around[1] = (zero - double).fused(c, around[1]);
            }
            for (by_ball, ball) in by_ball.iter_mut().zip(&low.balls) {
                *by_ball = speed[j].fused(ball.speed, *by_ball);
            }
        }
        for j in 0..=k.min(2 * number - 2) {
            let low = &terms[k - j];
            for axis in 0..2 {
                frame[axis] = squared[j].fused(low.table[axis], frame[axis]);
                for (around, ball) in around.iter_mut().zip(&low.balls) {
                    around[axis] = squared[j].fused(ball.direction[axis], around[axis]);
                }
            }
        }
        for j in 0..=k.min(number - 2) {
            let low = &terms[k - j];
            let (plus, minus) = (acceleration[j], zero - acceleration[j]);
            frame[0] = plus.fused(low.table[1], frame[0]);
            frame[1] = minus.fused(low.table[0], frame[1]);
            for (around, ball) in around.iter_mut().zip(&low.balls) {
                let [c, s] = ball.direction;
                around[0] = plus.fused(s, around[0]);
                around[1] = minus.fused(c, around[1]);
            }
        }
        for (by_ball, ball) in by_ball.iter_mut().zip(&self.balls) {
            *by_ball *= ball.by_product;
        }
        let drag = [self.drag * drag[0], zero - self.drag * drag[1]];
        TurningProducts { drag, frame, around, held: by_ball }
    }
}

/// The forces of a power of time by the speed and the acceleration of the disc alone.
pub(super) struct DiscForces<S: Vector, const N: usize> {
    /// On the table.
    pub(super) table: [Lanes<S>; 2],
    /// On each ball, against its motion, times the mobility.
    pub(super) balls: [Lanes<S>; N],
    /// The acceleration of the table without that of the ring's centre, `S`.
    pub(super) runout: [Lanes<S>; 2],
}

/// The products of a power of time of the speed of the disc with the motion.
pub(super) struct TurningProducts<S: Vector, const N: usize> {
    /// The force of the damper on the table because the frame turns.
    pub(super) drag: [Lanes<S>; 2],
    /// z̈ without the absolute acceleration.
    pub(super) frame: [Lanes<S>; 2],
    /// `-(2iω ė - ω² e + iα e)`, with the direction of each ball for `e`.
    pub(super) around: [[Lanes<S>; 2]; N],
    /// The friction by `ω β̇`, times the mobility.
    pub(super) held: [Lanes<S>; N],
}

/// The speed of the disc in a step.
#[derive(Clone, Copy)]
pub(super) struct DiscSpeedSeries<S: Vector, const N: usize> {
    pub(super) speed: [Lanes<S>; SPEED_TERMS],
    pub(super) squared: [Lanes<S>; SQUARED_TERMS],
    pub(super) acceleration: [Lanes<S>; SPEED_TERMS - 1],
    /// The number of coefficients of the speed that are not zero in all lanes.
    number: usize,
    pub(super) balls: [BallOnDisc<S>; N],
}

/// The parameters of a ball for the forces on it.
#[derive(Clone, Copy)]
pub(super) struct BallOnDisc<S: Vector> {
    /// `2 - 2 J d`, or 2 (Newton): the normal force without the table's acceleration gains this times `ω β̇`.
    pub(super) pressed: Lanes<S>,
    /// The least of the normal force, over `ω²`.
    pub(super) least: Lanes<S>,
    /// `1 - 2 J d`
    pub(super) euler: Lanes<S>,
}

impl<S: Vector, const N: usize> DiscSpeedSeries<S, N> {
    /// Returns a bound below the magnitude of the speed in a step of this length.
    #[inline(always)]
    pub(super) fn least_speed(&self, length: Lanes<S>) -> Lanes<S> {
        let zero = Lanes::splat(length.simd, 0.0);
        let mut change = zero;
        for term in self.speed[1..].iter().rev() {
            change = length * (change + term.abs());
        }
        (self.speed[0].abs() - change).max(zero)
    }

    /// Returns the coefficient of a power of time of the product of the speed with `exp(-t)`.
    #[inline(always)]
    pub(super) fn dying(&self, k: usize) -> Lanes<S> {
        let mut sum = Lanes::splat(self.speed[0].simd, 0.0);
        for j in 0..=k.min(SPEED_TERMS - 1) {
            sum = Lanes::splat(sum.simd, DYING[k - j][0]).fused(self.speed[j], sum);
        }
        sum
    }

    /// Returns a coefficient of the square of the speed of the disc in one lane, and of its product with the speed of a ball.
    pub(super) fn square_and_product(
        &self,
        lane: usize,
        k: usize,
        speed: impl Fn(usize) -> f64,
    ) -> [f64; 2] {
        let square = if k < SQUARED_TERMS { self.squared[k][lane] } else { 0.0 };
        let product =
            (0..=k.min(SPEED_TERMS - 1)).map(|j| self.speed[j][lane] * speed(k - j)).sum();
        [square, product]
    }
}

impl BalancerBall {
    /// Returns `2 J d`, or 0 (Newton): the coefficient of `ω β̇` in the rolling term of the normal force.
    fn rolling_by_speed(&self) -> f64 {
        -0.5 * self.rolling_quadratic * self.diameter
    }
}
