//! Bodies that rest in touch: the force between them is not determined, and they rest if friction holds them for any such force.

use super::system_view::SystemView;
use crate::motion::{Direction, Forces, Phase, Phases, STILL, lies};

/// Bodies at rest have at most this acceleration, non-dimensional, by rounding.
const RESTS: f64 = 1e-9;
/// The largest force between bodies that rest in touch, over that with which one of them is at the limit of its friction, and its
/// accuracy.
const MOST_FORCE: f64 = 1e3;
const FORCE_ACCURACY: f64 = 1e-12;

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

/// Returns the forces at rest where bodies that touch press each other so that the friction of one of them is at its limit; `None`
/// if no bodies touch without a determined force.
fn pressed(view: &SystemView, resting: &[Phase], state: &[f64]) -> Option<Forces> {
    let openings = &view.evaluator.graph().openings;
    let gaps = view.evaluator.openings(|component| state[component]);
    let mut equations = view.evaluator.incremental_forces(state);
    for (place, (opening, at)) in openings.iter().zip(&gaps).enumerate() {
        if resting[opening.contact] != Phase::Apart || !lies(at) {
            continue;
        }
        let sticking = (0..view.contacts.len()).filter(|contact| resting[*contact] == Phase::Stick);
        let directions = [Direction::Forward, Direction::Backward].map(Phase::Slip);
        for (contact, slip) in sticking.flat_map(|contact| directions.map(|slip| (contact, slip))) {
            let mut phases = Phases::from(resting);
            (phases[opening.contact], phases[contact]) = (Phase::Free, slip);
            let (forces, gaps) = equations.forces_and_gaps(&phases);
            let force = gaps[gaps.len() - openings.len() + place].force;
            // Another body than those that touch would slip.
            let rests = forces.iter().all(|contact| contact.acceleration.abs() <= RESTS);
            if force.is_finite() && force > 0.0 && rests {
                return Some(forces);
            }
        }
    }
    None
}

/// Returns the least part of its friction that a contact that sticks has in reserve; `None` if no contact sticks. Of bodies that
/// rest in touch, it is the largest one for any force between them.
pub(super) fn friction_margin(view: &SystemView, phases: &[Phase], state: &[f64]) -> Option<f64> {
    let resting = at_rest(view, phases, state);
    let without = view.evaluator.forces(&resting, state);
    let with = pressed(view, &resting, state);
    // The force between bodies that touch, over that with which one of them is at the limit of its friction.
    let at = |force: f64| {
        let margin = |(contact, phase): (usize, &Phase)| {
            let from = &without[contact];
            let to = with.as_ref().map_or(from, |with| &with[contact]);
            let between = |from: f64, to: f64| from + force * (to - from);
            let limit = view.system().friction(contact).limit * between(from.normal, to.normal);
            let needed = between(from.friction, to.friction).abs();
            let margin = if limit > 0.0 { 1.0 - needed / limit } else { f64::NEG_INFINITY };
            (*phase == Phase::Stick).then_some(margin)
        };
        let contacts = resting.iter().enumerate().take(view.contacts.len());
        contacts.filter_map(margin).reduce(f64::min)
    };
    let [mut low, mut high] = [0.0, if with.is_some() { MOST_FORCE } else { 0.0 }];
    while high - low > FORCE_ACCURACY * high.max(1.0) {
        let [lower, upper] = [2.0 * low + high, low + 2.0 * high].map(|sum| sum / 3.0);
        if at(lower)? < at(upper)? { low = lower } else { high = upper }
    }
    at(low)
}
