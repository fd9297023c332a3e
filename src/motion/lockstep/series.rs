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
//! where `held` is a polynomial of degree two in `β̇`. Coefficient `k` of `a` and of all `β̈` enter each
//! other's equations with the factors that they have in the start state: the 2×2 system for the table is
//! solved by the same inverse for every `k`. In place of `e` its *direction* `U = m (1 + ip) e / (1 + p²)`
//! is kept, as the products with it are what takes the time.
//!
//! In the switch model a ball that sticks may have a speed, up to the width of the band, that dies out as
//! `exp(-t)`. It is kept apart from the series.

use fearless_simd::{Simd, prelude::*};

use super::equations::Equations;
use super::trigonometry::sin_cos;
use super::{Flow, Lanes};
use crate::model::State;

/// The highest power of time in the series of speeds.
pub(super) const ORDER: usize = 16;
/// Coefficients of the series of positions.
pub(crate) const TERMS: usize = ORDER + 2;

/// The coefficients of one power of time that are of one ball.
#[derive(Clone, Copy)]
pub(super) struct BallTerm<S: Simd> {
    /// Speed.
    pub(super) speed: Lanes<S>,
    /// Its square.
    pub(super) squared: Lanes<S>,
    /// m (1 + ip) e^{iβ} / (1 + p²): real and imaginary part.
    pub(super) direction: [Lanes<S>; 2],
}

/// The coefficients of one power of time.
#[derive(Clone, Copy)]
pub(super) struct Term<S: Simd, const N: usize> {
    /// Position of the table.
    pub(super) table: [Lanes<S>; 2],
    /// Its absolute acceleration.
    pub(super) pull: [Lanes<S>; 2],
    pub(super) balls: [BallTerm<S>; N],
}

/// What solves the equations of a power of time for the accelerations.
#[derive(Clone, Copy)]
pub(super) struct Solver<S: Simd, const N: usize> {
    /// The inverse of the table's 2×2 system: first row, second row.
    inverse: [Lanes<S>; 4],
    /// How a ball's acceleration pushes the table: m s and -m c.
    reaction: [[Lanes<S>; 2]; N],
    /// How the table's acceleration enters a ball's.
    drawn: [[Lanes<S>; 2]; N],
    /// Cosine and sine of the angles at the start.
    pub(super) trigonometry: [[Lanes<S>; 2]; N],
    /// What is left of the speeds of balls that stick, at the start.
    pub(super) residual: [Lanes<S>; N],
}

/// What the residual speeds add to the force on the table, as they die out: times exp(-t), times exp(-2t).
pub(super) type ResidualForce<S> = [[Lanes<S>; 2]; 2];

/// The series of all lanes.
pub(super) struct Series<S: Simd, const N: usize> {
    pub(super) terms: [Term<S, N>; TERMS],
    pub(super) solver: Solver<S, N>,
    pub(super) residual: ResidualForce<S>,
}

/// What of an order follows from the lower ones, of one ball.
#[derive(Clone, Copy)]
pub(super) struct Sums<S: Simd> {
    /// Of Σ β̇_j U_{k+1-j}, U being the direction.
    pub(super) turning: [Lanes<S>; 2],
    /// Of u·a.
    pub(super) drawn: Lanes<S>,
    /// Of the speed's square.
    pub(super) squared: Lanes<S>,
}

/// What the equations have at order 0 only.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Constants {
    /// The imbalance and what holds a ball at no speed.
    Whole,
    /// None: the equations for displacements.
    None,
}

impl<S: Simd, const N: usize> Series<S, N> {
    pub(super) fn zero(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let ball = BallTerm { speed: zero, squared: zero, direction: [zero; 2] };
        let term = Term { table: [zero; 2], pull: [zero; 2], balls: [ball; N] };
        let solver = Solver {
            inverse: [zero; 4],
            reaction: [[zero; 2]; N],
            drawn: [[zero; 2]; N],
            trigonometry: [[zero; 2]; N],
            residual: [zero; N],
        };
        Series { terms: [term; TERMS], solver, residual: [[zero; 2]; 2] }
    }

    /// Expands the motion from a state.
    #[inline(always)]
    pub(super) fn expand(&mut self, equations: &Equations<S, N>, start: &Flow<S, N>) {
        self.begin(equations, start);
        for k in 0..ORDER {
            self.order(equations, k);
        }
    }

