//! The steady states of a system of one's own: where friction holds its contacts, where all of them slide steadily, and its
//! equilibria without dry friction.
//!
//! Start positions at which nothing moves are examined, with the coordinates that no friction holds where the forces on them
//! vanish (Newton's method). If the equations contain only differences of positions, steady motion at a constant speed is sought from
//! the start states, too.

use serde::Serialize;

use super::steady_state::{SAME, SteadyState, SteadyValues};
use crate::model::{Model, Start, Translations, Units};
use crate::motion::Evaluator;

/// The number of start states from which steady states are sought.
const EXAMINED: usize = 400;

/// The search for the steady states of a model in the ranges of its start states.
pub struct SteadySearch<'m> {
    pub(super) model: &'m Model,
    pub(super) units: Units,
    ranges: &'m [[f64; 2]],
    evaluator: Evaluator,
    translations: Translations,
}

/// A start position, with the coordinates that no friction holds where the forces on them vanish.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldPosition {
    /// The coordinates in the order of the outputs of the model, in SI units; angles are within one turn.
    pub coordinates: Vec<f64>,
    /// The smallest unused fraction of the friction limit of a contact that sticks; negative if a contact needs more. `None` if the
    /// coordinates that no friction holds have no equilibrium, if a contact is not pressed together, or without a limit.
    pub friction_margin: Option<f64>,
}

impl HeldPosition {
    /// Returns whether friction holds all contacts that do not slide.
    pub fn is_held(&self) -> bool {
        self.friction_margin.is_some_and(|margin| margin >= 0.0)
    }
}

/// The steady states of a model.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SteadyStates {
    /// The fraction of the start positions, with all speeds zero, at which friction holds all contacts that do not slide; `None`
    /// if all contacts slide there.
    pub held_fraction: Option<f64>,
    /// The states in which all contacts slide and no coordinate moves, or coordinates move on at constant speeds.
    pub sliding: Vec<SteadyValues>,
}

impl SteadyStates {
    /// Finds the steady states of a model in the ranges of its start states; `None` for a model that [`SteadySearch`] does not serve.
    pub fn of(model: &Model, ranges: &[[f64; 2]]) -> Option<Self> {
        let search = SteadySearch::new(model, ranges).ok()?;
        let (mut held, mut may_hold) = (0, false);
        for number in 0..EXAMINED {
            if let Some(position) = search.position(|place| sample(number, place)) {
                may_hold = true;
                held += usize::from(position.is_held());
            }
        }
        Some(SteadyStates {
            held_fraction: may_hold.then(|| held as f64 / EXAMINED as f64),
            sliding: search.sliding(),
        })
    }
}

