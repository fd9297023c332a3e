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
//! solved by the same inverse for every `k`. `(1 + ip) e` is kept in place of `e`, as the product with
//! `a` is what takes the time.

use fearless_simd::{Simd, prelude::*};

use super::equations::{Ball, Equations};
use super::trigonometry::sin_cos;
use super::{Flow, Lanes};
use crate::model::State;
use crate::motion::contact::Phase;

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
    /// (1 + ip) e^{iβ}: real and imaginary part.
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
    pub(super) inverse: [Lanes<S>; 4],
    /// m s and m c.
    pub(super) reaction: [[Lanes<S>; 2]; N],
    /// How the table's acceleration enters a ball's.
    pub(super) drawn: [[Lanes<S>; 2]; N],
    /// Directions of the balls at the start.
    pub(super) directions: [[Lanes<S>; 2]; N],
}

/// The series of all lanes.
pub(super) struct Series<S: Simd, const N: usize> {
    pub(super) terms: [Term<S, N>; TERMS],
    pub(super) solver: Solver<S, N>,
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
    /// Further force on the table.
    pub(super) push: [Lanes<S>; 2],
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
            directions: [[zero; 2]; N],
        };
        Series { terms: [term; TERMS], solver }
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
        for i in 0..N {
            let ball = &equations.balls[i];
            let (s, c) = sin_cos(start.angle[i]);
            let speed = start.speed[i];
            let real = (-ball.friction).mul_add_precise(s, c);
            let imaginary = ball.friction.mul_add_precise(c, s);
            let drawn = [ball.mobility * imaginary, -(ball.mobility * real)];
            let reaction = [ball.mass * s, ball.mass * c];
            let terms = [
                reaction[0] * drawn[0],
                reaction[0] * drawn[1],
                reaction[1] * drawn[0],
                reaction[1] * drawn[1],
            ];
            if i == 0 {
                [m_xx, m_xy, m_yx, m_yy] = terms;
            } else {
                m_xx += terms[0];
                m_xy += terms[1];
                m_yx += terms[2];
                m_yy += terms[3];
            }
            let turns = ball.free * speed;
            first.balls[i].speed = speed;
            first.balls[i].direction = [real, imaginary];
            second.balls[i].direction = [-(turns * imaginary), turns * real];
            self.solver.reaction[i] = reaction;
            self.solver.drawn[i] = drawn;
            self.solver.directions[i] = [real, imaginary];
        }
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
                solve(&mut self.terms, &self.solver, equations, k, sums, Constants::Whole);
            },
        );
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

    /// The state a time later.
    #[inline(always)]
    pub(super) fn at(
        &self,
        equations: &Equations<S, N>,
        start: &Flow<S, N>,
        time: Lanes<S>,
    ) -> Flow<S, N> {
        let zero = Lanes::splat(time.simd, 0.0);
        let last = &self.terms[TERMS - 1];
        let mut position = last.table;
        let mut velocity = [zero; 2];
        let mut speed = [zero; N];
        let mut angle = [zero; N];
        for (k, term) in self.terms[..TERMS - 1].iter().enumerate().rev() {
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
        for i in 0..N {
            let turned = equations.balls[i].free * time;
            end.angle[i] = turned.mul_add_precise(angle[i], start.angle[i]);
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
        phases: &[Phase; N],
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
            for (ball, phase) in phases.iter().enumerate() {
                if *phase != Phase::Stick {
                    powers[k].beta[ball] =
                        length * powers[k - 1].beta_dot[ball] * RECIPROCALS[k];
                }
            }
        }
        powers
    }
}