    #[inline(always)]
    fn begin(&mut self, equations: &Equations<S, N>, start: &Flow<S, N>) {
        let simd = equations.speed.simd;
        let zero = Lanes::splat(simd, 0.0);
        let one = Lanes::splat(simd, 1.0);
        let [first, second, ..] = &mut self.terms;
        let [x, y, x_dot, y_dot] = start.table;
        first.table = [x, y];
        second.table = [x_dot, y_dot];
        // Sums over the balls stand apart from the table's own terms and are not fused, so that two
        // balls exchanged give the same to the last bit.
        let (mut m_xx, mut m_xy, mut m_yx, mut m_yy) = (zero, zero, zero, zero);
        let mut residual = [[zero; 2]; 2];
        for i in 0..N {
            let ball = &equations.balls[i];
            let (s, c) = sin_cos(start.angle[i]);
            let speed = ball.free * start.speed[i];
            let left = start.speed[i] - speed;
            let real = ball.turned * (c - ball.friction * s);
            let imaginary = ball.turned * (s + ball.friction * c);
            let drawn = [ball.drawing * imaginary, -(ball.drawing * real)];
            let (m_s, m_c) = (ball.mass * s, ball.mass * c);
            let linear = equations.double_speed * left;
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
        self.residual = residual;
        // a_x = (d F_x + m_xy F_y) / det, a_y = (a F_y - m_yx F_x) / det, det = a d + m_xy m_yx
        let (a, d) = (one - m_xx, one + m_yy);
        let inverse = one / a.mul_add_precise(d, m_xy * m_yx);
        self.solver.inverse = [d * inverse, m_xy * inverse, -(m_yx * inverse), a * inverse];
    }

    /// Coefficient `k` of the accelerations and what follows from it. One function for all orders: the
    /// loops in it are short enough as they are, and written out they would not fit the caches.
    #[inline(never)]
    fn order(&mut self, equations: &Equations<S, N>, k: usize) {
        equations.speed.simd.vectorize(
            #[inline(always)]
            || {
                let sums = self.sums(k);
                let start: [[Lanes<S>; 2]; N] = self.directions();
                let by = Solving { solver: &self.solver, start, residual: &self.residual };
                solve(&mut self.terms, equations, &by, k, sums, Constants::Whole);
            },
        );
    }

    /// Directions at the start.
    #[inline(always)]
    pub(super) fn directions(&self) -> [[Lanes<S>; 2]; N] {
        let mut directions = [[self.terms[0].table[0]; 2]; N];
        for i in 0..N {
            directions[i] = self.terms[0].balls[i].direction;
        }
        directions
    }

    #[inline(always)]
    fn sums(&mut self, k: usize) -> [Sums<S>; N] {
        let mut sums = products(&self.terms, &self.terms, k);
        let lower = &self.terms[..=k];
        for i in 0..N {
            let latest = lower[k].balls[i].speed;
            let mut squared = sums[i].squared;
            if k == 0 {
                squared = latest * latest;
            } else {
                let pairs = lower[1..k.div_ceil(2)].iter().zip(lower[..k].iter().rev());
                for (low, high) in pairs {
                    squared = low.balls[i].speed.mul_add_precise(high.balls[i].speed, squared);
                }
                squared = lower[0].balls[i].speed.mul_add_precise(latest, squared);
                squared += squared;
                if k.is_multiple_of(2) {
                    let middle = lower[k / 2].balls[i].speed;
                    squared = middle.mul_add_precise(middle, squared);
                }
            }
            sums[i].squared = squared;
        }
        for i in 0..N {
            self.terms[k].balls[i].squared = sums[i].squared;
        }
        sums
    }

    /// The state a time later, from speeds up to a power.
    #[inline(always)]
    pub(super) fn at(
        &self,
        equations: &Equations<S, N>,
        start: &Flow<S, N>,
        time: Lanes<S>,
        order: usize,
    ) -> Flow<S, N> {
        let zero = Lanes::splat(time.simd, 0.0);
        let mut position = self.terms[order + 1].table;
        let mut velocity = [zero; 2];
        let mut speed = [zero; N];
        let mut angle = [zero; N];
        for (k, term) in self.terms[..=order].iter().enumerate().rev() {
            for axis in 0..2 {
                velocity[axis] = velocity[axis].mul_add_precise(time, position[axis]);
                position[axis] = position[axis].mul_add_precise(time, term.table[axis]);
            }
            let part = Lanes::splat(time.simd, RECIPROCALS[k + 1]);
            for i in 0..N {
                let of_ball = term.balls[i].speed;
                speed[i] = speed[i].mul_add_precise(time, of_ball);
                angle[i] = angle[i].mul_add_precise(time, part * of_ball);
            }
        }
        let mut end = Flow {
            table: [position[0], position[1], velocity[0], velocity[1]],
            angle: start.angle,
            speed,
        };
        let left = decay(time);
        for i in 0..N {
            end.angle[i] = time.mul_add_precise(angle[i], start.angle[i]);
            let residual = equations.balls[i].stuck * start.speed[i];
            end.speed[i] = residual.mul_add_precise(left, speed[i]);
        }
        end
    }
}

impl<S: Simd, const N: usize> Series<S, N> {
    /// The state in one lane as a series in the part of a step of this length that has passed.
    pub(super) fn powers(
        &self,
        lane: usize,
        start: &State<N>,
        length: f64,
    ) -> Box<[State<N>; TERMS]> {
        let mut powers = Box::new([State::zero(); TERMS]);
        let mut power = 1.0;
        for (k, (to, term)) in powers.iter_mut().zip(&self.terms).enumerate() {
            to.position = term.table.map(|of_all| power * of_all[lane]);
            if let Some(next) = self.terms.get(k + 1) {
                to.velocity = next.table.map(|of_all| power * ((k + 1) as f64 * of_all[lane]));
                to.beta_dot = term.balls.map(|ball| power * ball.speed[lane]);
            }
            power *= length;
        }
        powers[0].beta = start.beta;
        for k in 1..TERMS {
            for ball in 0..N {
                powers[k].beta[ball] = length * powers[k - 1].beta_dot[ball] * RECIPROCALS[k];
            }
        }
        let mut dying = 1.0;
        for (k, to) in powers.iter_mut().enumerate() {
            for ball in 0..N {
                to.beta_dot[ball] += dying * self.solver.residual[ball][lane];
            }
            dying *= -length * RECIPROCALS[k + 1];
        }
        powers
    }
}

/// `exp(-time)`, for times from 0 to some 100.
#[inline(always)]
fn decay<S: Simd>(time: Lanes<S>) -> Lanes<S> {
    const HALVINGS: i32 = 6;
    let part = time * Lanes::splat(time.simd, -1.0 / (1 << HALVINGS) as f64);
    let mut sum = Lanes::splat(time.simd, 1.0);
    for k in (1..=12).rev() {
        let factor = part * Lanes::splat(time.simd, RECIPROCALS[k]);
        sum = factor.mul_add_precise(sum, Lanes::splat(time.simd, 1.0));
    }
    for _ in 0..HALVINGS {
        sum = sum * sum;
    }
    sum
}

/// Coefficient `k` of exp(-t) and of exp(-2t).
pub(super) const DYING: [[f64; 2]; TERMS] = {
    let mut all = [[1.0; 2]; TERMS];
    let mut k = 1;
    while k < TERMS {
        all[k] = [-all[k - 1][0] / k as f64, -2.0 * all[k - 1][1] / k as f64];
        k += 1;
    }
    all
};

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

/// Coefficient `k + 1` of the speeds of one series times the directions of another, and coefficient `k` of
/// its pull times them, but for what has one of the factors at order 0 of the directions.
#[inline(always)]
pub(super) fn products<S: Simd, const N: usize>(
    of: &[Term<S, N>; TERMS],
    with: &[Term<S, N>; TERMS],
    k: usize,
) -> [Sums<S>; N] {
    let zero = Lanes::splat(of[0].table[0].simd, 0.0);
    let nothing = Sums { turning: [zero; 2], drawn: zero, squared: zero };
    let mut sums = [nothing; N];
    let mut along = [zero; N];
    let mut across = [zero; N];
    // What has been computed last comes last: nothing waits for it.
    let mut before = [[zero; 2]; N];
    for i in 0..N {
        before[i] = with[k].balls[i].direction;
    }
    if k > 0 {
        let [x, y] = of[0].pull;
        for i in 0..N {
            along[i] = before[i][1] * x;
            across[i] = before[i][0] * y;
        }
        let others = with[1..k].iter().rev();
        for (low, high) in of[1..k].iter().zip(others) {
            let [x, y] = low.pull;
            for i in 0..N {
                let speed = low.balls[i].speed;
                let [real, imaginary] = &mut sums[i].turning;
                *real = speed.mul_add_precise(before[i][0], *real);
                *imaginary = speed.mul_add_precise(before[i][1], *imaginary);
                before[i] = high.balls[i].direction;
                along[i] = before[i][1].mul_add_precise(x, along[i]);
                across[i] = before[i][0].mul_add_precise(y, across[i]);
            }
        }
        for i in 0..N {
            let speed = of[k].balls[i].speed;
            let [real, imaginary] = with[1].balls[i].direction;
            let [turning_real, turning_imaginary] = &mut sums[i].turning;
            *turning_real = speed.mul_add_precise(real, *turning_real);
            *turning_imaginary = speed.mul_add_precise(imaginary, *turning_imaginary);
        }
    }
    for i in 0..N {
        let speed = of[0].balls[i].speed;
        let [real, imaginary] = with[k + 1].balls[i].direction;
        let [turning_real, turning_imaginary] = &mut sums[i].turning;
        *turning_real = speed.mul_add_precise(real, *turning_real);
        *turning_imaginary = speed.mul_add_precise(imaginary, *turning_imaginary);
        sums[i].drawn = along[i] - across[i];
    }
    sums
}

/// What is the same for all orders of a series.
pub(super) struct Solving<'a, S: Simd, const N: usize> {
    pub(super) solver: &'a Solver<S, N>,
    /// Directions at the start.
    pub(super) start: [[Lanes<S>; 2]; N],
    pub(super) residual: &'a ResidualForce<S>,
}

