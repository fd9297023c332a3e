//! Rates and forces of a system in one state.

use std::sync::{Arc, Mutex};

use smallvec::SmallVec;

use super::in_one_state::Affected;
use super::{Phase, Phases};
use crate::model::{
    Bounded, Components, Dual, Elementary, Graph, Node, NodeId, Number, Opening, Solve, System,
};

/// Speed, acceleration and forces of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForces<T = f64> {
    /// Sliding speed.
    pub speed: T,
    /// Sliding acceleration.
    pub acceleration: T,
    /// Normal force, compression positive.
    pub normal: T,
    /// Friction force, acting against positive speed; in stick, the force required to stick.
    pub friction: T,
}

/// Force and acceleration of a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GapForces {
    /// The second time derivative of its width.
    pub opening_acceleration: f64,
    /// The force in it, compression positive; 0 while it is open, and between contacts that stick, where it is not
    /// determined.
    pub force: f64,
}

/// The forces of all contacts.
pub type Forces<T = f64> = SmallVec<[ContactForces<T>; 8]>;

/// Evaluates the recorded equations of a system for one run.
#[derive(Clone, Debug)]
pub struct Evaluator {
    system: Arc<dyn System>,
    graph: Arc<Graph>,
    pub(super) affected: Arc<Mutex<Arc<Affected>>>,
}

impl Evaluator {
    /// Records a system.
    pub fn new(system: Arc<dyn System>) -> Self {
        let graph = Graph::of(system.as_ref());
        Evaluator::of_graph(system, graph)
    }

    /// Returns the equations of a system, which are already recorded.
    pub(super) fn of_graph(system: Arc<dyn System>, graph: Arc<Graph>) -> Self {
        Evaluator { system, graph, affected: Arc::default() }
    }

    /// Returns the equations of another system, which are those of this one if both systems have the same.
    pub(super) fn of(&self, system: &Arc<dyn System>) -> Self {
        let graph = Graph::of(system.as_ref());
        let shared = Arc::ptr_eq(&graph, &self.graph);
        let affected = if shared { Arc::clone(&self.affected) } else { Arc::default() };
        Evaluator { system: Arc::clone(system), graph, affected }
    }

    /// Returns the system.
    pub fn system(&self) -> &Arc<dyn System> {
        &self.system
    }

    /// Returns the recorded equations.
    pub fn graph(&self) -> &Arc<Graph> {
        &self.graph
    }

    /// Returns the time derivative of a state.
    pub fn rates(&self, phases: &[Phase], state: &[f64]) -> Components {
        let values = self.all_values::<f64>(phases, |component| state[component]);
        self.graph.derivative.iter().map(|&node| values[node as usize]).collect()
    }

    /// Returns the sliding speeds of all contacts, which do not depend on their phases.
    pub fn speeds(&self, state: &[f64]) -> SmallVec<[f64; 8]> {
        let contacts = 0..self.graph.contacts.len();
        let components: Option<_> =
            contacts.map(|contact| Some(state[self.graph.speed_component(contact)?])).collect();
        components.unwrap_or_else(|| {
            self.forces(&self.no_phases(), state).iter().map(|contact| contact.speed).collect()
        })
    }

    /// Returns the gap, the opening speed and the sliding speed of each opening, which do not depend on phases.
    pub(crate) fn openings<T: Solved>(&self, state: impl Fn(usize) -> T) -> SmallVec<[[T; 3]; 4]> {
        if self.graph.openings.is_empty() {
            return SmallVec::new();
        }
        let values = self.values_with(&self.inputs(&self.no_phases()), false, state);
        let opening = |one: &Opening| {
            let nodes = [one.gap, one.speed, self.graph.contacts[one.contact][0]];
            nodes.map(|node| values[node as usize])
        };
        self.graph.openings.iter().map(opening).collect()
    }

    /// Returns the contacts that may open, each with its gap, non-dimensional.
    pub(crate) fn opening_gaps(&self, state: &[f64]) -> SmallVec<[(usize, f64); 4]> {
        let gaps = self.openings(|component| state[component]);
        self.graph.openings.iter().zip(gaps).map(|(one, [gap, ..])| (one.contact, gap)).collect()
    }

