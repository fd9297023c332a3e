//! One step of the Runge-Kutta method DOP853 in a smooth phase.
//!
//! Source: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., Springer
//! 1993, section II.5.

use stickslip::model::{Number, State};

use super::dop853_tableau::{SOLUTION, STAGES, Term};

fn combine<const N: usize, T: Number>(terms: &[Term], stages: &[State<N, T>]) -> State<N, T> {
    let mut sum = State::zero();
    for &(stage, coefficient) in terms {
        sum.add_scaled(T::constant(coefficient), &stages[stage]);
    }
    sum
}

/// Returns the state after a step of order 8.
pub fn step<const N: usize, T: Number>(
    derivative: impl Fn(&State<N, T>) -> State<N, T>,
    start: &State<N, T>,
    length: T,
) -> State<N, T> {
    let mut stages = [derivative(start); 12];
    for (index, terms) in STAGES.iter().enumerate() {
        let mut state = *start;
        state.add_scaled(length, &combine(terms, &stages));
        stages[index + 1] = derivative(&state);
    }
    let mut end = *start;
    end.add_scaled(length, &combine(SOLUTION, &stages));
    end
}
