//! Dense output: the state at any time in a step.

use super::lockstep::TERMS;
use crate::model::State;

/// Dense output of one step.
#[derive(Clone, Debug)]
pub struct Interpolant<const N: usize, const FREE: usize = 2>(Form<N, FREE>);

#[derive(Clone, Debug)]
enum Form<const N: usize, const FREE: usize> {
    /// DOP853's form: products of `θ` and `1 - θ` in turn. Of order 7.
    Dop853 { start: State<N, f64, FREE>, coefficients: [State<N, f64, FREE>; 7] },
    /// Powers of `θ`, in which the step itself was computed.
    Powers(Box<[State<N, f64, FREE>; TERMS]>),
}

impl<const N: usize, const FREE: usize> Interpolant<N, FREE> {
    pub(super) fn of_dop853(
        start: State<N, f64, FREE>,
        coefficients: [State<N, f64, FREE>; 7],
    ) -> Self {
        Interpolant(Form::Dop853 { start, coefficients })
    }

    pub(super) fn of_powers(coefficients: Box<[State<N, f64, FREE>; TERMS]>) -> Self {
        Interpolant(Form::Powers(coefficients))
    }

    /// The state at the fraction `theta` of the step, 0 at its start and 1 at its end.
    pub fn at(&self, theta: f64) -> State<N, f64, FREE> {
        let mut sum = State::zero();
        match &self.0 {
            Form::Dop853 { start, coefficients } => {
                for (index, coefficient) in coefficients.iter().rev().enumerate() {
                    sum.add_scaled(1.0, coefficient);
                    let factor = if index % 2 == 0 { theta } else { 1.0 - theta };
                    let previous = sum;
                    sum = State::zero();
                    sum.add_scaled(factor, &previous);
                }
                sum.add_scaled(1.0, start);
            }
            Form::Powers(coefficients) => {
                for coefficient in coefficients.iter().rev() {
                    let higher = sum;
                    sum = *coefficient;
                    sum.add_scaled(theta, &higher);
                }
            }
        }
        sum
    }

    /// Returns the position of one contact at the fraction `theta` and its slope over the step, for
    /// locating a position without the other components.
    pub(super) fn position_at(&self, contact: usize, theta: f64) -> (f64, f64) {
        let (mut sum, mut slope) = (0.0, 0.0);
        match &self.0 {
            Form::Dop853 { start, coefficients } => {
                for (index, coefficient) in coefficients.iter().rev().enumerate() {
                    sum += coefficient.beta[contact];
                    let (factor, sign) =
                        if index % 2 == 0 { (theta, 1.0) } else { (1.0 - theta, -1.0) };
                    slope = slope * factor + sum * sign;
                    sum *= factor;
                }
                (sum + start.beta[contact], slope)
            }
            Form::Powers(coefficients) => {
                for coefficient in coefficients.iter().rev() {
                    slope = slope * theta + sum;
                    sum = sum * theta + coefficient.beta[contact];
                }
                (sum, slope)
            }
        }
    }
}
