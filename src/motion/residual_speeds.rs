//! What is left of the speeds of bodies that touch or stick, to rounding or in the band: it is removed before their phases are
//! decided.

use smallvec::SmallVec;

use super::impulse_response::ImpactPlace;
use super::stick_slip::first_phases;
use super::touching_system::TouchingSystem;
use super::{Phase, Phases};
use crate::model::{Components, TOUCHING};

/// Bodies in touch that move more slowly than this, non-dimensional, rest: rounding is left of their speeds.
pub(crate) const STILL: f64 = 1e-12;
/// A sliding speed that depends on the velocities with a factor below this vanishes with the factor, as that of a crank at its dead
/// centre: no friction stops the velocities there.
pub(super) const VANISHES: f64 = 1e-6;
/// The least and the largest number of times that all speeds at rest are removed in turn.
const SWEEPS: (usize, usize) = (20, 200);
/// What is left of speeds at rest, non-dimensional, when they are no longer removed after the least number of times.
const LEFT: f64 = 1e-15;

/// Returns whether bodies that may separate touch, and do not move apart.
pub(crate) fn lies([gap, speed, _]: &[f64; 3]) -> bool {
    gap.abs() <= TOUCHING && speed.abs() <= STILL
}

impl TouchingSystem<'_> {
    /// Stops a contact, if its speed is a component.
    pub(super) fn stop(&self, contact: usize, state: &mut [f64]) {
        if let Some(speed) = self.speed_component(contact) {
            state[speed] = 0.0;
        }
    }

    /// Makes the speeds of contacts that touch equal, which differ by rounding: to that of the contact `failed`, if it is
    /// one of them.
    pub(super) fn join(&self, state: &mut Components, phases: &[Phase], failed: Option<usize>) {
        for cluster in self.evaluator.clusters(phases) {
            let leader = failed.filter(|contact| cluster.contains(contact)).unwrap_or(cluster[0]);
            let speed = state[self.speed_at_gap(leader)];
            for contact in cluster {
                state[self.speed_at_gap(contact)] = speed;
            }
        }
    }

    /// Closes the gaps whose contacts are at each other with equal speeds, such as two that have stopped there. Bodies that lie at
    /// each other without a force touch again, too: one of them may set off towards the other.
    ///
    /// An impact moves all contacts a little. Contacts that rest in touch separate by less than can be resolved, and stop
    /// again. Where one of them needs the force of the other, it would then fall on it over the width within which impacts
    /// are located, and this impact would separate others in the same way, without end.
    pub(super) fn close(&self, state: &[f64], phases: &mut Phases) {
        let at = self.evaluator.openings(|component| state[component]);
        let lie = |place: &usize| {
            phases[self.openings[*place].contact] == Phase::Apart && lies(&at[*place])
        };
        let that_lie: SmallVec<[usize; 4]> = (0..at.len()).filter(lie).collect();
        for place in that_lie {
            let contact = self.openings[place].contact;
            let friction = self.evaluator.system().friction(contact);
            let touching = std::iter::once((friction, at[place][2]));
            phases[contact] =
                first_phases(self.settings.method, self.settings.band, touching, &[Phase::Stick])
                    [0];
        }
        for (gap, phase) in self.gaps.iter().zip(&mut phases[self.contacts()..]) {
            let [behind, ahead] = gap.contacts.map(|contact| state[self.speed_at_gap(contact)]);
            if behind == ahead && self.width(gap, state) <= TOUCHING {
                *phase = Phase::Closed;
            }
        }
    }

    /// Removes what is left of opening speeds where bodies touch, and of sliding speeds where they stick, by impulses of the
    /// contacts, each in turn. The friction that sticking requires would contain what decays of these speeds, and no decision
    /// would meet all conditions within their slack.
    pub(super) fn bring_to_rest(&self, state: &mut Components, phases: &[Phase]) {
        let graph = self.evaluator.graph();
        let touching: SmallVec<[usize; 4]> = (0..self.openings.len())
            .filter(|opening| phases[self.openings[*opening].contact] != Phase::Apart)
            .collect();
        if touching.is_empty() {
            return;
        }
        let places: SmallVec<[ImpactPlace; 4]> =
            touching.iter().map(|opening| ImpactPlace::Opening(*opening)).collect();
        let responses = self.evaluator.responses(&state[..], &places);
        let mut speeds = self.evaluator.openings(|place| state[place]);
        for sweep in 1..=SWEEPS.1 {
            let mut largest: f64 = 0.0;
            for (opening, response) in touching.iter().zip(responses.chunks(2)) {
                let contact = self.openings[*opening].contact;
                let slides = phases[contact] != Phase::Stick;
                for (which, by) in response.iter().enumerate().take(if slides { 1 } else { 2 }) {
                    let answer = by.openings[*opening][which];
                    let left = speeds[*opening][1 + which];
                    if answer == 0.0 || left == 0.0 {
                        continue;
                    }
                    let impulse = -left / answer;
                    let change = by.components.iter().fold(0.0, |most: f64, by| most.max(by.abs()));
                    if which == 1 && VANISHES * (impulse * change).abs() > left.abs() {
                        continue;
                    }
                    largest = largest.max(left.abs());
                    for (value, by) in state.iter_mut().zip(&by.components) {
                        *value += impulse * by;
                    }
                    for (speeds, by) in speeds.iter_mut().zip(&by.openings) {
                        speeds[1] += impulse * by[0];
                        speeds[2] += impulse * by[1];
                    }
                }
                if !slides && graph.speed_component(contact).is_some() {
                    self.stop(contact, state);
                }
            }
            if sweep >= SWEEPS.0 && largest <= LEFT {
                break;
            }
        }
    }
}
