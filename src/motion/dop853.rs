//! One step of the Runge-Kutta method DOP853 in a smooth phase, its error, its dense output.
//!
//! Source: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., Springer
//! 1993, sections II.5 (method, error estimate) and II.6 (dense output).

use super::dop853_tableau::{
    DENSE, DENSE_STAGES, ERROR_FIFTH, ERROR_THIRD, SOLUTION, STAGES, Term,
};
use super::interpolant::Interpolant;
use crate::model::{Number, State};

/// Errors allowed per step: `absolute + relative · |component|`, where angles count as 1 rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Relative part.
    pub relative: f64,
    /// Absolute part, non-dimensional.
    pub absolute: f64,
}

/// A step that was tried: 12 stages and the state they lead to.
#[derive(Clone, Debug)]
pub struct Step<const N: usize, T = f64, const FREE: usize = 2> {
    /// State at the step's start.
    pub start: State<N, T, FREE>,
    /// State at its end, of order 8.
    pub end: State<N, T, FREE>,
    /// Its length, non-dimensional time.
    pub length: T,
    pub(super) stages: [State<N, T, FREE>; 12],
}

#[inline]
fn combine<const N: usize, T: Number, const FREE: usize>(
    terms: &[Term],
    stages: &[State<N, T, FREE>],
) -> State<N, T, FREE> {
    let mut sum = State::zero();
    for &(stage, coefficient) in terms {
        sum.add_scaled(T::constant(coefficient), &stages[stage]);
    }
    sum
}

impl<const N: usize, T: Number, const FREE: usize> Step<N, T, FREE> {
    /// Tries a step of `length` from `start`, whose derivative is known.
    #[inline]
    pub fn attempt(
        right_hand_side: impl Fn(&State<N, T, FREE>) -> State<N, T, FREE>,
        start: &State<N, T, FREE>,
        derivative: &State<N, T, FREE>,
        length: T,
    ) -> Self {
        let mut stages = [*derivative; 12];
        for (index, terms) in STAGES.iter().enumerate() {
            let mut state = *start;
            state.add_scaled(length, &combine(terms, &stages));
            stages[index + 1] = right_hand_side(&state);
        }
        let mut end = *start;
        end.add_scaled(length, &combine(SOLUTION, &stages));
        Step { start: *start, end, length, stages }
    }
}

impl<const N: usize, const FREE: usize> Step<N, f64, FREE> {
    /// Returns a step that was computed by another method, without stages.
    pub(super) fn without_stages(
        start: State<N, f64, FREE>,
        end: State<N, f64, FREE>,
        length: f64,
    ) -> Self {
        Step { start, end, length, stages: [State::zero(); 12] }
    }

    /// Returns the ratio of the estimated to the allowed error, root mean square over the
    /// components: at most 1 is accepted. NaN or infinite if the step left the finite numbers. With
    /// `angular` the contacts' positions are angles, which count as 1 rad in the relative error.
    pub fn error(&self, tolerance: Tolerance, angular: bool) -> f64 {
        let fifth = combine(ERROR_FIFTH, &self.stages);
        let third = combine(ERROR_THIRD, &self.stages);
        let Tolerance { relative, absolute } = tolerance;
        let scale = |a: f64, b: f64| 1.0 / (absolute + relative * a.abs().max(b.abs()));
        let angle_scale = 1.0 / (absolute + relative);
        let square = |value: f64| value * value;
        // Table and balls are summed separately, so that exchanging two balls gives the same sum
        // bit for bit.
        let (mut fifth_table, mut third_table) = (0.0, 0.0);
        for axis in 0..FREE {
            let position = scale(self.start.position[axis], self.end.position[axis]);
            let velocity = scale(self.start.velocity[axis], self.end.velocity[axis]);
            fifth_table += square(fifth.position[axis] * position);
            fifth_table += square(fifth.velocity[axis] * velocity);
            third_table += square(third.position[axis] * position);
            third_table += square(third.velocity[axis] * velocity);
        }
        let (mut fifth_balls, mut third_balls) = (0.0, 0.0);
        for ball in 0..N {
            let speed = scale(self.start.beta_dot[ball], self.end.beta_dot[ball]);
            let angle = if angular {
                angle_scale
            } else {
                scale(self.start.beta[ball], self.end.beta[ball])
            };
            fifth_balls += square(fifth.beta[ball] * angle) + square(fifth.beta_dot[ball] * speed);
            third_balls += square(third.beta[ball] * angle) + square(third.beta_dot[ball] * speed);
        }
        let fifth = fifth_table + fifth_balls;
        let third = third_table + third_balls;
        if fifth == 0.0 {
            return 0.0;
        }
        let components = (2 * FREE + 2 * N) as f64;
        self.length.abs() * fifth / ((fifth + 0.01 * third) * components).sqrt()
    }

    /// The interpolation polynomial of order 7 over the step; costs three right-hand sides.
    pub fn interpolant(
        &self,
        right_hand_side: impl Fn(&State<N, f64, FREE>) -> State<N, f64, FREE>,
        end_derivative: &State<N, f64, FREE>,
    ) -> Interpolant<N, FREE> {
        let mut stages = [*end_derivative; 16];
        stages[..12].copy_from_slice(&self.stages);
        for (index, terms) in DENSE_STAGES.iter().enumerate() {
            let mut state = self.start;
            state.add_scaled(self.length, &combine(terms, &stages));
            stages[13 + index] = right_hand_side(&state);
        }
        let mut coefficients = [State::zero(); 7];
        let mut change = self.end;
        change.add_scaled(-1.0, &self.start);
        coefficients[0] = change;
        coefficients[1].add_scaled(self.length, &self.stages[0]);
        coefficients[1].add_scaled(-1.0, &change);
        coefficients[2].add_scaled(2.0, &change);
        coefficients[2].add_scaled(-self.length, &self.stages[0]);
        coefficients[2].add_scaled(-self.length, end_derivative);
        for (index, terms) in DENSE.iter().enumerate() {
            coefficients[3 + index].add_scaled(self.length, &combine(terms, &stages));
        }
        Interpolant::of_dop853(self.start, coefficients)
    }
}
