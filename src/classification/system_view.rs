//! A system with its recorded equations and the places of its coordinates in a state.

use std::sync::Arc;

use super::derived_rest::DerivedRest;
use crate::model::{Components, RestForms, System, Translations, wrap_to_two_pi};
use crate::motion::{Evaluator, PerContact, Phase};

/// A system as the classification sees it.
#[derive(Clone, Debug)]
pub(super) struct SystemView {
    pub(super) evaluator: Evaluator,
    /// The components that belong to no contact, in their order.
    pub(super) free: Vec<usize>,
    /// Those of them that are angles with a period of one turn.
    angles: Vec<usize>,
    /// The translations that no equation notices.
    pub(super) translations: Translations,
    /// The components of the contacts.
    pub(super) contacts: Vec<ContactPlace>,
    /// What returns in a motion that repeats.
    pub(super) returning: Vec<Returning>,
    /// The displacement whose amplitude is measured, and its velocity, if the system has one.
    pub(super) vibration: Option<[usize; 4]>,
    /// Whether the system has outputs.
    pub(super) has_outputs: bool,
    /// The closed forms at rest of a system that has none of its own.
    derived: Option<Arc<DerivedRest>>,
}

/// The components of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactPlace {
    /// The component that is its position.
    pub(super) position: usize,
    /// The component that is its sliding speed, if that is one component.
    pub(super) speed: Option<usize>,
    /// The component that the phase of the forcing determines while it sticks, if its sliding speed is no component.
    pub(super) driven: Option<usize>,
    /// Whether the position is an angle.
    pub(super) angular: bool,
}

/// A component of the state that returns in a motion that repeats.
#[derive(Clone, Copy, Debug)]
pub(super) struct Returning {
    pub(super) place: usize,
    /// Whether it is an angle with a period of one turn.
    pub(super) is_angle: bool,
    /// The contact whose sliding speed it is. While a contact sticks, its residual speed does not count.
    pub(super) speed_of: Option<usize>,
}

impl ContactPlace {
    /// Returns whether it keeps its position on its support while it sticks, wherever that is.
    pub(super) fn holds(&self) -> bool {
        self.speed.or(self.driven).is_some()
    }
}

impl SystemView {
    pub(super) fn new(evaluator: Evaluator) -> Self {
        let graph = evaluator.graph();
        let layout = &graph.layout;
        let translations = evaluator.translations();
        let place = |(contact, layout): (usize, &crate::model::ContactLayout)| ContactPlace {
            position: layout.position,
            speed: graph.speed_component(contact),
            driven: graph.driven_component(contact),
            angular: layout.angular,
        };
        let contacts: Vec<_> = layout.contacts.iter().enumerate().map(place).collect();
        let is_free = |component: &usize| {
            let has = |place: &ContactPlace| {
                place.position == *component || place.speed == Some(*component)
            };
            !contacts.iter().any(has)
        };
        let free: Vec<usize> = (0..graph.derivative.len()).filter(is_free).collect();
        let angles = layout.angles.clone();
        let of_contact = |(contact, place): (usize, &ContactPlace)| {
            let position = (place.position, place.angular, None);
            std::iter::once(position).chain(place.speed.map(|speed| (speed, false, Some(contact))))
        };
        let all = (contacts.iter().enumerate().flat_map(of_contact))
            .chain(free.iter().map(|place| (*place, angles.contains(place), None)));
        let returning = all.filter(|(place, ..)| !translations.has_pivot(*place));
        let returning = returning
            .map(|(place, is_angle, speed_of)| Returning { place, is_angle, speed_of })
            .collect();
        let velocity = layout.velocities.first();
        let vibration = layout
            .vibration
            .zip(velocity)
            .and_then(|([x, y], velocity)| Some([x, y, *velocity.first()?, *velocity.get(1)?]));
        let any = vec![0.0; graph.derivative.len()];
        let has_outputs = !evaluator.system().outputs(&any).is_empty();
        let mut view = SystemView {
            free,
            angles,
            translations,
            contacts,
            returning,
            vibration,
            evaluator,
            has_outputs,
            derived: None,
        };
        // Without contacts, motions decay and nothing comes to rest at an instant.
        if view.system().rest_forms().is_none() && !view.contacts.is_empty() {
            view.derived = DerivedRest::of(&view.evaluator, &view.free).map(Arc::new);
        }
        view
    }

    /// Returns the closed forms with all contacts at rest: those of the system, or those that follow from its equations.
    pub(super) fn rest_forms(&self) -> Option<&dyn RestForms> {
        let derived = || Some(self.derived.as_deref()? as &dyn RestForms);
        self.system().rest_forms().or_else(derived)
    }

    /// Returns the system.
    pub(super) fn system(&self) -> &dyn System {
        self.evaluator.system().as_ref()
    }

    /// Returns the number of components of a state.
    pub(super) fn dimension(&self) -> usize {
        self.evaluator.graph().derivative.len()
    }

    /// Returns whether a contact revolves on a ring, as a ball does.
    pub(super) fn revolves(&self) -> bool {
        self.contacts.iter().any(|contact| contact.angular)
    }