/// Solves the equations for coefficient `k` of the accelerations, and enters what follows from it.
#[inline(always)]
pub(super) fn solve<S: Simd, const N: usize>(
    terms: &mut [Term<S, N>; TERMS],
    equations: &Equations<S, N>,
    by: &Solving<S, N>,
    k: usize,
    sums: [Sums<S>; N],
    constants: Constants,
) {
    let simd = equations.speed.simd;
    let number = |value: f64| Lanes::splat(simd, value);
    let (of_next, of_after) = (RECIPROCALS[k + 1], RECIPROCALS[k + 2]);
    let (factor, minus) = (number((k + 1) as f64), number(-((k + 1) as f64)));
    let (lower, higher) = terms.split_at_mut(k + 1);
    let (now, [next, after, ..]) = (&mut lower[k], higher) else { return };
    let solver = by.solver;
    let whole = constants == Constants::Whole && k == 0;
    let [x, y] = now.table;
    let [x_dot, y_dot] = [next.table[0] * factor, next.table[1] * factor];
    let mut force_x = equations.drag_speed.mul_add_precise(y, -x);
    let mut force_y = equations.minus_drag_speed.mul_add_precise(x, -y);
    if whole {
        force_x += equations.imbalance;
    }
    force_x = equations.minus_drag.mul_add_precise(x_dot, force_x);
    force_y = equations.minus_drag.mul_add_precise(y_dot, force_y);
    for (force, dying) in by.residual.iter().zip(DYING[k]) {
        force_x = number(dying).mul_add_precise(force[0], force_x);
        force_y = number(dying).mul_add_precise(force[1], force_y);
    }
    let mut own = [number(0.0); N];
    let (mut push_x, mut push_y) = (number(0.0), number(0.0));
    for i in 0..N {
        let ball = &equations.balls[i];
        let Sums { turning, drawn, squared } = sums[i];
        let speed = now.balls[i].speed;
        let [c, s] = now.balls[i].direction;
        let [c_next, s_next] = next.balls[i].direction;
        let mut held = ball.held[1].mul_add_precise(speed, ball.held[2] * squared);
        if whole {
            held += ball.held[0];
        }
        own[i] = ball.drawing.mul_add_precise(drawn, -held);
        // -(ë + 2iω ė - ω² e) but for what the acceleration itself brings, times 1 + ip.
        let real = equations.double_speed.mul_add_precise(c_next, turning[0]);
        let imaginary = equations.double_speed.mul_add_precise(s_next, turning[1]);
        let around_x = factor.mul_add_precise(imaginary, equations.speed_squared * c);
        let around_y = minus.mul_add_precise(real, equations.speed_squared * s);
        // The same times 1 only, with what the acceleration brings.
        let [along, across] = solver.reaction[i];
        let of_ball_x = ball.friction.mul_add_precise(around_y, around_x);
        let of_ball_x = along.mul_add_precise(own[i], of_ball_x);
        let of_ball_y = ball.minus_friction.mul_add_precise(around_x, around_y);
        let of_ball_y = across.mul_add_precise(own[i], of_ball_y);
        if i == 0 {
            (push_x, push_y) = (of_ball_x, of_ball_y);
        } else {
            (push_x, push_y) = (push_x + of_ball_x, push_y + of_ball_y);
        }
    }
    force_x += push_x;
    force_y += push_y;
    let [a, b, c, d] = solver.inverse;
    let pull_x = a.mul_add_precise(force_x, b * force_y);
    let pull_y = d.mul_add_precise(force_y, c * force_x);
    now.pull = [pull_x, pull_y];
    let frame_x = equations.double_speed.mul_add_precise(y_dot, equations.speed_squared * x);
    let frame_y = equations.minus_double_speed.mul_add_precise(x_dot, equations.speed_squared * y);
    let twice = number(of_next * of_after);
    after.table = [twice * (pull_x + frame_x), twice * (pull_y + frame_y)];
    for i in 0..N {
        let [along, across] = solver.drawn[i];
        let acceleration = along.mul_add_precise(pull_x, across.mul_add_precise(pull_y, own[i]));
        let speed = number(of_next) * acceleration;
        next.balls[i].speed = speed;
        let [real, imaginary] = by.start[i];
        let turning = sums[i].turning;
        after.balls[i].direction = [
            number(-of_after) * speed.mul_add_precise(imaginary, turning[1]),
            number(of_after) * speed.mul_add_precise(real, turning[0]),
        ];
    }
}
