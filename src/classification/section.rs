//! The section of a running ball's passages through the angle 0, with coordinates on it.
//!
//! The coordinates are the table's position and velocity and the variables of the balls that vary:
//! not the angle of the ball that marks the section, the speed of a ball that sticks there, or the
//! angle of a ball that rests throughout. Such a ball may rest anywhere in an interval; each such
//! angle is a neutral direction of a continuous family of cycles, with a multiplier of exactly 1.

use nalgebra::DVector;

use crate::model::{State, wrap_to_pi};
use crate::motion::Phase;

/// A section and the balls' phases there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Section<const N: usize> {
    /// The ball whose passages mark it.
    pub(super) reference: usize,
    /// The phases of the balls there.
    pub(super) phases: [Phase; N],
    /// Which balls rest throughout the orbit.
    pub(super) rests: [bool; N],
}

impl<const N: usize> Section<N> {
    fn acts_on_speed(&self, ball: usize) -> bool {
        self.phases[ball] != Phase::Stick
    }

    fn acts_on_angle(&self, ball: usize) -> bool {
        ball != self.reference && !self.rests[ball]
    }

    /// The coordinates of a state, or of a displacement.
    pub(super) fn coordinates(&self, state: &State<N>) -> DVector<f64> {
        let mut values = [state.position, state.velocity].concat();
        for ball in 0..N {
            if self.acts_on_speed(ball) {
                values.push(state.beta_dot[ball]);
            }
            if self.acts_on_angle(ball) {
                values.push(state.beta[ball]);
            }
        }
        DVector::from_vec(values)
    }

    /// Returns the state with these coordinates; the other variables are those of `like`, and the
    /// marking ball is at the angle 0.
    pub(super) fn state(&self, like: &State<N>, coordinates: &DVector<f64>) -> State<N> {
        let mut state = *like;
        let mut values = coordinates.iter().copied();
        let mut next = || values.next().unwrap_or(0.0);
        state.position = [next(), next()];
        state.velocity = [next(), next()];
        for ball in 0..N {
            if self.acts_on_speed(ball) {
                state.beta_dot[ball] = next();
            }
            if self.acts_on_angle(ball) {
                state.beta[ball] = next();
            }
        }
        state.beta[self.reference] = 0.0;
        state
    }

    /// Unit displacements along the coordinates.
    pub(super) fn directions(&self) -> Vec<State<N>> {
        let dimension = self.coordinates(&State::zero()).len();
        let unit =
            |axis: usize| DVector::from_fn(dimension, |row, _| if row == axis { 1.0 } else { 0.0 });
        (0..dimension).map(|axis| self.state(&State::zero(), &unit(axis))).collect()
    }

    /// Returns the projection on the section of a displacement of the motion, in a state with this
    /// time derivative: neighbours reach the section slightly earlier or later.
    pub(super) fn on_section(&self, displacement: &State<N>, rate: &State<N>) -> DVector<f64> {
        let mut displacement = *displacement;
        let late = displacement.beta[self.reference] / rate.beta[self.reference];
        displacement.add_scaled(-late, rate);
        self.coordinates(&displacement)
    }

    /// The difference of two states' coordinates, angles modulo 2π.
    pub(super) fn difference(&self, one: &State<N>, other: &State<N>) -> DVector<f64> {
        (self.coordinates(one) - self.coordinates(other)).map(wrap_to_pi)
    }
}
