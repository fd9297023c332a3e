//! A part of a graph: the nodes that some results need, without those that only other results need.

use smallvec::SmallVec;

use super::{Graph, Node, NodeId};
use crate::model::Elementary;

/// The nodes that some results need.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct GraphPart {
    /// The nodes, operands first.
    nodes: Vec<Node>,
    /// The place of each node of the graph among `nodes`.
    places: Vec<NodeId>,
    results: Vec<NodeId>,
}

impl Graph {
    /// Returns the part that these nodes need.
    pub(crate) fn part(&self, results: Vec<NodeId>) -> GraphPart {
        let is_needed = self.needed_by(results.iter().copied());
        let mut part = GraphPart { nodes: Vec::new(), places: vec![0; self.nodes.len()], results };
        for (place, (node, is_needed)) in self.nodes.iter().zip(is_needed).enumerate() {
            if is_needed {
                part.places[place] = part.nodes.len() as NodeId;
                part.nodes.push(*node);
            }
        }
        part
    }
}

impl GraphPart {
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
