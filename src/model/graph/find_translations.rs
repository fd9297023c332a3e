//! The translations that no equation of a graph notices.
//!
//! Each node is a linear function of the state with constant coefficients, beside a function that is the same in translated states.
//! This holds if the linear functions that are operands of a product, a sine or another function, and those of the equations
//! themselves, are the same in translated states. The directions in which all of these are constant are the translations.

use super::translation::sum;
use super::{Graph, Node, NodeId, Translation, Translations};

/// The least coefficient by which a linear function is solved for a preferred component, over the largest one.
const PIVOT: f64 = 1e-6;

/// Coefficients of a linear function of the state; empty if all are 0.
type Linear = Vec<f64>;

impl Graph {
    /// Returns the translations that no equation notices, at these values of the inputs, or else whatever the parameters are. A
    /// pivot is the position of a contact only if no other component could be one.
    pub(super) fn find_translations(&self, inputs: Option<&[f64]>) -> Translations {
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
        // The angle of a contact jumps back after a turn, and the phase of a force after a period.
        let angles = self.layout.contacts.iter().filter(|contact| contact.angular);
        let phase = self.layout.forcing.map(|forcing| forcing.component);
        for angle in angles.map(|contact| contact.position) {
            if constraints.rows.iter().any(|(_, row)| row[angle] != 0.0) {
                constraints.add_component(angle, n);
            }
        }
        phase.into_iter().for_each(|phase| constraints.add_component(phase, n));
        let is_pivot = |place: &usize| !constraints.rows.iter().any(|(solved, _)| solved == place);
        let along = |pivot: usize| {
            let others = constraints.rows.iter().map(|(place, row)| (*place, -row[pivot]));
            Translation { pivot, others: others.filter(|(_, by)| *by != 0.0).collect() }
        };
        Translations((0..n).filter(is_pivot).map(along).collect())
    }

    /// Returns the components in the order in which linear functions are solved for them.
    fn preference(&self) -> Vec<usize> {
        let layout = &self.layout;
        let rank = |place: &usize| {
            let of_contact = layout.contacts.iter().any(|contact| contact.position == *place);
            let clock = self.is_clock(*place);
            if of_contact {
                0
            } else {
                1 + u8::from(!layout.angles.contains(place)) + u8::from(clock)
            }
        };
        let mut places: Vec<usize> = (0..self.derivative.len()).collect();
        places.sort_by_key(rank);
        places
    }

    /// Returns the nodes of all equations but for the values that events give.
    fn equations(&self) -> impl Iterator<Item = NodeId> {
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
    fn linear_functions(
        &self,
        inputs: Option<&[f64]>,
        constraints: &mut Constraints,
    ) -> Vec<Linear> {
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
            let input =
                |input: usize| inputs.map_or_else(|| any_number(input as f64), |all| all[input]);
            let value = is_known.then(|| node.value(at, input, |_| f64::NAN));
            // The square root of any number may be none, but that of the parameters is one.
            let finite = |value: f64| match inputs {
                None if !value.is_finite() => any_number(place as f64 + 0.5),
                _ => value,
            };
            let scaled =
                |factor: f64, node: NodeId| combined(factor, &linear[node as usize], 0.0, &[]);
            let (of, known_of) =
                (|node: NodeId| &linear[node as usize], |node: NodeId| known[node as usize]);
            let function = match *node {
                _ if is_known || !is_needed[place] => Linear::new(),
                Node::State(component) | Node::Discrete(component) => unit(component as usize, n),
                Node::Sum(a, b) => combined(1.0, of(a), 1.0, of(b)),
                Node::Difference(a, b) => combined(1.0, of(a), -1.0, of(b)),
                Node::Negation(a) => scaled(-1.0, a),
                Node::Product(a, b) if let Some(factor) = known_of(a) => scaled(factor, b),
                Node::Product(a, b) if let Some(factor) = known_of(b) => scaled(factor, a),
                Node::Quotient(a, b) if let Some(divisor) = known_of(b) => scaled(1.0 / divisor, a),
                _ => {
                    operands.iter().for_each(|operand| constraints.add(of(*operand)));
                    Linear::new()
                }
            };
            linear.push(function);
            known.push(value.map(finite));
        }
        linear
    }
}

/// Returns one of many numbers between 0 and 1 that fulfil no equation with each other.
fn any_number(index: f64) -> f64 {
    0.6 + 0.35 * libm::sin(1.0 + index + index * index)
}

fn unit(component: usize, n: usize) -> Linear {
    (0..n).map(|place| if place == component { 1.0 } else { 0.0 }).collect()
}

/// Returns a linear combination.
fn combined(a: f64, left: &[f64], b: f64, right: &[f64]) -> Linear {
    let times = |factor: f64, function: &[f64], place: usize| match function.get(place) {
        Some(entry) if *entry != 0.0 => factor * entry,
        _ => 0.0,
    };
    let sum = |place: usize| sum(times(a, left, place), times(b, right, place));
    (0..left.len().max(right.len())).map(sum).collect()
}

/// Linear functions that must be constant, each solved for one component, which occurs in no other one.
struct Constraints {
    rows: Vec<(usize, Linear)>,
    preference: Vec<usize>,
}

impl Constraints {
    /// Adds that a component must be constant.
    fn add_component(&mut self, component: usize, n: usize) {
        self.add(&unit(component, n));
    }

    /// Adds a linear function that must be constant.
    fn add(&mut self, function: &Linear) {
        let mut row = function.clone();
        // Where coefficients are not numbers, each component by itself must be constant.
        if !row.iter().all(|entry| entry.is_finite()) {
            let places = (0..row.len()).filter(|place| row[*place] != 0.0);
            places.for_each(|place| self.add_component(place, row.len()));
            return;
        }
        for (place, solved) in &self.rows {
            eliminate(&mut row, *place, solved);
        }
        let largest = row.iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
        let is_large = |place: &&usize| {
            let size = row.get(**place).map_or(0.0, |entry| entry.abs());
            size > 0.0 && size >= PIVOT * largest
        };
        let Some(place) = self.preference.iter().find(is_large).copied() else { return };
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
    let factor = row.get(place).copied().unwrap_or(0.0);
    if factor != 0.0 {
        row.iter_mut().zip(solved).for_each(|(entry, part)| *entry = sum(*entry, -factor * part));
        row[place] = 0.0;
    }
}
