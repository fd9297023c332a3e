//! The decision between stick and slip by the method of the settings, at the start of a motion and at an instant.

use super::evaluator::Forces;
use super::joint_decision::{ForceModel, RecordedForces, check_forces};
use super::{Direction, Evaluator, Failure, Phase, Phases, Settings, event_driven, switch_model};
use crate::model::{Friction, Method, System};

/// The largest sliding speed that may be left, by rounding and by the error of steps, of a contact that has stuck until now.
const LEFT: f64 = 1e-7;

/// Returns the initial phases, from the friction laws and the sliding speeds alone, and from the phases until now, if there are
/// some.
pub(super) fn first_phases<'f>(
    method: Method,
    band: f64,
    contacts: impl Iterator<Item = (&'f Friction, f64)>,
    until_now: &[Phase],
) -> Phases {
    let first = |(contact, (friction, speed)): (usize, (&Friction, f64))| {
        let has_stuck = until_now.get(contact) == Some(&Phase::Stick) && speed.abs() <= LEFT;
        match method {
            _ if !friction.can_stick() => Phase::Free,
            Method::Switch if speed.abs() > band => Phase::Slip(Direction::of(speed)),
            Method::Event if speed != 0.0 && !has_stuck => Phase::Slip(Direction::of(speed)),
            _ => Phase::Stick,
        }
    };
    contacts.enumerate().map(first).collect()
}

/// Decides the phases of contacts at rest, or in the band. In the exact motion, the contacts `fixed` stay at rest.
pub(super) fn decide_at_rest(
    method: Method,
    system: &dyn ForceModel,
    phases: &mut Phases,
    fixed: &[usize],
) -> Result<(), Failure> {
    match method {
        Method::Switch => switch_model::decide(system, phases, check_forces),
        Method::Event => {
            let is_open = |(contact, phase): (usize, &Phase)| {
                *phase == Phase::Stick && !fixed.contains(&contact)
            };
            let at_rest = phases.iter().enumerate().map(is_open).collect();
            event_driven::decide(system, phases, &at_rest, check_forces)
        }
    }
}

/// Returns the phases in which a motion starts from a state, by the sliding speeds there, or goes on after these phases.
pub(super) fn start_phases(
    system: &dyn System,
    settings: Settings,
    at: &dyn ForceModel,
    until_now: &[Phase],
) -> Result<Phases, Failure> {
    let contacts = (0..system.contacts()).map(|i| (system.friction(i), at.speed(i)));
    let mut phases = first_phases(settings.method, settings.band, contacts, until_now);
    decide_at_rest(settings.method, at, &mut phases, &[])?;
    Ok(phases)
}

/// Decides stick or transition jointly for all contacts in the band of the switch model, in one state, and returns the
/// corresponding forces. Slipping contacts are unchanged.
///
/// # Errors
/// [`Failure::NoSolution`] if no combination meets all conditions, or if several different ones do.
pub fn decide(
    evaluator: &Evaluator,
    state: &[f64],
    phases: &mut Phases,
) -> Result<Forces, Failure> {
    switch_model::decide(
        &RecordedForces::new(evaluator, state),
        phases,
        |forces| Ok(forces.clone()),
    )
}
