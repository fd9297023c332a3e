//! The recorded equations of a system in one state, for several assumptions about the phases.

use std::sync::{Arc, PoisonError};

use smallvec::SmallVec;

use super::evaluator::{Forces, GapForces, Solution, forces};
use super::{Evaluator, Phase};
use crate::model::NodeId;

/// The nodes that phases affect, as far as they are known.
#[derive(Debug, Default)]
pub(super) struct Affected {
    /// Which inputs vary.
    varying: Vec<bool>,
    /// The nodes that depend on these inputs, operands first.
    nodes: Vec<NodeId>,
}

impl Evaluator {
    /// Returns the equations in one state, for several assumptions about the phases.
    pub fn in_state<'a>(&'a self, state: &'a [f64]) -> InOneState<'a> {
        InOneState {
            evaluator: self,
            state,
            inputs: Vec::new(),
            values: Vec::new(),
            affected: self.affected(),
        }
    }

    fn affected(&self) -> Arc<Affected> {
        // A panic while the nodes are locked leaves them complete.
        Arc::clone(&self.affected.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Finds the nodes that depend on inputs that vary, and remembers them for other states.
    fn affected_by(&self, varying: Vec<bool>) -> Arc<Affected> {
        let nodes = self.graph().depending_on(&varying);
        let affected = Arc::new(Affected { varying, nodes });
        *self.affected.lock().unwrap_or_else(PoisonError::into_inner) = Arc::clone(&affected);
        affected
    }
}

/// The recorded equations in one state. From one assumption about the phases to the next, only the nodes that depend on
/// the inputs that vary are computed.
pub struct InOneState<'a> {
    evaluator: &'a Evaluator,
    state: &'a [f64],
    inputs: Vec<f64>,
    values: Vec<f64>,
    affected: Arc<Affected>,
}

impl InOneState<'_> {
    /// Returns forces and accelerations of all contacts and gaps.
    pub fn forces_and_gaps(&mut self, phases: &[Phase]) -> (Forces, SmallVec<[GapForces; 8]>) {
        self.assume(phases);
        let graph = self.evaluator.graph();
        let gap = |nodes: &[NodeId; 2]| {
            let [opening_acceleration, force] = nodes.map(|node| self.values[node as usize]);
            GapForces { opening_acceleration, force }
        };
        (forces(graph, &self.values), graph.gaps.iter().map(gap).collect())
    }

    /// Computes all nodes for these phases.
    fn assume(&mut self, phases: &[Phase]) {
        let inputs = self.evaluator.inputs(phases);
        if self.values.is_empty() {
            let state = |component: usize| self.state[component];
            self.values = self.evaluator.values(phases, state).to_vec();
            self.inputs = inputs;
            return;
        }
        let known = |input: usize| self.affected.varying.get(input) == Some(&true);
        let varies = |input: usize| inputs[input] != self.inputs[input];
        if (0..inputs.len()).any(|input| varies(input) && !known(input)) {
            let varying = (0..inputs.len()).map(|input| varies(input) || known(input)).collect();
            self.affected = self.evaluator.affected_by(varying);
        }
        let mut solution = Solution::none();
        for &place in &self.affected.nodes {
            let node = &self.evaluator.graph().nodes[place as usize];
            let state = |component: usize| self.state[component];
            self.values[place as usize] =
                self.evaluator.value(node, &self.values, &inputs, state, &mut solution);
        }
        self.inputs = inputs;
    }
}
