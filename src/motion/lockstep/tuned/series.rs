//! The motion from a state on as power series in time, in all lanes: Taylor's method.
//!
//! Within a smooth phase everything in the equations of motion is a sum or a product of series, so that
//! their coefficients follow one after another (Å. Jorba, M. Zou, Exp. Math. 14 (2005) 99,
//! doi:10.1080/10586458.2005.10128904). With `e = exp(iβ)` of each ball, `w = ω + β̇`, and everything in
//! the turning frame as complex numbers:
//!
//! ```text
//! ė = i β̇ e
//! a = f(z, ż) - Σ m (ë + 2iω ė - ω² e)              the table's absolute acceleration
//! z̈ = a - 2iω ż + ω² z
//! β̈ = (u·a - held) / (1 + 4J)                        u = s + p c, p c - s: (1 + ip) e, turned
//! ```
//!
//! where `held` is a polynomial of degree two in `β̇`. The equations for coefficient `k` of `a` and
//! of all `β̈` are coupled by factors of the start state: the 2×2 system for the table has the same
//! inverse for every `k`. Instead of `e`, its *direction* `U = m (1 + ip) e / (1 + p²)` is stored,
//! because the products with it dominate the cost.
//!
//! Where balls touch, the forces in the gaps between them are further unknowns (`gap_forces`).
//!
//! In the switch model a sticking ball may have a residual speed, up to the width of the band, that
//! decays as `exp(-t)`. It is treated separately from the series.

use fearless_simd::prelude::*;

use super::equations::Equations;
use super::gap_forces::{GapForceEffect, GapForceEquations, OfEach};
use super::recurrence::{ProductSums, RECIPROCALS, Solving, products, solve};
use super::terms::{BalancerLaneStates, PowerCoefficients, ResidualForce, Solver};
use crate::motion::lockstep::trigonometry::sin_cos;
use crate::motion::lockstep::vector::{Fused, Powers, Vector, vectorized};
use crate::motion::lockstep::{Lanes, ORDER, TERMS};

/// The sums of the powers above those of the series, over the first of them.
pub(super) struct HigherPowers<S: Vector, const N: usize> {
    /// For the table's position, from the power `TERMS` on, and the slope of that.
    pub(super) position: [Lanes<S>; 2],
    pub(super) slope: [Lanes<S>; 2],
    /// For the balls' speeds, from the power `ORDER + 1` on, and for their angles, from the next
    /// one on.
    pub(super) speed: [Lanes<S>; N],
    pub(super) angle: [Lanes<S>; N],
}

impl<S: Vector, const N: usize> HigherPowers<S, N> {
    /// No higher powers.
    #[inline(always)]
    pub(super) fn none(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        HigherPowers { position: [zero; 2], slope: [zero; 2], speed: [zero; N], angle: [zero; N] }
    }
}

/// The series of all lanes.
pub(super) struct BalancerSeries<S: Vector, const N: usize> {
    pub(super) terms: [PowerCoefficients<S, N>; TERMS],
    pub(super) solver: Solver<S, N>,
    /// `None` if no sticking ball has a residual speed.
    pub(super) residual: Option<ResidualForce<S>>,
    pub(super) response: GapForceEffect<S, N>,
    /// The coefficients of the forces in gaps, if the response is active.
    pub(super) forces: [OfEach<S, N>; ORDER],
    /// Work space of an order, except for `FEW` balls: new arrays would have to be cleared.
    pub(super) sums: [[ProductSums<S>; N]; 2],
}

impl<S: Vector, const N: usize> BalancerSeries<S, N> {
    pub(super) fn zero(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let solver = Solver {
            inverse: [zero; 4],
            reaction: [[zero; 2]; N],
            drawn: [[zero; 2]; N],
            trigonometry: [[zero; 2]; N],
            residual: [zero; N],
        };
        BalancerSeries {
            terms: [PowerCoefficients::zero(simd); TERMS],
            solver,
            residual: None,
            response: GapForceEffect::none(simd),
            forces: [[zero; N]; ORDER],
            sums: [[ProductSums::zero(simd); N]; 2],
        }
    }

    /// Expands the motion from a state.
    #[inline(always)]
    pub(super) fn expand(
        &mut self,
        equations: &Equations<S, N>,
        gaps: &GapForceEquations<S, N>,
        start: &BalancerLaneStates<S, N>,
    ) {
        self.begin(equations, start);
        self.response.begin(gaps, &self.solver);
        if self.response.active {
            for k in 0..ORDER {
                self.order::<true>(equations, k);
            }
        } else {
            for k in 0..ORDER {
                self.order::<false>(equations, k);
            }
        }
    }

