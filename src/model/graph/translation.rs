//! Translations that no equation notices, such as the turn of a whole drill string, whose equations contain only differences of angles.
//!
//! From the translated state, a motion is the same motion translated: only the remaining coordinates need to return for a motion to
//! repeat (J. E. Marsden, T. S. Ratiu, *Introduction to Mechanics and Symmetry*, 2nd ed., Springer 1999,
//! doi:10.1007/978-0-387-21792-5). The time belongs to them: in `k (v t - x)`, it and the position may grow together.
//!
//! Each node is a linear function of the state with constant coefficients, beside a function that is the same in translated states.
//! This holds if the linear functions that are operands of a product, a sine or another function, and those of the equations
//! themselves, are the same in translated states. The directions in which all of these are constant are the translations.

use super::{ContactLayout, Graph, Node, NodeId};

/// Coefficients below this one, over the largest one of a linear function, are rounding.
const ROUNDING: f64 = 1e-9;
/// The least coefficient by which a linear function is solved for a preferred component, over the largest one.
const PIVOT: f64 = 1e-3;

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
        let mut others = self.others.iter().filter(|(place, _)| *place == component);
        if self.pivot == component { 1.0 } else { others.next().map_or(0.0, |(_, by)| *by) }
    }

    /// Returns whether it displaces a component.
    pub fn displaces(&self, component: usize) -> bool {
        self.of(component) != 0.0
    }
}

/// Coefficients of a linear function of the state; empty if all are 0.
type Linear = Vec<f64>;

impl Graph {
    /// Returns independent translations that no equation notices, at these values of the inputs. No pivot is displaced by another
    /// translation, and a pivot is the position of a contact only if no other component could be one.
    pub(super) fn find_translations(&self, inputs: &[f64]) -> Vec<Translation> {
        let n = self.derivative.len();
        let mut constraints = Constraints { rows: Vec::new(), preference: self.preference() };
        let linear = self.linear_functions(inputs, &mut constraints);
        for node in self.equations() {
            constraints.add(&linear[node as usize]);
        }
        // An event that gives a component a value must give it the translated value.
        for (component, value) in self.events.iter().flat_map(|event| &event.reset) {
            let mut row = linear[*value as usize].clone();
            row.resize(n, 0.0);
            row[*component] -= 1.0;
            constraints.add(&row);
        }
        let is_pivot = |place: &usize| {
            let is_angle = |contact: &ContactLayout| contact.angular && contact.position == *place;
            !constraints.rows.iter().any(|(solved, _)| solved == place)
                && !self.layout.contacts.iter().any(is_angle)
        };
        let along = |pivot: usize| {
            let others = constraints.rows.iter().map(|(place, row)| (*place, -row[pivot]));
            Translation { pivot, others: others.filter(|(_, by)| by.abs() > ROUNDING).collect() }
        };
        let forcing = self.layout.forcing.map(|forcing| forcing.component);
        let moves_phase = |translation: &Translation| {
            let mut moved = translation.others.iter().map(|(place, _)| *place);
            Some(translation.pivot) == forcing || moved.any(|place| Some(place) == forcing)
        };
        let translations = (0..n).filter(is_pivot).map(along);
        translations.filter(|translation| !moves_phase(translation)).collect()
    }

    /// Returns the components in the order in which linear functions are solved for them.
    fn preference(&self) -> Vec<usize> {
        let layout = &self.layout;
        let rank = |place: &usize| {
            let mut contacts = layout.contacts.iter();
            match contacts.find(|contact| contact.position == *place) {
                Some(contact) if contact.angular => 0,
                Some(_) => 1,
                None if layout.angles.contains(place) => 2,
                None if matches!(self.nodes[self.derivative[*place] as usize], Node::State(_)) => 3,
                None => 4,
            }
        };
        let mut places: Vec<usize> = (0..self.derivative.len()).collect();
        places.sort_by_key(rank);
        places
    }

    /// Returns the nodes of all equations but for the values that events give.
    pub(super) fn equations(&self) -> impl Iterator<Item = NodeId> {
        let openings = self.openings.iter().flat_map(|opening| {
            [opening.gap, opening.speed, opening.acceleration, opening.force, opening.friction]
        });
        (self.derivative.iter().copied())
            .chain(self.contacts.iter().flatten().copied())
            .chain(self.gaps.iter().flatten().copied())
            .chain(openings)
            .chain(self.events.iter().map(|event| event.guard))
    }

