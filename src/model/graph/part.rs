//! A part of a graph: the nodes that some results need, without those that only other results need.

use smallvec::SmallVec;

use super::{Node, NodeId, Solve};
use crate::model::Elementary;

/// The nodes that some results need.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct GraphPart {
    /// The nodes, operands first.
    nodes: Vec<Node>,
    /// The place of each node of the graph among `nodes`.
    places: Vec<NodeId>,
    results: Vec<NodeId>,
    /// Whether the results need unknowns of linear systems.
    pub(crate) has_unknowns: bool,
}

/// Returns whether each node is needed for one of these results.
pub(super) fn needed_by(
    nodes: &[Node],
    solves: &[Solve],
    results: impl IntoIterator<Item = NodeId>,
) -> Vec<bool> {
    let mut is_needed = vec![false; nodes.len()];
    results.into_iter().for_each(|node| is_needed[node as usize] = true);
    for place in (0..nodes.len()).rev() {
        if is_needed[place] {
            let operands = nodes[place].operands(solves);
            operands.into_iter().for_each(|operand| is_needed[operand as usize] = true);
        }
    }
    is_needed
}

impl GraphPart {
    /// Returns the part of a graph with these nodes and linear systems that the results need.
    pub(super) fn of(nodes: &[Node], solves: &[Solve], results: Vec<NodeId>) -> Self {
        let is_needed = needed_by(nodes, solves, results.iter().copied());
        let places = vec![0; nodes.len()];
        let mut part = GraphPart { nodes: Vec::new(), places, results, has_unknowns: false };
        for ((node, place), is_needed) in nodes.iter().zip(&mut part.places).zip(is_needed) {
            if is_needed {
                *place = part.nodes.len() as NodeId;
                part.nodes.push(*node);
                part.has_unknowns |= matches!(node, Node::Solution { .. });
            }
        }
        part
    }

    /// Returns the results, as if the unknowns of linear systems were 0.
    pub(crate) fn values<T: Elementary>(
        &self,
        input: impl Fn(usize) -> T,
        state: impl Fn(usize) -> T,
    ) -> impl Iterator<Item = T> {
        let mut values: SmallVec<[T; 64]> = SmallVec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let at = |node: NodeId| values[self.places[node as usize] as usize];
            values.push(node.value(at, &input, &state));
        }
        self.results.iter().map(move |node| values[self.places[*node as usize] as usize])
    }
}