    #[inline(always)]
    fn begin(&mut self, equations: &Equations<S, N>, start: &BalancerLaneStates<S, N>) {
        let simd = equations.speed.simd;
        let zero = Lanes::splat(simd, 0.0);
        let one = Lanes::splat(simd, 1.0);
        // Sums over the balls are separate from the table's own terms and are not fused, so that
        // exchanging two balls gives the same results bit for bit.
        let (mut m_xx, mut m_xy, mut m_yx, mut m_yy) = (zero, zero, zero, zero);
        let mut residual = [[zero; 2]; 2];
        let double_speed = equations.double_speed;
        let [first, second, ..] = &mut self.terms;
        let [x, y, x_dot, y_dot] = start.table;
        first.table = [x, y];
        second.table = [x_dot, y_dot];
        for i in 0..N {
            let ball = &equations.balls[i];
            let (s, c) = sin_cos(start.angle[i]);
            let speed = ball.free * start.speed[i];
            let left = start.speed[i] - speed;
            let real = ball.turned * (c - ball.friction * s);
            let imaginary = ball.turned * (s + ball.friction * c);
            let drawn = [ball.drawing * imaginary, -(ball.drawing * real)];
            let (m_s, m_c) = (ball.mass * s, ball.mass * c);
            let linear = double_speed * left;
            let square = left * left;
            let terms = [m_s * drawn[0], m_s * drawn[1], m_c * drawn[0], m_c * drawn[1]];
            let forces = [[m_c * linear, m_s * linear], [m_c * square, m_s * square]];
            if i == 0 {
                [m_xx, m_xy, m_yx, m_yy] = terms;
                residual = forces;
            } else {
                m_xx += terms[0];
                m_xy += terms[1];
                m_yx += terms[2];
                m_yy += terms[3];
                for which in 0..2 {
                    residual[which][0] += forces[which][0];
                    residual[which][1] += forces[which][1];
                }
            }
            first.balls[i].speed = speed;
            first.balls[i].direction = [real, imaginary];
            second.balls[i].direction = [-(speed * imaginary), speed * real];
            self.solver.reaction[i] = [m_s, -m_c];
            self.solver.drawn[i] = drawn;
            self.solver.trigonometry[i] = [c, s];
            self.solver.residual[i] = left;
        }
        let nothing = residual.iter().flatten().fold(zero, |most, force| most.max(force.abs()));
        self.residual = (!nothing.simd_eq(zero).all_true()).then_some(residual);
        // a_x = (d F_x + m_xy F_y) / det, a_y = (a F_y - m_yx F_x) / det, det = a d + m_xy m_yx
        let (a, d) = (one - m_xx, one + m_yy);
        let inverse = one / a.fused(d, m_xy * m_yx);
        self.solver.inverse = [d * inverse, m_xy * inverse, -(m_yx * inverse), a * inverse];
    }

    /// Computes coefficient `k` of the accelerations and the dependent coefficients. One function
    /// serves all orders: its loops are short enough, and unrolled over the orders they would not
    /// fit the caches.
    #[inline(never)]
    fn order<const TOUCHING: bool>(&mut self, equations: &Equations<S, N>, k: usize) {
        vectorized!(equations.speed.simd, {
            let BalancerSeries { terms, sums: [workspace, _], .. } = self;
            let mut few = [ProductSums::zero(equations.speed.simd); N];
            let sums = if N <= FEW && !TOUCHING { &mut few } else { workspace };
            add_up(terms, k, sums);
            let residual = self.residual.as_ref();
            let gaps = &self.response;
            let by = Solving { solver: &self.solver, start: None, residual, gaps };
            let forces = solve::<S, N, TOUCHING>(terms, equations, &by, k, sums);
            if let Some(forces) = forces {
                self.forces[k] = forces;
            }
        });
    }

    /// Returns the state a time later, from the powers up to an order and those above it.
    #[inline(always)]
    pub(super) fn at(
        &self,
        equations: &Equations<S, N>,
        start: &BalancerLaneStates<S, N>,
        time: Lanes<S>,
        order: usize,
        higher: HigherPowers<S, N>,
    ) -> BalancerLaneStates<S, N> {
        let HigherPowers { mut position, slope: mut velocity, mut speed, mut angle } = higher;
        for axis in 0..2 {
            velocity[axis] = velocity[axis].fused(time, position[axis]);
            position[axis] = position[axis].fused(time, self.terms[order + 1].table[axis]);
        }
        for (k, term) in self.terms[..=order].iter().enumerate().rev() {
            for axis in 0..2 {
                velocity[axis] = velocity[axis].fused(time, position[axis]);
                position[axis] = position[axis].fused(time, term.table[axis]);
            }
            let part = Lanes::splat(time.simd, RECIPROCALS[k + 1]);
            for i in 0..N {
                let of_ball = term.balls[i].speed;
                speed[i] = speed[i].fused(time, of_ball);
                angle[i] = angle[i].fused(time, part * of_ball);
            }
        }
        let mut end = BalancerLaneStates {
            table: [position[0], position[1], velocity[0], velocity[1]],
            angle: start.angle,
            speed,
        };
        for (end, turned) in end.angle.iter_mut().zip(angle) {
            *end = time.fused(turned, *end);
        }
        if self.residual.is_some() {
            let left = decay(time);
            for (i, end) in end.speed.iter_mut().enumerate() {
                let residual = equations.balls[i].stuck * start.speed[i];
                *end = residual.fused(left, *end);
            }
        }
        end
    }

