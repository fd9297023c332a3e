//! The section that a contact marks, with coordinates on it.
//!
//! The beginning of a period of the forcing marks it, if the system is forced. Otherwise, a running ball marks it by its passages through the angle 0. A contact that no ring guides marks it where its position is
//! at a maximum.
//!
//! The coordinates are the free components (position and velocity of the table) and the variables
//! of the contacts that vary: not the component that marks the section, the speed of a
//! contact that sticks there, or the position of a contact that rests throughout. Such a contact may
//! rest anywhere in an interval; each such position is a neutral direction of a continuous family of
//! cycles, with a multiplier of exactly 1. Contacts that touch move together, and count once.

use nalgebra::DVector;
use smallvec::{SmallVec, smallvec};

use super::system_view::{ContactPlace, SystemView};
use crate::model::{Components, ForcingLayout, wrap_to_pi};
use crate::motion::{Direction, Motion, Phase, Phases};

/// What marks a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mark {
    /// A contact passes through the angle 0 in this direction. `may_stop` states whether it may stop or turn back on its way.
    Round { contact: usize, direction: f64, may_stop: bool },
    /// The position of a contact is at a maximum, where its sliding speed falls through this one.
    Maximum { contact: usize, speed: f64 },
    /// A period of the forcing begins.
    Period(ForcingLayout),
}

impl Mark {
    /// Returns the contact that marks the section, if it is one.
    pub(super) fn contact(self) -> Option<usize> {
        match self {
            Mark::Round { contact, .. } | Mark::Maximum { contact, .. } => Some(contact),
            Mark::Period(_) => None,
        }
    }

    /// Returns the component that marks the section, and its value there.
    pub(super) fn component(self, view: &SystemView) -> (usize, f64) {
        match self {
            Mark::Round { contact, .. } => (view.contacts[contact].position, 0.0),
            Mark::Maximum { contact, speed } => {
                let ContactPlace { position, speed: component, .. } = view.contacts[contact];
                component.map_or((position, 0.0), |component| (component, speed))
            }
            Mark::Period(forcing) => (forcing.component, 0.0),
        }
    }
}

/// Returns the value of the forcing's component at which the next period begins.
pub(super) fn next_period(forcing: ForcingLayout, state: &[f64]) -> f64 {
    forcing.period * ((state[forcing.component] / forcing.period).floor() + 1.0)
}

/// A section and the contacts' phases there.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// What marks it.
    pub(super) mark: Mark,
    /// The phases of the contacts there.
    pub(super) phases: Phases,
    /// Which contacts rest throughout the orbit.
    pub(super) rests: SmallVec<[bool; 8]>,
    /// The component that marks the section, and its value there.
    marking: (usize, f64),
    /// The components that are the coordinates, and whether they are angles.
    coordinates: Vec<(usize, bool)>,
    /// The components of the contacts that touch another one: position or speed, that of the contact that it follows, and
    /// whether it is a position.
    followers: Vec<(usize, usize, bool)>,
    /// Number of components of a state.
    dimension: usize,
}

impl Section {
    pub(super) fn new(
        view: &SystemView,
        mark: Mark,
        phases: &[Phase],
        rests: SmallVec<[bool; 8]>,
    ) -> Self {
        let mut followers = Vec::new();
        let marking = mark.component(view);
        let following = view.followers(phases, mark.contact());
        for (follower, leader) in &following {
            let (follower, leader) = (view.contacts[*follower], view.contacts[*leader]);
            followers.push((follower.position, leader.position, true));
            if let (Some(follower), Some(leader)) = (follower.speed, leader.speed) {
                followers.push((follower, leader, false));
            }
        }
        let free = view.free.iter().filter(|place| **place != marking.0);
        let mut coordinates: Vec<_> = free.map(|place| (*place, false)).collect();
        for (index, contact) in view.contacts.iter().enumerate() {
            if following.iter().any(|(follower, _)| *follower == index) {
                continue;
            }
            if phases[index] != Phase::Stick {
                let speed = contact.speed.filter(|speed| *speed != marking.0);
                coordinates.extend(speed.map(|place| (place, false)));
            }
            let counts = contact.position != marking.0 && !contact.ignorable;
            if counts && !rests[index] {
                coordinates.push((contact.position, contact.angular));
            }
        }
        Section {
            mark,
            phases: phases.iter().copied().collect(),
            rests,
            marking,
            coordinates,
            followers,
            dimension: view.dimension(),
        }
    }

    /// The coordinates of a state, or of a displacement.
    pub(super) fn coordinates(&self, state: &[f64]) -> DVector<f64> {
        let values = self.coordinates.iter().map(|(place, _)| state[*place]);
        DVector::from_iterator(self.coordinates.len(), values)
    }

    /// Returns the state with these coordinates; the other variables are those of `like`, and the
    /// marking component has its value.
    pub(super) fn state(&self, like: &[f64], coordinates: &DVector<f64>) -> Components {
        let mut state = Components::from_slice(like);
        for ((place, _), value) in self.coordinates.iter().zip(coordinates.iter()) {
            state[*place] = *value;
        }
        self.put_on(&mut state);
        for (follower, leader, is_position) in &self.followers {
            let apart = if *is_position { like[*follower] - like[*leader] } else { 0.0 };
            state[*follower] = state[*leader] + apart;
        }
        state
    }