impl<'m> SteadySearch<'m> {
    /// Prepares the search.
    ///
    /// # Errors
    /// What the equations have that the search does not serve, in words.
    pub fn new(model: &'m Model, ranges: &'m [[f64; 2]]) -> Result<Self, &'static str> {
        let system = model.system().filter(|_| model.ball_balancer().is_none());
        let evaluator = Evaluator::new(system.ok_or("no recorded equations")?);
        let graph = evaluator.graph();
        if !graph.openings.is_empty() {
            return Err("contacts that open");
        }
        if !graph.events.is_empty() {
            return Err("events");
        }
        if graph.layout.forcing.is_some() {
            return Err("forces that repeat in time");
        }
        let translations = evaluator.translations();
        let search = SteadySearch { model, units: model.units(), ranges, evaluator, translations };
        let first = search.start(|place| sample(0, place), false).map(|state| search.steady(state));
        match first {
            Some(Some(_)) => Ok(search),
            _ => Err(
                "forces that change with the time, or a contact whose sliding speed depends on several coordinates",
            ),
        }
    }

    /// Returns a start position, which is given from 0 to 1 in the range of each coordinate; `None` if all contacts slide there.
    pub fn position(&self, place: impl Fn(usize) -> f64) -> Option<HeldPosition> {
        let mut state = self.steady(self.start(place, false)?)?;
        if !state.sticks() {
            return None;
        }
        let settles = state.settles();
        Some(HeldPosition {
            coordinates: state.coordinates(&self.units),
            friction_margin: if settles { state.friction_margin() } else { None },
        })
    }

    /// Returns the states in which all contacts slide and no coordinate moves, or coordinates move on at constant speeds.
    pub fn sliding(&self) -> Vec<SteadyValues> {
        if self.evaluator.graph().contacts.is_empty() {
            return Vec::new();
        }
        let goes_on = self.translations != Translations::default();
        let from = |number: usize| {
            let still = self.start(|place| sample(number, place), false);
            let moving = goes_on.then(|| self.moving(number)).flatten();
            let both = still.into_iter().chain(moving);
            both.filter_map(|state| self.steady(state)).filter(|state| !state.sticks())
        };
        self.different((0..EXAMINED).flat_map(from))
    }

    /// Returns the equilibria of the same system without dry friction.
    pub fn without_dry_friction(&self) -> Vec<SteadyValues> {
        let from = |number: usize| {
            let state = self.start(|place| sample(number, place), false)?;
            SteadyState::without_dry_friction(&self.evaluator, &self.translations, state)
        };
        self.different((0..EXAMINED).filter_map(from))
    }

    /// Returns the different states that these ones settle in.
    fn different<'e>(&self, from: impl Iterator<Item = SteadyState<'e>>) -> Vec<SteadyValues> {
        let (mut found, mut places) = (Vec::new(), Vec::<Vec<f64>>::new());
        for mut examined in from {
            if !examined.settles() || !examined.holds() {
                continue;
            }
            let Some((values, place)) = examined.values(self.model, &self.units) else { continue };
            let is_known = |known: &Vec<f64>| {
                let near = |(left, right): (&f64, &f64)| (left - right).abs() < SAME;
                known.len() == place.len() && known.iter().zip(&place).all(near)
            };
            if !places.iter().any(is_known) {
                found.push(values);
                places.push(place);
            }
        }
        found
    }

    fn steady(&self, state: Vec<f64>) -> Option<SteadyState<'_>> {
        SteadyState::new(&self.evaluator, &self.translations, state)
    }

    /// Returns a start state, given from 0 to 1 in its ranges, and with all speeds zero unless it moves.
    fn start(&self, place: impl Fn(usize) -> f64, moves: bool) -> Option<Vec<f64>> {
        let within = |(number, [low, high]): (usize, &[f64; 2])| {
            let is_sampled = moves || 2 * number < self.ranges.len();
            if is_sampled { low + (high - low) * place(number) } else { 0.0 }
        };
        let start = self.ranges.iter().enumerate().map(within).collect();
        self.model.start_state(&Start(start)).ok().map(|state| state.to_vec())
    }

    /// Returns a start state that moves; half of these states have any velocities.
    fn moving(&self, number: usize) -> Option<Vec<f64>> {
        let mut state = self.start(|place| sample(number, place), true)?;
        let at_rest = |range: &[f64; 2]| *range == [0.0; 2];
        if number % 2 == 1 || self.ranges[self.ranges.len() / 2..].iter().all(at_rest) {
            for component in self.evaluator.graph().layout.velocities.iter().flatten() {
                state[*component] = 2.0 * sample(number, *component) - 1.0;
            }
        }
        Some(state)
    }
}

/// Returns a coordinate of a point of a sequence that fills the unit cube evenly: multiples of square roots of primes (Weyl).
fn sample(number: usize, dimension: usize) -> f64 {
    let is_prime = |value: &u32| (2..*value).all(|divisor| !value.is_multiple_of(divisor));
    let prime = (2..).filter(is_prime).nth(dimension).map_or(2.0, f64::from);
    ((number as f64 + 0.5) * prime.sqrt()).fract()
}