    /// Returns the coefficients of a component of the state in one lane; the series of the angles begin at `start`.
    pub(super) fn component(&self, lane: usize, component: usize, start: f64) -> Powers {
        let mut powers = [0.0; TERMS];
        let terms = || self.terms.iter().enumerate();
        match component {
            0 | 1 => terms().for_each(|(k, term)| powers[k] = term.table[component][lane]),
            2 | 3 => terms().skip(1).for_each(|(k, term)| {
                powers[k - 1] = k as f64 * term.table[component - 2][lane];
            }),
            _ if component < 4 + N => {
                powers[0] = start;
                for (k, term) in terms().take(ORDER + 1) {
                    powers[k + 1] = RECIPROCALS[k + 1] * term.balls[component - 4].speed[lane];
                }
            }
            _ => {
                let ball = component - 4 - N;
                let mut dying = self.solver.residual[ball][lane];
                for (k, term) in terms().take(ORDER + 1) {
                    powers[k] = term.balls[ball].speed[lane] + dying;
                    dying *= -RECIPROCALS[k + 1];
                }
            }
        }
        powers
    }
}

/// The largest number of balls for which the sums of an order are in registers. The equations of balls that touch need the registers
/// themselves.
const FEW: usize = 2;

/// Computes the products of an order.
#[inline(always)]
fn add_up<S: Vector, const N: usize>(
    terms: &mut [PowerCoefficients<S, N>; TERMS],
    k: usize,
    all: &mut [ProductSums<S>; N],
) {
    products(terms, terms, k, all);
    let mut first = 0;
    while first + 2 <= N {
        squares::<S, N, 2>(terms, k, first, all);
        first += 2;
    }
    if first < N {
        squares::<S, N, 1>(terms, k, first, all);
    }
}

/// Computes coefficient `k` of the squares of the speeds of `M` balls from `first` on, together: each sum alone would wait
/// for its previous term.
#[inline(always)]
fn squares<S: Vector, const N: usize, const M: usize>(
    terms: &mut [PowerCoefficients<S, N>; TERMS],
    k: usize,
    first: usize,
    all: &mut [ProductSums<S>; N],
) {
    let lower = &mut terms[..=k];
    let mut squared = [Lanes::splat(lower[0].table[0].simd, 0.0); M];
    let pairs = lower[1..k.div_ceil(2).max(1)].iter().zip(lower[..k].iter().rev());
    for (low, high) in pairs {
        for (i, squared) in squared.iter_mut().enumerate() {
            let (low, high) = (low.balls[first + i].speed, high.balls[first + i].speed);
            *squared = low.fused(high, *squared);
        }
    }
    for (i, squared) in squared.into_iter().enumerate() {
        let speed = |k: usize| lower[k].balls[first + i].speed;
        let mut sum = speed(0) * speed(0);
        if k > 0 {
            sum = speed(0).fused(speed(k), squared);
            sum += sum;
            if k.is_multiple_of(2) {
                sum = speed(k / 2).fused(speed(k / 2), sum);
            }
        }
        all[first + i].squared = sum;
        lower[k].balls[first + i].squared = sum;
    }
}

/// Returns `exp(-time)`, for times from 0 to about 100.
#[inline(always)]
pub(super) fn decay<S: Vector>(time: Lanes<S>) -> Lanes<S> {
    const HALVINGS: i32 = 6;
    let part = time * Lanes::splat(time.simd, -1.0 / (1 << HALVINGS) as f64);
    let mut sum = Lanes::splat(time.simd, 1.0);
    for k in (1..=12).rev() {
        let factor = part * Lanes::splat(time.simd, RECIPROCALS[k]);
        sum = factor.fused(sum, Lanes::splat(time.simd, 1.0));
    }
    for _ in 0..HALVINGS {
        sum = sum * sum;
    }
    sum
}
