//! Translations that no equation notices, such as the turn of a whole drill string, whose equations contain only differences of angles.
//!
//! From the translated state, a motion is the same motion translated: only what remains of the coordinates needs to return for a motion
//! to repeat (J. E. Marsden, T. S. Ratiu, *Introduction to Mechanics and Symmetry*, 2nd ed., Springer 1999,
//! doi:10.1007/978-0-387-21792-5). The time may be displaced, too: in `k (v t - x)`, it and the position grow together.

use crate::model::Components;

/// A sum below this part of its first summand is rounding.
const ROUNDING: f64 = 1e-12;

/// A value that changes by more than this along a translation by 1 is not constant, but for rounding.
const CHANGED: f64 = 1e-9;

/// A translation of states.
#[derive(Clone, Debug, PartialEq)]
pub struct Translation {
    /// The component that is displaced by 1.
    pub pivot: usize,
    /// The other components that are displaced, and by how much.
    pub others: Vec<(usize, f64)>,
}

impl Translation {
    /// Returns by how much it displaces a component.
    pub fn of(&self, component: usize) -> f64 {
        let other = self.others.iter().find(|(place, _)| *place == component);
        if self.pivot == component { 1.0 } else { other.map_or(0.0, |(_, by)| *by) }
    }

    /// Returns the components that it displaces.
    fn components(&self) -> impl Iterator<Item = usize> {
        std::iter::once(self.pivot).chain(self.others.iter().map(|(component, _)| *component))
    }

    /// Adds a multiple of another translation, so that a component is not displaced.
    fn compensate(&mut self, component: usize, other: &Translation) {
        let factor = -self.of(component) / other.of(component);
        let places: Vec<usize> = self.components().chain(other.components()).collect();
        let displaced = places.into_iter().filter(|place| ![component, self.pivot].contains(place));
        let mut others: Vec<_> =
            displaced.map(|place| (place, sum(self.of(place), factor * other.of(place)))).collect();
        others.sort_by_key(|(place, _)| *place);
        others.dedup_by_key(|(place, _)| *place);
        others.retain(|(_, by)| *by != 0.0);
        self.others = others;
    }
}

/// Independent translations. None of them displaces the pivot of another one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Translations(pub Vec<Translation>);

impl Translations {
    /// Returns those that displace none of some components, also as sums of several.
    pub fn without(&self, held: impl Fn(usize) -> bool) -> Self {
        let mut left = self.0.clone();
        while let Some(component) =
            left.iter().find_map(|one| one.components().find(|of| held(*of)))
        {
            // One translation that displaces the component compensates the others, and is lost.
            let by = |one: &Translation| one.of(component).abs();
            let largest = (0..left.len()).max_by(|a, b| by(&left[*a]).total_cmp(&by(&left[*b])));
            let Some(lost) = largest.map(|place| left.remove(place)) else { break };
            left.iter_mut().for_each(|one| one.compensate(component, &lost));
        }
        Translations(left)
    }

    /// Returns the pivots.
    pub fn pivots(&self) -> impl Iterator<Item = usize> {
        self.0.iter().map(|one| one.pivot)
    }

    /// Returns whether a component is a pivot.
    pub fn has_pivot(&self, component: usize) -> bool {
        self.pivots().any(|pivot| pivot == component)
    }

    /// Returns the pivots of the translations that displace a component, and by how much; a pivot displaces itself by 1.
    pub fn carriers(&self, component: usize) -> impl Iterator<Item = (usize, f64)> {
        let each = self.0.iter().map(move |one| (one.pivot, one.of(component)));
        each.filter(|(_, by)| *by != 0.0)
    }

    /// Returns whether they displace a component.
    pub fn displace(&self, component: usize) -> bool {
        self.carriers(component).next().is_some()
    }

    /// Returns what remains of a component without its displacement, if the pivots are displaced as in a state or in its rates: it
    /// returns in a motion that repeats. Nothing remains of a pivot.
    pub fn remaining(&self, state: impl Fn(usize) -> f64, component: usize) -> f64 {
        // Most systems have none.
        if self.0.is_empty() {
            return state(component);
        }
        let carried = self.carriers(component).map(|(pivot, by)| by * state(pivot));
        state(component) - carried.sum::<f64>()
    }

    /// Returns which of the values that a function has in a state change along the translations.
    pub fn changed(&self, state: &[f64], values: impl Fn(&[f64]) -> Components) -> Vec<bool> {
        let along = |one: &Translation| {
            let places = state.iter().enumerate();
            values(&places.map(|(place, value)| value + one.of(place)).collect::<Components>())
        };
        let (now, along): (_, Vec<Components>) =
            (values(state), self.0.iter().map(along).collect());
        let changes =
            |number: usize| along.iter().any(|of| (of[number] - now[number]).abs() > CHANGED);
        (0..now.len()).map(changes).collect()
    }

    /// Returns what remains of all components.
    pub fn all_remaining<C: FromIterator<f64>>(&self, state: &[f64]) -> C {
        (0..state.len()).map(|component| self.remaining(|place| state[place], component)).collect()
    }
}

/// Returns a sum, or 0 if the summands differ by rounding alone.
pub(super) fn sum(a: f64, b: f64) -> f64 {
    if (a + b).abs() <= ROUNDING * a.abs() { 0.0 } else { a + b }
}
