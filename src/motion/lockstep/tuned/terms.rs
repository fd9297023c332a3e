//! The states of a balancer in all lanes, and what a power series of the motion consists of: its terms, and what all of its terms
//! are solved with.

use fearless_simd::prelude::*;

use crate::model::State;
use crate::motion::lockstep::vector::Vector;
use crate::motion::lockstep::{Lanes, TERMS};

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

/// The components of a state, or of its rate of change, of each run.
#[derive(Clone, Copy)]
pub(in crate::motion::lockstep) struct BalancerLaneStates<S: Vector, const N: usize> {
    /// x, y, ẋ, ẏ.
    pub(super) table: [Lanes<S>; 4],
    /// Angles of the balls.
    pub(super) angle: [Lanes<S>; N],
    /// Their speeds.
    pub(super) speed: [Lanes<S>; N],
}

impl<S: Vector, const N: usize> BalancerLaneStates<S, N> {
    /// Zero in all lanes.
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        BalancerLaneStates { table: [zero; 4], angle: [zero; N], speed: [zero; N] }
    }

    /// Returns one run's components.
    pub(super) fn lane(&self, lane: usize) -> State<N> {
        let [x, y, x_dot, y_dot] = self.table.each_ref().map(|of_all| of_all[lane]);
        State {
            position: [x, y],
            velocity: [x_dot, y_dot],
            beta: self.angle.each_ref().map(|of_all| of_all[lane]),
            beta_dot: self.speed.each_ref().map(|of_all| of_all[lane]),
        }
    }
}

/// Returns the components of a balancer that are angles.
pub(in crate::motion::lockstep) fn angles(balls: usize) -> std::ops::Range<usize> {
    4..4 + balls
}

/// The coefficients of one power of time for one ball.
#[derive(Clone, Copy)]
pub(super) struct BallCoefficients<S: Vector> {
    /// Speed.
    pub(super) speed: Lanes<S>,
    /// Its square.
    pub(super) squared: Lanes<S>,
    /// m (1 + ip) e^{iβ} / (1 + p²): real and imaginary part.
    pub(super) direction: [Lanes<S>; 2],
}

/// The coefficients of one power of time.
#[derive(Clone, Copy)]
pub(super) struct PowerCoefficients<S: Vector, const N: usize> {
    /// Position of the table.
    pub(super) table: [Lanes<S>; 2],
    /// Its absolute acceleration.
    pub(super) pull: [Lanes<S>; 2],
    pub(super) balls: [BallCoefficients<S>; N],
}

impl<S: Vector, const N: usize> PowerCoefficients<S, N> {
    /// All coefficients are zero. Not inlined: copies of it take less code than zeros.
    #[inline(never)]
    pub(super) fn zero(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let ball = BallCoefficients { speed: zero, squared: zero, direction: [zero; 2] };
        PowerCoefficients { table: [zero; 2], pull: [zero; 2], balls: [ball; N] }
    }
}

/// Solver of the equations of a power of time for the accelerations.
#[derive(Clone, Copy)]
pub(super) struct Solver<S: Vector, const N: usize> {
    /// The inverse of the table's 2×2 system: first row, second row.
    pub(super) inverse: [Lanes<S>; 4],
    /// Reaction of a ball's acceleration on the table: m s and -m c.
    pub(super) reaction: [[Lanes<S>; 2]; N],
    /// Effect of the table's acceleration on a ball's.
    pub(super) drawn: [[Lanes<S>; 2]; N],
    /// Cosine and sine of the angles at the start.
    pub(super) trigonometry: [[Lanes<S>; 2]; N],
    /// The residual speeds of sticking balls at the start.
    pub(super) residual: [Lanes<S>; N],
}

/// The contribution of residual speeds to the force on the table: coefficients of exp(-t) and of
/// exp(-2t).
pub(super) type ResidualForce<S> = [[Lanes<S>; 2]; 2];
