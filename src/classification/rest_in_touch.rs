//! Bodies that rest in touch: the force between them is not determined, and they rest if friction holds them for any such force.

use super::system_view::SystemView;
use crate::motion::{Phase, Phases, STILL, lies};

/// Returns the phases of bodies that rest in touch: those that do not move stick, and no force acts between those that touch.
///
/// The force between them is not determined. The decision of the phases may press just so hard that the friction of one body is
/// at its limit, as if it slipped: larger and smaller forces hold them, too, as far as friction allows. For bodies that move, and
/// where the force is determined, these are the phases.
pub(super) fn at_rest(view: &SystemView, phases: &[Phase], state: &[f64]) -> Phases {
    let mut resting = Phases::from(phases);
    let openings = &view.evaluator.graph().openings;
    if openings.is_empty() {
        return resting;
    }
    let can_hold = |contact: usize| view.system().friction(contact).limit > 0.0;
    for (contact, phase) in resting.iter_mut().enumerate().take(view.contacts.len()) {
        match phase {
            Phase::Slip(_) | Phase::Transition(_) if can_hold(contact) => {
                if view.speed(state, contact).abs() > STILL {
                    return Phases::from(phases);
                }
                *phase = Phase::Stick;
            }
            _ => {}
        }
    }
    let gaps = view.evaluator.openings(|component| state[component]);
    let touching = openings
        .iter()
        .zip(&gaps)
        .filter(|(opening, at)| lies(at) && view.system().friction(opening.contact).limit == 0.0);
    for (opening, _) in touching.clone() {
        resting[opening.contact] = Phase::Apart;
    }
    let (_, forces) = view.evaluator.incremental_forces(state).forces_and_gaps(&resting);
    let without_force = &forces[forces.len() - openings.len()..];
    let is_determined = openings.iter().zip(without_force).any(|(opening, without)| {
        touching.clone().any(|(other, _)| other.contact == opening.contact)
            && without.opening_acceleration.abs() > STILL
    });
    if is_determined { Phases::from(phases) } else { resting }
}