    /// Returns the linear function that each node contains, and adds those that must be constant.
    fn linear_functions(&self, inputs: &[f64], constraints: &mut Constraints) -> Vec<Linear> {
        let n = self.derivative.len();
        let resets = self.events.iter().flat_map(|event| &event.reset).map(|(_, value)| *value);
        let is_needed = self.needed_by(self.equations().chain(resets));
        let mut linear: Vec<Linear> = Vec::with_capacity(self.nodes.len());
        // The values of nodes that depend on parameters alone.
        let mut known: Vec<Option<f64>> = Vec::with_capacity(self.nodes.len());
        for (place, node) in self.nodes.iter().enumerate() {
            let operands = node.operands(&self.solves);
            let is_known = match node {
                Node::Input(input) => self.parameters.contains(input),
                Node::State(_) | Node::Discrete(_) | Node::Solution { .. } => false,
                _ => operands.iter().all(|operand| known[*operand as usize].is_some()),
            };
            let at = |node: NodeId| known[node as usize].unwrap_or(f64::NAN);
            let value = is_known.then(|| node.value(at, |input| inputs[input], |_| f64::NAN));
            if !is_needed[place] || is_known {
                linear.push(Linear::new());
                known.push(value);
                continue;
            }
            let of = |node: NodeId| &linear[node as usize];
            let mut changed = |node: NodeId| constraints.add(of(node));
            let function = match *node {
                Node::State(component) | Node::Discrete(component) => {
                    let mut unit = vec![0.0; n];
                    unit[component as usize] = 1.0;
                    unit
                }
                Node::Sum(a, b) => combined((1.0, of(a)), (1.0, of(b))),
                Node::Difference(a, b) => combined((1.0, of(a)), (-1.0, of(b))),
                Node::Negation(a) => combined((-1.0, of(a)), (0.0, &Linear::new())),
                Node::Product(a, b) => match (known[a as usize], known[b as usize]) {
                    (Some(factor), _) => combined((factor, of(b)), (0.0, &Linear::new())),
                    (_, Some(factor)) => combined((factor, of(a)), (0.0, &Linear::new())),
                    _ => {
                        changed(a);
                        changed(b);
                        Linear::new()
                    }
                },
                Node::Quotient(a, b) if known[b as usize].is_some() => {
                    combined((1.0 / at(b), of(a)), (0.0, &Linear::new()))
                }
                _ => {
                    operands.iter().for_each(|operand| changed(*operand));
                    Linear::new()
                }
            };
            linear.push(function);
            known.push(None);
        }
        linear
    }
}

/// Returns a linear combination.
fn combined((a, left): (f64, &Linear), (b, right): (f64, &Linear)) -> Linear {
    let at = |function: &Linear, place: usize| function.get(place).copied().unwrap_or(0.0);
    let size = left.len().max(right.len());
    let sum = |place: usize| {
        let (left, right) = (a * at(left, place), b * at(right, place));
        let sum = left + right;
        if sum.abs() <= ROUNDING * left.abs() { 0.0 } else { sum }
    };
    (0..size).map(sum).collect()
}

/// Linear functions that must be constant, each solved for one component, which occurs in no other one.
struct Constraints {
    rows: Vec<(usize, Linear)>,
    preference: Vec<usize>,
}

impl Constraints {
    /// Adds a linear function that must be constant.
    fn add(&mut self, function: &Linear) {
        let mut row = function.clone();
        // Where coefficients are not numbers, each component by itself must be constant.
        if !row.iter().all(|entry| entry.is_finite()) {
            for place in (0..row.len()).filter(|place| row[*place] != 0.0) {
                let unit = (0..row.len()).map(|other| if other == place { 1.0 } else { 0.0 });
                self.add(&unit.collect());
            }
            return;
        }
        let size = row.iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
        if size == 0.0 {
            return;
        }
        row.iter_mut().for_each(|entry| *entry /= size);
        for (place, solved) in &self.rows {
            eliminate(&mut row, *place, solved);
        }
        let largest = row.iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
        let is_least = |place: &&usize| row[**place].abs() >= PIVOT * largest;
        let Some(place) = self.preference.iter().find(is_least).copied() else { return };
        if largest <= ROUNDING {
            return;
        }
        let pivot = row[place];
        row.iter_mut().for_each(|entry| *entry /= pivot);
        for (_, solved) in &mut self.rows {
            eliminate(solved, place, &row);
        }
        self.rows.push((place, row));
    }
}

/// Subtracts a multiple of a solved function, so that its component vanishes.
fn eliminate(row: &mut Linear, place: usize, solved: &Linear) {
    let factor = row[place];
    if factor != 0.0 {
        row.iter_mut().zip(solved).for_each(|(entry, solved)| *entry -= factor * solved);
        row[place] = 0.0;
    }
}
