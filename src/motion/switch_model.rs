//! The switch model (thesis sections 4.2 and 4.3, after Leine): a band around zero speed.
//!
//! Around zero speed of each ball lies a band `|β̇| ≤ η`. Outside it a ball slips; inside it either
//! sticks, with a constant angle and a speed that tends to the middle of the band, or is in
//! transition, against full friction. The thesis evaluates that vector field inside a general
//! solver. Here every smooth phase is integrated with its configuration fixed, the instant at which
//! a condition of the configuration fails is located on the dense output, and the next
//! configuration is decided jointly for all balls in the band; no step crosses a switch, so that
//! the method keeps its order.

use super::Failure;
use super::contact::{Phase, stick_reserve};
use super::resolve_modes::resolve_modes;
use crate::model::{Forces, State, System};

/// Slack of the conditions for stick and transition, as an acceleration over `L ω_n²`: a phase ends
/// when its condition fails by more than this.
///
/// The slack prevents a decision that is met only up to rounding (the instant of break-away) from
/// being taken twice. It also determines how often a creeping ball, whose tangential force stays
/// near the friction limit, alternates between stick and transition: the number of switches is
/// inversely proportional to the slack. Friction limits of a real balancer are about 1e-3, a
/// million times larger.
pub const SLACK: f64 = 1e-9;

/// Returns the initial phase of a contact, from its speed alone.
pub(super) fn first_phase(can_stick: bool, speed: f64, band: f64) -> Phase {
    if !can_stick {
        Phase::Free
    } else if speed.abs() > band {
        Phase::Slip(speed.signum())
    } else {
        Phase::Stick
    }
}

/// Decides stick or transition jointly for all contacts in the band and returns the corresponding
/// forces. Slipping contacts are unchanged.
///
/// # Errors
/// [`Failure::NoSolution`] if no combination meets all conditions.
pub fn decide<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    state: &State<N, f64, FREE>,
    phases: &mut [Phase; N],
) -> Result<Forces<N, f64, FREE>, Failure> {
    let open = phases.map(Phase::in_band);
    let choices = [Phase::Stick, Phase::Transition(1.0), Phase::Transition(-1.0)];
    resolve_modes(system, state, phases, open, choices, |forces, phases, ball| match phases[ball] {
        Phase::Slip(_) | Phase::Free => None,
        Phase::Stick => (stick_reserve(system, forces, ball) < -SLACK)
            .then(|| Phase::Transition(forces.friction[ball].signum())),
        Phase::Transition(direction) => {
            (direction * forces.beta_ddot[ball] < -SLACK).then_some(Phase::Stick)
        }
    })
}

/// Decides the phases after a switch in this state.
///
/// # Errors
/// [`Failure::NoSolution`] if no combination meets all conditions.
pub(super) fn switch<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    band: f64,
    state: &State<N, f64, FREE>,
    phases: &mut [Phase; N],
) -> Result<Forces<N, f64, FREE>, Failure> {
    for (phase, speed) in phases.iter_mut().zip(state.beta_dot) {
        *phase = match *phase {
            Phase::Slip(direction) if direction * speed <= band => Phase::Stick,
            Phase::Transition(direction) if direction * speed >= band => Phase::Slip(direction),
            _ => *phase,
        };
    }
    decide(system, state, phases)
}