    /// Gives the marking component its value.
    pub(super) fn put_on(&self, state: &mut [f64]) {
        let (component, value) = self.marking;
        state[component] = value;
    }

    /// Returns whether contacts may have these phases in a motion that comes back. Contacts that rest must stick. A contact that
    /// marks the section may be in the band only if it may stop.
    pub(super) fn allows(&self, phases: &[Phase]) -> bool {
        let mut rests = self.rests.iter().zip(phases);
        let stops = match self.mark {
            Mark::Round { contact, may_stop: false, .. } => phases[contact].in_band(),
            Mark::Round { .. } | Mark::Maximum { .. } | Mark::Period(_) => false,
        };
        !stops && rests.all(|(rests, phase)| !rests || *phase == Phase::Stick)
    }

    /// Returns time and state of a passage through the section in the latest step of a motion.
    pub(super) fn passage(&self, motion: &Motion) -> Option<(f64, Components)> {
        let (component, value) = self.marking;
        match self.mark {
            Mark::Round { contact, direction, .. } => motion
                .passage(contact)
                .filter(|(_, state)| direction * motion.evaluator().speeds(state)[contact] > 0.0),
            Mark::Maximum { .. } => motion.falls_through_zero(|state| state[component] - value),
            Mark::Period(forcing) => {
                let begun = motion.within_last_step(motion.last_step_began())?;
                let next = next_period(forcing, &begun);
                let (time, mut state) =
                    motion.falls_through_zero(|state| next - state[component])?;
                self.put_on(&mut state);
                Some((time, state))
            }
        }
    }

    /// Returns the number of contacts at whose other positions the motion would also repeat: contacts that rest, and contacts
    /// whose positions occur in no equation.
    pub(super) fn neutral_directions(&self, view: &SystemView) -> usize {
        let contacts = view.contacts.iter().zip(&self.rests);
        contacts.filter(|(contact, rests)| **rests || contact.ignorable).count()
    }

    /// Unit displacements along the coordinates.
    pub(super) fn directions(&self) -> Vec<Components> {
        let unit = |(place, _): &(usize, bool)| {
            let mut direction: Components = smallvec![0.0; self.dimension];
            direction[*place] = 1.0;
            for (follower, leader, _) in &self.followers {
                direction[*follower] = direction[*leader];
            }
            direction
        };
        self.coordinates.iter().map(unit).collect()
    }

    /// Returns the projection on the section of a displacement of the motion, in a state with this
    /// time derivative: neighbours reach the section slightly earlier or later.
    pub(super) fn on_section(&self, displacement: &[f64], rate: &[f64]) -> DVector<f64> {
        let (component, _) = self.marking;
        let late = displacement[component] / rate[component];
        self.coordinates(displacement) + self.coordinates(rate) * -late
    }

    /// The difference of two states' coordinates, angles modulo 2π.
    pub(super) fn difference(&self, one: &[f64], other: &[f64]) -> DVector<f64> {
        let mut difference = self.coordinates(one) - self.coordinates(other);
        for ((_, angular), value) in self.coordinates.iter().zip(difference.iter_mut()) {
            if *angular {
                *value = wrap_to_pi(*value);
            }
        }
        difference
    }
}

/// Returns what marks the section of a system if no contact that goes round does: the periods of its forcing, or the maxima of
/// positions of a system without such contacts.
pub(super) fn marks(view: &SystemView) -> Vec<Mark> {
    match view.evaluator.graph().layout.forcing {
        Some(forcing) => vec![Mark::Period(forcing)],
        None if view.revolves() => Vec::new(),
        None => maxima(view),
    }
}

/// Returns the marks at the maxima of positions. The contact must slip there: the speed of its position differs from its
/// sliding speed, always by the same amount, as on a belt.
fn maxima(view: &SystemView) -> Vec<Mark> {
    let phases = Phases::from_elem(Phase::Slip(Direction::Forward), view.contacts.len());
    let gaps = view.evaluator.graph().gaps.len();
    let phases: Phases = phases.into_iter().chain((0..gaps).map(|_| Phase::Open)).collect();
    let probe = |scale: f64| -> Vec<f64> {
        (0..view.dimension()).map(|component| scale * (0.3 + 0.07 * component as f64)).collect()
    };
    let mark = |(contact, place): (usize, &ContactPlace)| {
        let component = place.speed?;
        let [one, other] = [1.0, -0.5].map(|scale| {
            let state = probe(scale);
            state[component] - view.evaluator.rates(&phases, &state)[place.position]
        });
        let same = (one - other).abs() <= 1e-12 * one.abs();
        (same && one != 0.0).then_some(Mark::Maximum { contact, speed: one })
    };
    view.contacts.iter().enumerate().filter_map(mark).collect()
}
