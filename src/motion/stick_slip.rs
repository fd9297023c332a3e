//! The decision between stick and slip by the method of the settings, at the start of a motion and at an instant.

use super::evaluator::Forces;
use super::force_model::{ForceModel, RecordedForces};
use super::joint_decision::check_forces;
use super::{Direction, Evaluator, Failure, Phase, Phases, Settings, event_driven, switch_model};
use crate::model::{Friction, Method, System};

/// Returns the initial phases, from the friction laws and the sliding speeds alone.
pub(super) fn first_phases<'f>(
    method: Method,
    band: f64,
    contacts: impl Iterator<Item = (&'f Friction, f64)>,
) -> Phases {
    let first = |(friction, speed): (&Friction, f64)| match method {
        _ if !friction.can_stick() => Phase::Free,
        Method::Switch if speed.abs() > band => Phase::Slip(Direction::of(speed)),
        Method::Event if speed != 0.0 => Phase::Slip(Direction::of(speed)),
        _ => Phase::Stick,
    };
    contacts.map(first).collect()
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

/// Returns the phases in which a motion starts from a state, by the sliding speeds there.
pub(super) fn start_phases(
    system: &dyn System,
    settings: Settings,
    at: &dyn ForceModel,
) -> Result<Phases, Failure> {
    let contacts = (0..system.contacts()).map(|i| (system.friction(i), at.speed(i)));
    let mut phases = first_phases(settings.method, settings.band, contacts);
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
