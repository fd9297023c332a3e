//! Rates and forces of a system in one state.

use std::sync::{Arc, Mutex, PoisonError};

use smallvec::SmallVec;

use super::linear_system::{Solved, Unknowns};
use super::{Phase, Phases};
use crate::model::{Components, Dual, Graph, Node, NodeId, Number, System, Translations};

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

/// The nodes that phases affect, as far as they are known.
#[derive(Debug, Default)]
pub(super) struct AffectedNodes {
    /// Which inputs vary.
    pub(super) varying: Vec<bool>,
    /// The nodes that depend on these inputs, operands first.
    pub(super) nodes: Vec<NodeId>,
    /// Whether each node is one of them.
    pub(super) is_affected: Vec<bool>,
    /// Their operands that do not depend on these inputs.
    pub(super) others: Vec<NodeId>,
}

/// Evaluates the recorded equations of a system for one run.
#[derive(Clone, Debug)]
pub struct Evaluator {
    system: Arc<dyn System>,
    graph: Arc<Graph>,
    affected: Arc<Mutex<Arc<AffectedNodes>>>,
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

    /// Returns the nodes that phases affect, as far as they are known.
    pub(super) fn affected(&self) -> Arc<AffectedNodes> {
        // A panic while the nodes are locked leaves them complete.
        Arc::clone(&self.affected.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Finds the nodes that depend on inputs that vary, and remembers them for other states.
    pub(super) fn affected_by(&self, varying: Vec<bool>) -> Arc<AffectedNodes> {
        let graph = &self.graph;
        let varies = |node: &Node| matches!(node, Node::Input(index) if varying[*index as usize]);
        let nodes = graph.depending_on(varies);
        let mut is_affected = vec![false; graph.nodes.len()];
        nodes.iter().for_each(|node| is_affected[*node as usize] = true);
        let operands =
            nodes.iter().flat_map(|node| graph.nodes[*node as usize].operands(&graph.solves));
        let mut others: Vec<NodeId> = operands.filter(|id| !is_affected[*id as usize]).collect();
        others.sort_unstable();
        others.dedup();
        let affected = Arc::new(AffectedNodes { varying, nodes, is_affected, others });
        *self.affected.lock().unwrap_or_else(PoisonError::into_inner) = Arc::clone(&affected);
        affected
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
        let sliding_speeds = &self.graph.sliding_speeds;
        components.unwrap_or_else(|| {
            if sliding_speeds.has_unknowns {
                let forces = self.forces(&self.no_phases(), state);
                return forces.iter().map(|contact| contact.speed).collect();
            }
            let inputs = self.inputs(&self.no_phases());
            let component = |component: usize| state[component];
            sliding_speeds.values(|index| inputs[index], component).collect()
        })
    }

    /// Returns the gap, the opening speed and the sliding speed of each opening, which do not depend on phases.
    pub(crate) fn openings<T: Solved>(&self, state: impl Fn(usize) -> T) -> SmallVec<[[T; 3]; 4]> {
        if self.graph.openings.is_empty() {
            return SmallVec::new();
        }
        let inputs = self.inputs(&self.no_phases());
        let input = |index: usize| T::constant(inputs[index]);
        let values: SmallVec<[T; 12]> = self.graph.opening_speeds.values(input, state).collect();
        values.as_chunks::<3>().0.iter().copied().collect()
    }

    /// Returns the contacts that may open, each with its gap, non-dimensional.
    pub(crate) fn opening_gaps(&self, state: &[f64]) -> SmallVec<[(usize, f64); 4]> {
        let gaps = self.openings(|component| state[component]);
        self.graph.openings.iter().zip(gaps).map(|(site, [gap, ..])| (site.contact, gap)).collect()
    }

    /// Returns the translations that no equation notices.
    pub(crate) fn translations(&self) -> Translations {
        self.graph.translations(|| self.inputs(&self.no_phases()))
    }

    /// Returns phases for quantities that do not depend on them.
    pub(crate) fn no_phases(&self) -> Phases {
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
        let values = self.values_along(phases, state, |component| direction[component]);
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
        let values = self.values_along(phases, state, |component| direction[component]);
        let event = &self.graph.events[event];
        let mut after = Components::from(direction);
        for &(component, value) in &event.reset {
            after[component] = values[value as usize].slope;
        }
        (values[event.guard as usize].slope, after)
    }

    /// Returns the values of all nodes and their changes along a direction.
    pub(crate) fn values_along(
        &self,
        phases: &[Phase],
        state: &[f64],
        direction: impl Fn(usize) -> f64,
    ) -> SmallVec<[Dual; 128]> {
        let component = |place: usize| Dual { value: state[place], slope: direction(place) };
        self.all_values(phases, component)
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
            solution.solve = Some(solve);
            T::solve(&self.graph.solves[solve as usize], at, &mut solution.unknowns);
        }
        solution.unknowns[row as usize]
    }
}

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