    /// Returns phases for quantities that do not depend on them.
    pub(super) fn no_phases(&self) -> Phases {
        let mut phases = Phases::from_elem(Phase::Stick, self.graph.contacts.len());
        phases.resize(phases.len() + self.graph.gaps.len(), Phase::Open);
        phases
    }

    /// Returns speeds, accelerations and forces of all contacts in a state.
    pub fn forces(&self, phases: &[Phase], state: &[f64]) -> Forces {
        let values = self.all_values::<f64>(phases, |component| state[component]);
        forces(&self.graph, |node| values[node as usize])
    }

    /// Returns speeds, accelerations and forces of all contacts in a state and their changes along a direction.
    pub fn forces_along(&self, phases: &[Phase], state: &[f64], direction: &[f64]) -> Forces<Dual> {
        let component = |i: usize| Dual { value: state[i], slope: direction[i] };
        let values = self.all_values(phases, component);
        forces(&self.graph, |node| values[node as usize])
    }

    /// Returns the state after an event, from the state before it.
    pub fn reset(&self, event: usize, phases: &[Phase], state: &[f64]) -> Components {
        let values = self.all_values::<f64>(phases, |component| state[component]);
        let mut after = Components::from(state);
        for &(component, value) in &self.graph.events[event].reset {
            after[component] = values[value as usize];
        }
        after
    }

    /// Returns the changes of the guard of an event and of the state after the event along a direction.
    pub fn event_along(
        &self,
        event: usize,
        phases: &[Phase],
        state: &[f64],
        direction: &[f64],
    ) -> (f64, Components) {
        let component = |i: usize| Dual { value: state[i], slope: direction[i] };
        let values = self.all_values(phases, component);
        let event = &self.graph.events[event];
        let mut after = Components::from(direction);
        for &(component, value) in &event.reset {
            after[component] = values[value as usize].slope;
        }
        (values[event.guard as usize].slope, after)
    }

    /// Returns the values of all nodes.
    pub(crate) fn all_values<T: Solved>(
        &self,
        phases: &[Phase],
        state: impl Fn(usize) -> T,
    ) -> SmallVec<[T; 128]> {
        self.values_with(&self.inputs(phases), true, state)
    }

    /// Returns the values of all nodes with these values of the inputs; without `solves`, as if the unknowns of linear systems
    /// were 0.
    pub(super) fn values_with<T: Solved>(
        &self,
        inputs: &[f64],
        solves: bool,
        state: impl Fn(usize) -> T,
    ) -> SmallVec<[T; 128]> {
        let mut values = SmallVec::with_capacity(self.graph.nodes.len());
        let mut solution = Solution::new();
        for node in &self.graph.nodes {
            let input = |index: usize| T::constant(inputs[index]);
            values.push(match solves {
                true => self.value(node, &values, input, &state, &mut solution),
                false => node.value(|node| values[node as usize], input, &state),
            });
        }
        values
    }

    pub(super) fn inputs(&self, phases: &[Phase]) -> Vec<f64> {
        let modes: SmallVec<[_; 8]> = phases.iter().map(|phase| phase.mode()).collect();
        self.system.inputs(&modes)
    }

    /// Returns the value of a node from those of the nodes before it.
    #[inline(always)]
    pub(super) fn value<T: Solved>(
        &self,
        node: &Node,
        values: &[T],
        input: impl Fn(usize) -> T,
        state: impl Fn(usize) -> T,
        solution: &mut Solution<T>,
    ) -> T {
        let at = |node: NodeId| -> T { values[node as usize] };
        let Node::Solution { solve, row } = *node else { return node.value(at, input, state) };
        if solution.solve != Some(solve) {
            let Solve { matrix, right, .. } = &self.graph.solves[solve as usize];
            solution.solve = Some(solve);
            T::solve(matrix, right, at, &mut solution.unknowns);
        }
        solution.unknowns[row as usize]
    }
}