/// 1/k.
const RECIPROCALS: [f64; TERMS + 1] = {
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
    let nothing =
        Sums { turning: [zero; 2], drawn: zero, squared: zero, push: [zero; 2] };
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

/// Solves the equations for coefficient `k` of the accelerations, and enters what follows from it.
#[inline(always)]
pub(super) fn solve<S: Simd, const N: usize>(
    terms: &mut [Term<S, N>; TERMS],
    solver: &Solver<S, N>,
    equations: &Equations<S, N>,
    k: usize,
    sums: [Sums<S>; N],
    constants: Constants,
) {
    let simd = equations.speed.simd;
    let number = |value: f64| Lanes::splat(simd, value);
    let (of_next, of_after) = (RECIPROCALS[k + 1], RECIPROCALS[k + 2]);
    let factor = number((k + 1) as f64);
    let (lower, higher) = terms.split_at_mut(k + 1);
    let (now, [next, after, ..]) = (&mut lower[k], higher) else { return };
    let whole = constants == Constants::Whole && k == 0;
    let [x, y] = now.table;
    let [x_dot, y_dot] = [next.table[0] * factor, next.table[1] * factor];
    let mut force_x = equations.drag_speed.mul_add_precise(y, -x);
    let mut force_y = (-equations.drag_speed).mul_add_precise(x, -y);
    if whole {
        force_x += equations.imbalance;
    }
    force_x = (-equations.drag).mul_add_precise(x_dot, force_x);
    force_y = (-equations.drag).mul_add_precise(y_dot, force_y);
    let mut own = [number(0.0); N];
    let (mut push_x, mut push_y) = (number(0.0), number(0.0));
    for i in 0..N {
        let ball = &equations.balls[i];
        let Sums { turning, drawn, squared, push } = sums[i];
        let speed = now.balls[i].speed;
        let [c, s] = now.balls[i].direction;
        let [c_next, s_next] = next.balls[i].direction;
        let [m_s, m_c] = solver.reaction[i];
        let mut held = ball.held[1].mul_add_precise(speed, ball.held[2] * squared);
        if whole {
            held += ball.held[0];
        }
        own[i] = ball.mobility * (drawn - held);
        // ë + 2iω ė - ω² e, but for what the acceleration itself brings, turned by 1 + ip.
        let real = equations.double_speed.mul_add_precise(c_next, turning[0]);
        let imaginary = equations.double_speed.mul_add_precise(s_next, turning[1]);
        let inward = factor.mul_add_precise(imaginary, equations.speed_squared * c);
        let across = factor.mul_add_precise(real, -(equations.speed_squared * s));
        let residual = ball.stuck * equations.double_speed.mul_add_precise(speed, squared);
        let around_x = ball.turned_mass.mul_add_precise(inward, push[0]);
        let around_x = residual.mul_add_precise(m_c, around_x);
        let around_x = (-ball.turned_friction).mul_add_precise(across, around_x);
        let around_y = (-ball.turned_mass).mul_add_precise(across, push[1]);
        let around_y = residual.mul_add_precise(m_s, around_y);
        let around_y = (-ball.turned_friction).mul_add_precise(inward, around_y);
        let of_ball_x = m_s.mul_add_precise(own[i], around_x);
        let of_ball_y = (-m_c).mul_add_precise(own[i], around_y);
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
    let frame_y = (-equations.double_speed).mul_add_precise(x_dot, equations.speed_squared * y);
    let twice = number(of_next * of_after);
    let table = [twice * (pull_x + frame_x), twice * (pull_y + frame_y)];
    after.table = table;
    for i in 0..N {
        let [along, across] = solver.drawn[i];
        let acceleration = along.mul_add_precise(pull_x, across.mul_add_precise(pull_y, own[i]));
        // What is left of the speed of a ball that sticks dies out.
        let Ball { stuck, free, .. } = equations.balls[i];
        let speed =
            number(of_next) * (-stuck).mul_add_precise(now.balls[i].speed, acceleration);
        next.balls[i].speed = speed;
        let [real, imaginary] = solver.directions[i];
        let part = number(of_after) * free;
        let turning = sums[i].turning;
        after.balls[i].direction = [
            -(part * speed.mul_add_precise(imaginary, turning[1])),
            part * speed.mul_add_precise(real, turning[0]),
        ];
    }
}
