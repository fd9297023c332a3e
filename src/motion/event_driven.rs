//! The exact motion (Filippov): the switch model's limit as its band goes to zero.
//!
//! There is no band. A ball that moves is in slip until its speed is zero; there, and where the
//! force on a resting ball reaches the friction limit, the next phase of all balls at rest follows
//! from the complementarity problem of their accelerations: a ball rests if friction within its
//! limit can hold it, else it sets off against full friction in the direction in which it then
//! accelerates.
//!
//! Difficulties of such a method, and their solutions:
//!
//! - At break-away `|f_w| = μ f_n` holds only up to rounding, so that a plain "stick, else slip"
//!   finds neither or both. Within rounding ([`TIE`]) the rate of change decides: a force that is
//!   about to exceed the limit breaks the ball loose, one that is about to decrease does not.
//! - A ball may move only by rounding and come to rest at the instant at which it set off. It then
//!   rests, and is released only when the force exceeds the limit by ten times the rounding
//!   tolerance of the decision. Otherwise, a ball that creeps towards the edge of the equilibrium
//!   set, with the tangential force approaching the limit, would stop and start without end.
//! - Speeds at an event are set to exactly zero, so that a step may begin on an event; a crossing
//!   counts only in the direction in which the condition fails.
//! - All balls at rest at the instant are decided jointly, including those whose events fell into
//!   the same step.

use super::Failure;
use super::contact::{Phase, derivative, forces, look_ahead, stick_reserve};
use super::resolve_modes::resolve_modes;
use crate::model::{Forces, State, System};

/// Rounding tolerance of a condition, over the size of the forces.
const TIE: f64 = 1e-14;
/// Multiple of the rounding tolerance by which the condition must fail before a ball at rest is
/// released.
const RELEASE: f64 = 10.0;

/// Returns the slack of the condition for rest, as a force.
pub(super) fn release_slack<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
) -> f64 {
    RELEASE * TIE * system.force_scale()
}

/// Returns the initial phase of a contact, from its speed alone.
pub(super) fn first_phase(can_stick: bool, speed: f64) -> Phase {
    if !can_stick {
        Phase::Free
    } else if speed == 0.0 {
        Phase::Stick
    } else {
        Phase::Slip(speed.signum())
    }
}

/// Decides jointly for all contacts `at_rest` whether they stick or in which direction they set
/// off, and returns the corresponding forces.
///
/// # Errors
/// [`Failure::NoSolution`] if no combination meets all conditions.
pub(super) fn decide<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    state: &State<N, f64, FREE>,
    phases: &mut [Phase; N],
    at_rest: [bool; N],
) -> Result<Forces<N, f64, FREE>, Failure> {
    let tie = TIE * system.force_scale();
    let choices = [Phase::Stick, Phase::Slip(1.0), Phase::Slip(-1.0)];
    resolve_modes(system, state, phases, at_rest, choices, |forces, phases, ball| {
        match phases[ball] {
            Phase::Transition(_) | Phase::Free => None,
            Phase::Stick => {
                let reserve = stick_reserve(system, forces, ball);
                (!rests_with(system, state, phases, ball, (reserve, tie)))
                    .then(|| Phase::Slip(forces.friction[ball].signum()))
            }
            Phase::Slip(direction) => {
                let acceleration = direction * forces.beta_ddot[ball];
                // If the acceleration is zero up to rounding, the condition for rest decides.
                let sets_off = acceleration > tie
                    || (acceleration >= -tie && !rests(system, state, phases, ball, tie));
                (!sets_off).then_some(Phase::Stick)
            }
        }
    })
}

/// Returns whether a contact would rest if it stuck, with the assumed phases of the others: by the
/// value of the condition, and within rounding of zero by its rate of change.
fn rests<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    state: &State<N, f64, FREE>,
    phases: &[Phase; N],
    ball: usize,
    tie: f64,
) -> bool {
    let mut stuck = *phases;
    stuck[ball] = Phase::Stick;
    let reserve = stick_reserve(system, &forces(system, &stuck, state), ball);
    rests_with(system, state, &stuck, ball, (reserve, tie))
}

/// Returns whether a contact would rest like [`rests`], given its remaining friction in stick.
fn rests_with<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    state: &State<N, f64, FREE>,
    phases: &[Phase; N],
    ball: usize,
    (value, tie): (f64, f64),
) -> bool {
    if value.abs() > tie {
        return value > 0.0;
    }
    let ahead = look_ahead(state, &derivative(system, phases, state));
    stick_reserve(system, &forces(system, phases, &ahead), ball) - value >= -tie
}

/// Decides the phases after an event in this state. `stopped_at_once` is a contact that came to
/// rest at the instant at which it had set off; it stays at rest.
///
/// # Errors
/// [`Failure::NoSolution`] if no combination meets all conditions.
pub(super) fn switch<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    state: &mut State<N, f64, FREE>,
    phases: &mut [Phase; N],
    stopped_at_once: Option<usize>,
) -> Result<Forces<N, f64, FREE>, Failure> {
    let mut at_rest = [false; N];
    for ball in 0..N {
        match phases[ball] {
            Phase::Slip(direction) if direction * state.beta_dot[ball] <= 0.0 => {
                state.beta_dot[ball] = 0.0;
                phases[ball] = Phase::Stick;
                at_rest[ball] = stopped_at_once != Some(ball);
            }
            Phase::Stick => at_rest[ball] = true,
            _ => {}
        }
    }
    decide(system, state, phases, at_rest)
}

#[cfg(test)]
mod tests {
    use super::switch;
    use crate::model::{Friction, Slider, State};
    use crate::motion::Phase;

    /// A block that its spring pulls loose sets off, unless it has just stopped where it set off.
    #[test]
    fn what_stops_at_once_stays() {
        let slider = Slider { friction: Friction::coulomb(1.0), belt_speed: 0.0 };
        let state = State { position: [], velocity: [], beta: [1.0 + 1e-9], beta_dot: [0.0] };
        for (stopped_at_once, expected) in [(None, Phase::Slip(-1.0)), (Some(0), Phase::Stick)] {
            let (mut state, mut phases) = (state, [Phase::Slip(-1.0)]);
            switch(&slider, &mut state, &mut phases, stopped_at_once).unwrap();
            assert_eq!(phases, [expected]);
        }
    }
}