/// Numbers for which linear systems are solved.
pub trait Solved: Elementary {
    /// Computes the unknowns of a linear system from the nodes of its matrix and its right side.
    fn solve(
        matrix: &[NodeId],
        right: &[NodeId],
        at: impl Fn(NodeId) -> Self,
        unknowns: &mut Unknowns<Self>,
    ) {
        let matrix = matrix.iter().map(|node| at(*node)).collect();
        *unknowns = solved(matrix, right.iter().map(|node| at(*node)).collect());
    }
}

impl Solved for f64 {}
impl Solved for Dual {}
impl Solved for Bounded {}

/// The solution of the latest linear system.
pub(super) struct Solution<T> {
    solve: Option<u32>,
    unknowns: Unknowns<T>,
}

impl<T> Solution<T> {
    pub(super) fn new() -> Self {
        Solution { solve: None, unknowns: SmallVec::new() }
    }
}

pub(super) fn forces<T: Number>(graph: &Graph, at: impl Fn(NodeId) -> T) -> Forces<T> {
    let contact = |nodes: &[NodeId; 4]| {
        let [speed, acceleration, normal, friction] = nodes.map(&at);
        ContactForces { speed, acceleration, normal, friction }
    };
    graph.contacts.iter().map(contact).collect()
}

/// The entries of a matrix, row by row, without an allocation for up to eight unknowns.
pub(crate) type Entries<T> = SmallVec<[T; 64]>;
/// The unknowns of a linear system, or its right side.
pub type Unknowns<T> = SmallVec<[T; 8]>;

/// A pivot is small, and another row takes its place, if its share of the largest entry of its row is below this fraction of
/// the other row's share. The order of well-posed equations then remains, and rounding errors grow little.
pub(super) const SMALL_PIVOT: f64 = 0.1;

/// Returns the solution of a linear system by elimination in the order of its unknowns, as in lanes. Rows with small pivots
/// are exchanged: threshold pivoting with rows scaled by their largest entries (I. S. Duff, A. M. Erisman, J. K. Reid,
/// *Direct Methods for Sparse Matrices*, 2nd ed., Oxford 2017, chapter 5, doi:10.1093/acprof:oso/9780198508380.001.0001).
pub(super) fn solved<T: Elementary>(matrix: Entries<T>, mut right: Unknowns<T>) -> Unknowns<T> {
    solve_for_each(matrix, [&mut right].into());
    right
}

/// Replaces each right side by the solution that [`solved`] returns for it.
pub(super) fn solve_for_each<T: Elementary>(
    mut matrix: Entries<T>,
    mut rights: SmallVec<[&mut Unknowns<T>; 1]>,
) {
    let size = rights.first().map_or(0, |right| right.len());
    let largest = |row: &[T]| row.iter().fold(0.0_f64, |most, one| most.max(one.value().abs()));
    let mut scales: SmallVec<[f64; 4]> = matrix.chunks(size.max(1)).map(largest).collect();
    for column in 0..size {
        for row in column + 1..size {
            let entry = |row: usize| matrix[row * size + column].value().abs();
            if entry(column) * scales[row] < SMALL_PIVOT * entry(row) * scales[column] {
                (0..size).for_each(|j| matrix.swap(row * size + j, column * size + j));
                rights.iter_mut().for_each(|right| right.swap(row, column));
                scales.swap(row, column);
            }
        }
        let inverse = matrix[column * size + column].reciprocal();
        for row in column + 1..size {
            // Most entries of the equations of several bodies are zero.
            if matrix[row * size + column].is_zero() {
                continue;
            }
            let factor = matrix[row * size + column] * inverse;
            for j in column + 1..size {
                matrix[row * size + j] =
                    matrix[row * size + j] - factor * matrix[column * size + j];
            }
            rights.iter_mut().for_each(|right| right[row] = right[row] - factor * right[column]);
        }
    }
    for row in (0..size).rev() {
        let inverse = matrix[row * size + row].reciprocal();
        for right in &mut rights {
            for column in row + 1..size {
                let entry = matrix[row * size + column];
                if !entry.is_zero() {
                    right[row] = right[row] - entry * right[column];
                }
            }
            right[row] = right[row] * inverse;
        }
    }
}
