//! The equations of motion while all contacts keep their phases, with one variable for each independent component of the state.
//!
//! Contacts that stick hold components, bodies that touch move together, and translations that no equation notices go on: the
//! other components are the variables. Where their rates of change vanish, the system is in equilibrium or in steady motion.

use nalgebra::{DMatrix, DVector};

use super::{Evaluator, Phase, Phases};
use crate::model::Translations;

/// The equations of motion of the variables.
pub(crate) struct ReducedEquations<'e> {
    evaluator: &'e Evaluator,
    pub(crate) phases: Phases,
    /// The components that are the variables.
    pub(crate) variables: Vec<usize>,
    /// The translations that move no contact that sticks. Their pivots are no variables.
    pub(crate) translations: Translations,
    /// The components that move as another one does, each with this one.
    following: Vec<(usize, usize)>,
}

impl<'e> ReducedEquations<'e> {
    /// Returns the equations of contacts with these phases, of a system with these translations.
    pub(crate) fn new(
        evaluator: &'e Evaluator,
        phases: &[Phase],
        translations: &Translations,
    ) -> Self {
        let graph = evaluator.graph();
        let position = |contact: usize| graph.layout.contacts[contact].position;
        let following = evaluator.following(phases, None).concat();
        let stuck = (0..graph.contacts.len()).filter(|contact| phases[*contact] == Phase::Stick);
        let places = |contact: usize| [Some(position(contact)), graph.held_component(contact)];
        let held: Vec<usize> = stuck.flat_map(places).flatten().collect();
        let translations = translations.without(|place| held.contains(&place));
        let is_variable = |place: &usize| {
            let follows = following.iter().any(|(follower, _)| follower == place);
            !follows && !held.contains(place) && !translations.has_pivot(*place)
        };
        let variables = (0..graph.derivative.len()).filter(is_variable).collect();
        ReducedEquations { evaluator, phases: phases.into(), variables, translations, following }
    }

    /// Returns the rates of change of all components without translations.
    pub(crate) fn all_rates(&self, state: &[f64]) -> Vec<f64> {
        self.translations.all_remaining(&self.evaluator.rates(&self.phases, state))
    }

    /// Returns the rates of change of the variables.
    pub(crate) fn rates(&self, state: &[f64]) -> DVector<f64> {
        let rates = self.all_rates(state);
        DVector::from_iterator(self.variables.len(), self.variables.iter().map(|of| rates[*of]))
    }

    /// Returns the derivatives of these rates, one row each, with respect to the variables.
    pub(crate) fn slopes(&self, state: &[f64]) -> DMatrix<f64> {
        let (n, graph) = (self.variables.len(), self.evaluator.graph());
        let along = |variable: &usize| {
            let direction = |component: usize| {
                let leader = self.following.iter().find(|(follower, _)| *follower == component);
                let moves = leader.map_or(component, |(_, leader)| *leader) == *variable;
                if moves { 1.0 } else { 0.0 }
            };
            self.evaluator.values_along(&self.phases, state, direction)
        };
        let columns: Vec<_> = self.variables.iter().map(along).collect();
        DMatrix::from_fn(n, n, |row, column| {
            let slope = |place: usize| columns[column][graph.derivative[place] as usize].slope;
            self.translations.remaining(slope, self.variables[row])
        })
    }

    /// Adds a step of the variables to a state.
    pub(crate) fn displace(&self, state: &mut [f64], step: &DVector<f64>) {
        for (variable, step) in self.variables.iter().zip(step) {
            state[*variable] += step;
            let followers = self.following.iter().filter(|(_, leader)| leader == variable);
            followers.for_each(|(follower, _)| state[*follower] += step);
        }
    }
}