    /// Returns the angles that mark sections by their passages through 1 rad: all, if one of them belongs to no contact, or to a contact
    /// whose sliding speed is no component. Such a speed may vanish at some angles, as that of a piston at its dead centres.
    pub(super) fn marking_angles(&self) -> Vec<usize> {
        let angular = self.contacts.iter().filter(|contact| contact.angular);
        let have_speeds = angular.clone().all(|contact| contact.speed.is_some());
        // An angle with which other components may be translated is no phase of the motion.
        let turns = |place: usize| {
            let all = self.translations.0.iter().filter(|one| one.of(place) != 0.0);
            all.map(|one| one.others.len()).max().unwrap_or_default() > 0
        };
        let free: Vec<usize> = self.angles.iter().copied().filter(|place| !turns(*place)).collect();
        if free.is_empty() && have_speeds {
            return Vec::new();
        }
        let mut all: Vec<_> = angular.map(|contact| contact.position).collect();
        all.extend(free);
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Returns whether a component without contact is an angle.
    pub(super) fn is_angle(&self, component: usize) -> bool {
        self.angles.contains(&component)
    }

    /// Returns whether a contact may move on and on: it revolves, or a translation that no equation notices displaces it.
    pub(super) fn moves_on(&self) -> bool {
        let moves_on = |contact: &ContactPlace| {
            contact.angular || self.translations.displace(contact.position)
        };
        self.contacts.iter().any(moves_on)
    }

    /// Returns the rates of change without those of translations.
    pub(super) fn remaining_rates(&self, phases: &[Phase], state: &[f64]) -> Components {
        self.translations.all_remaining(&self.evaluator.rates(phases, state))
    }

    /// Makes a perturbation one in which contacts that touch move together.
    pub(super) fn keep_together(&self, phases: &[Phase], perturbation: &mut [f64]) {
        for (follower, leader) in self.evaluator.following(phases, None).concat() {
            perturbation[follower] = perturbation[leader];
        }
    }

    /// Returns the positions of the contacts in a state.
    pub(super) fn positions(&self, state: &[f64]) -> PerContact {
        self.contacts.iter().map(|contact| state[contact.position]).collect()
    }

    /// Returns the positions of the contacts in a state, angles in [0, 2π).
    pub(super) fn wrapped(&self, state: &[f64]) -> PerContact {
        let wrapped = |contact: &ContactPlace| {
            let position = state[contact.position];
            if contact.angular { wrap_to_two_pi(position) } else { position }
        };
        self.contacts.iter().map(wrapped).collect()
    }

    /// Returns the positions of the contacts, angles with whole turns.
    pub(super) fn unwrapped(&self, state: &[f64], turns: &[f64]) -> PerContact {
        let contacts = self.contacts.iter().zip(turns);
        let unwrapped = |(contact, turns): (&ContactPlace, &f64)| {
            let position = state[contact.position];
            if contact.angular { position + turns * std::f64::consts::TAU } else { position }
        };
        contacts.map(unwrapped).collect()
    }

    /// Returns the sliding speed of a contact.
    pub(super) fn speed(&self, state: &[f64], contact: usize) -> f64 {
        match self.contacts[contact].speed {
            Some(component) => state[component],
            None => self.evaluator.speeds(state)[contact],
        }
    }

    /// Returns the direction in which a contact has completed a turn in a step; `None` if the contact has completed none.
    /// `state` is the state at the end of the step. Its angles are not yet reduced to one turn.
    pub(super) fn completes_turn(&self, state: &[f64], contact: usize) -> Option<f64> {
        let place = self.contacts[contact];
        let angle = state[place.position];
        let completes = place.angular && !(0.0..std::f64::consts::TAU).contains(&angle);
        completes.then_some(if angle < 0.0 { -1.0 } else { 1.0 })
    }

    /// Returns the rate of change of the sliding speed of a contact.
    pub(super) fn acceleration(&self, phases: &[Phase], state: &[f64], contact: usize) -> f64 {
        match self.contacts[contact].speed {
            Some(component) => self.evaluator.rates(phases, state)[component],
            None => self.evaluator.forces(phases, state)[contact].acceleration,
        }
    }

    /// Adds whole turns to the angles of the contacts, once to an angle that several contacts share.
    pub(super) fn turn(&self, state: &mut [f64], turned: &[f64]) {
        for (contact, (place, turned)) in self.contacts.iter().zip(turned).enumerate() {
            let is_place = |other: &ContactPlace| other.position == place.position;
            if !self.contacts[..contact].iter().any(is_place) {
                state[place.position] += turned;
            }
        }
    }

    /// Returns the outputs in a state with these positions of the contacts, in which angles have whole turns.
    pub(super) fn outputs(&self, state: &[f64], unwrapped: &[f64]) -> Components {
        let mut state = Components::from(state);
        for (contact, position) in self.contacts.iter().zip(unwrapped) {
            state[contact.position] = *position;
        }
        self.system().outputs(&state)
    }

    /// Returns the square of the displacement whose amplitude is measured; 0 without one.
    pub(super) fn square(&self, state: &[f64]) -> f64 {
        self.vibration.map_or(0.0, |[x, y, ..]| state[x] * state[x] + state[y] * state[y])
    }

    /// Returns half of the rate of change of the square.
    pub(super) fn outward(&self, state: &[f64]) -> f64 {
        self.vibration
            .map_or(0.0, |[x, y, x_dot, y_dot]| state[x] * state[x_dot] + state[y] * state[y_dot])
    }
}
