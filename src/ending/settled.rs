//! Settled: a motion that has come to an equilibrium which nothing holds but its own stability.
//!
//! Where friction cannot hold a body (viscous drag, a smooth law) a run approaches its equilibrium
//! for ever; so does a block that slides on a belt at a steady place. Such a run has settled when
//!
//! - everything is slow, and Newton's method finds an equilibrium, a state whose time derivative is
//!   zero, within [`NEAR`] of it;
//! - all eigenvalues of the equations linearised there (central differences) lie left of the
//!   imaginary axis; of those on it only the neutral ones of a family of equilibria are let through,
//!   such as three balls and more that balance in many ways.

use nalgebra::{DMatrix, DVector, Schur};

use crate::model::{State, System};
use crate::motion::{Motion, Phase, derivative};

/// The largest component of the time derivative, non-dimensional, at which a look is worth while.
const SLOW: f64 = 1e-6;
/// How near the equilibrium must be, non-dimensional.
const NEAR: f64 = 1e-3;
/// Step of the central differences, non-dimensional.
const DIFFERENCE: f64 = 1e-5;
/// Real parts of eigenvalues up to this, either way, count as zero: the accuracy of the differences.
const NEUTRAL: f64 = 1e-9;
/// A contact that slides at an equilibrium is at least this fast, so that it will not stick.
const SLIDES: f64 = 1e-3;

/// Decides when to look, so that looks do not add up: each waits as long again as the run has taken.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SettledWatch {
    next: f64,
}

impl SettledWatch {
    /// Whether the motion has settled; most steps show nothing.
    pub(super) fn look<S: System<N, FREE>, const N: usize, const FREE: usize>(
        &mut self,
        system: &S,
        motion: &Motion<S, N, FREE>,
    ) -> bool {
        if motion.time() < self.next || !may_settle(motion) {
            return false;
        }
        let slow = derivative(system, motion.phases(), motion.state());
        if flat(&slow).amax() > SLOW {
            return false;
        }
        self.next = 1.5 * motion.time();
        has_settled(system, motion).unwrap_or(false)
    }
}

/// Whether every contact slides on without dry friction to stop it, or far from stopping.
fn may_settle<S: System<N, FREE>, const N: usize, const FREE: usize>(
    motion: &Motion<S, N, FREE>,
) -> bool {
    motion.phases().iter().zip(motion.state().beta_dot).all(|(phase, speed)| match phase {
        Phase::Free => true,
        Phase::Slip(_) => speed.abs() > SLIDES,
        Phase::Stick | Phase::Transition(_) => false,
    })
}

fn has_settled<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    motion: &Motion<S, N, FREE>,
) -> Option<bool> {
    let rate = |coordinates: &DVector<f64>| {
        flat(&derivative(system, motion.phases(), &state_of::<N, FREE>(coordinates)))
    };
    let start = flat(motion.state());
    let mut equilibrium = start.clone();
    // A family of equilibria leaves the matrix singular: least squares take the shortest way there.
    for _ in 0..5 {
        let slope = jacobian(rate, &equilibrium);
        let step = slope.svd(true, true).solve(&-rate(&equilibrium), NEUTRAL).ok()?;
        equilibrium += step;
        if (&equilibrium - &start).amax() > NEAR {
            return Some(false);
        }
    }
    if rate(&equilibrium).amax() > 1e-3 * SLOW {
        return Some(false);
    }
    let slope = jacobian(rate, &equilibrium);
    if !slope.iter().all(|entry| entry.is_finite()) {
        return Some(false);
    }
    let eigenvalues = Schur::try_new(slope, f64::EPSILON, 10_000)?.complex_eigenvalues();
    let stable = eigenvalues
        .iter()
        .all(|value| value.re < -NEUTRAL || value.norm() <= NEUTRAL.sqrt() && value.re <= NEUTRAL);
    Some(stable)
}

/// The derivative of the rate by central differences.
fn jacobian(rate: impl Fn(&DVector<f64>) -> DVector<f64>, at: &DVector<f64>) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = (0..at.len())
        .map(|column| {
            let shifted = |step: f64| {
                let mut point = at.clone();
                point[column] += step;
                rate(&point)
            };
            (shifted(DIFFERENCE) - shifted(-DIFFERENCE)) / (2.0 * DIFFERENCE)
        })
        .collect();
    DMatrix::from_columns(&columns)
}

fn flat<const N: usize, const FREE: usize>(state: &State<N, f64, FREE>) -> DVector<f64> {
    let State { position, velocity, beta, beta_dot } = state;
    let values = position.iter().chain(velocity).chain(beta).chain(beta_dot);
    DVector::from_iterator(2 * (FREE + N), values.copied())
}

fn state_of<const N: usize, const FREE: usize>(values: &DVector<f64>) -> State<N, f64, FREE> {
    State {
        position: std::array::from_fn(|i| values[i]),
        velocity: std::array::from_fn(|i| values[FREE + i]),
        beta: std::array::from_fn(|i| values[2 * FREE + i]),
        beta_dot: std::array::from_fn(|i| values[2 * FREE + N + i]),
    }
}
