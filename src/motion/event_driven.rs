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
use super::evaluator::Forces;
use super::joint_decision::{ForceModel, Open, resolve_modes, sets_off, stick_reserve};
use super::{Direction, Phase, Phases};

/// Rounding tolerance of a condition, over the size of the forces.
const TIE: f64 = 1e-14;
/// Multiple of the rounding tolerance by which the condition must fail before a ball at rest is
/// released.
const RELEASE: f64 = 10.0;

/// Static friction and that in slip are equal if they differ by at most this fraction.
const SAME_FRICTION: f64 = 1e-9;

/// Returns the rounding tolerance of the conditions, as a force.
pub(super) fn tie(force_scale: f64) -> f64 {
    TIE * force_scale
}

/// Returns the slack of the condition for rest, as a force.
pub(super) fn release_slack(force_scale: f64) -> f64 {
    RELEASE * TIE * force_scale
}

/// Decides jointly for all contacts `at_rest` whether they stick or in which direction they set
/// off, and returns what `then` returns for the corresponding forces.
pub(super) fn decide<R>(
    system: &dyn ForceModel,
    phases: &mut Phases,
    at_rest: &Open,
    then: impl FnOnce(&Forces) -> Result<R, Failure>,
) -> Result<R, Failure> {
    let tie = TIE * system.force_scale();
    let choices = [Phase::Stick, Phase::Slip(Direction::Forward), Phase::Slip(Direction::Backward)];
    let better = |forces: &Forces, phases: &[Phase], contact: usize| match phases[contact] {
        Phase::Transition(_) | Phase::Free | Phase::Apart | Phase::Open | Phase::Closed => None,
        Phase::Stick => {
            let reserve = stick_reserve(system, forces, contact);
            (!rests_with(system, phases, contact, (reserve, tie)))
                .then(|| Phase::Slip(sets_off(system, forces, contact)))
        }
        Phase::Slip(direction) => {
            let acceleration = direction * forces[contact].acceleration;
            let limit = system.limit(contact) * forces[contact].normal;
            // Static friction above that in slip holds a contact that could also slip: it sticks. Where one solution is sure, stick
            // is tried first.
            let has_reserve = limit > (1.0 + SAME_FRICTION) * forces[contact].friction.abs();
            let may_rest = has_reserve && !system.has_one_solution();
            // If the acceleration is zero up to rounding, the condition for rest decides.
            let sets_off = acceleration > tie && !may_rest
                || acceleration >= -tie && !rests(system, phases, contact, tie);
            (!sets_off).then_some(Phase::Stick)
        }
    };
    resolve_modes(system, phases, at_rest, choices, better, then)
}

/// Returns whether a contact would rest if it stuck, with the assumed phases of the others: by the
/// value of the condition, and within rounding of zero by its rate of change.
fn rests(system: &dyn ForceModel, phases: &[Phase], contact: usize, tie: f64) -> bool {
    let mut stuck = Phases::from(phases);
    stuck[contact] = Phase::Stick;
    let reserve = stick_reserve(system, &system.forces(&stuck), contact);
    rests_with(system, &stuck, contact, (reserve, tie))
}

/// Returns whether a contact would rest like [`rests`], given its remaining friction in stick.
fn rests_with(
    system: &dyn ForceModel,
    phases: &[Phase],
    contact: usize,
    (value, tie): (f64, f64),
) -> bool {
    if value.abs() > tie {
        return value > 0.0;
    }
    stick_reserve(system, &system.forces_ahead(phases), contact) - value >= -tie
}

/// Stops the contacts whose speeds have reached zero. Returns which contacts are at rest and open to a decision, and
/// which have stopped. `stopped_at_once` is a contact that came to rest at the instant at which it had set off; it
/// stays at rest.
pub(super) fn stop(
    phases: &mut Phases,
    speed: impl Fn(usize) -> f64,
    stopped_at_once: Option<usize>,
) -> (Open, Open) {
    let (mut at_rest, mut stopped) = (Open::new(), Open::new());
    for (contact, phase) in phases.iter_mut().enumerate() {
        let stops = match *phase {
            Phase::Slip(direction) => direction * speed(contact) <= 0.0,
            _ => false,
        };
        if stops {
            *phase = Phase::Stick;
        }
        stopped.push(stops);
        at_rest.push(*phase == Phase::Stick && !(stops && stopped_at_once == Some(contact)));
    }
    (at_rest, stopped)
}
