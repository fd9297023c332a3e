//! The section of a running ball's passages through the angle 0, with coordinates on it.
//!
//! The coordinates are the free components (position and velocity of the table) and the variables
//! of the contacts that vary: not the angle of the ball that marks the section, the speed of a
//! contact that sticks there, or the position of a contact that rests throughout. Such a contact may
//! rest anywhere in an interval; each such position is a neutral direction of a continuous family of
//! cycles, with a multiplier of exactly 1. Contacts that touch move together, and count once.

use nalgebra::DVector;
use smallvec::{SmallVec, smallvec};

use super::system_view::SystemView;
use crate::model::{Components, wrap_to_pi};
use crate::motion::{Phase, Phases};

/// A section and the contacts' phases there.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// The contact whose passages mark it.
    pub(super) reference: usize,
    /// The phases of the contacts there.
    pub(super) phases: Phases,
    /// Which contacts rest throughout the orbit.
    pub(super) rests: SmallVec<[bool; 8]>,
    /// The component that is the position of the reference.
    place: usize,
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
        reference: usize,
        phases: &[Phase],
        rests: SmallVec<[bool; 8]>,
    ) -> Self {
        let mut followers = Vec::new();
        let following = view.followers(phases, Some(reference));
        for (follower, leader) in &following {
            let (follower, leader) = (view.contacts[*follower], view.contacts[*leader]);
            followers.push((follower.position, leader.position, true));
            if let (Some(follower), Some(leader)) = (follower.speed, leader.speed) {
                followers.push((follower, leader, false));
            }
        }
        let mut coordinates: Vec<_> = view.free.iter().map(|place| (*place, false)).collect();
        for (index, contact) in view.contacts.iter().enumerate() {
            if following.iter().any(|(follower, _)| *follower == index) {
                continue;
            }
            if phases[index] != Phase::Stick {
                coordinates.extend(contact.speed.map(|place| (place, false)));
            }
            if index != reference && !rests[index] {
                coordinates.push((contact.position, contact.angular));
            }
        }
        Section {
            reference,
            phases: phases.iter().copied().collect(),
            rests,
            place: view.contacts[reference].position,
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
    /// marking contact is at the angle 0.
    pub(super) fn state(&self, like: &[f64], coordinates: &DVector<f64>) -> Components {
        let mut state = Components::from_slice(like);
        for ((place, _), value) in self.coordinates.iter().zip(coordinates.iter()) {
            state[*place] = *value;
        }
        state[self.place] = 0.0;
        for (follower, leader, is_position) in &self.followers {
            let apart = if *is_position { like[*follower] - like[*leader] } else { 0.0 };
            state[*follower] = state[*leader] + apart;
        }
        state
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
        let late = displacement[self.place] / rate[self.place];
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
