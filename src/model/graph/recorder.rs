//! A graph that is being recorded, in which equal expressions are one node.

use std::cell::RefCell;
use std::collections::HashMap;

use super::{Node, NodeId, Solve};

/// A graph that is being recorded.
#[derive(Default)]
pub struct Recorder(pub(super) RefCell<Recording>);

/// What is recorded so far.
#[derive(Default)]
pub(super) struct Recording {
    pub(super) nodes: Vec<Node>,
    /// The place of each node. A NaN equals itself here, as its bits do.
    known: HashMap<(u8, u64, u64), NodeId>,
    pub(super) solves: Vec<Solve>,
    pub(super) inputs: Vec<String>,
    pub(super) switches: Vec<u32>,
    pub(super) parameters: Vec<u32>,
    pub(super) states: u32,
}

impl Recorder {
    /// Returns the nodes up to one of them.
    pub(super) fn nodes_until(&self, last: NodeId) -> Vec<Node> {
        self.0.borrow().nodes[..=last as usize].to_vec()
    }

    /// Returns the place of a node, which is added if it is new.
    pub(super) fn add(&self, node: Node) -> NodeId {
        let mut recording = self.0.borrow_mut();
        let next = recording.nodes.len() as NodeId;
        let id = *recording.known.entry(key(node)).or_insert(next);
        if id == next {
            recording.nodes.push(node);
        }
        id
    }
}

/// Returns a key that only equal nodes share. The order of the operands of sums and products does not matter.
fn key(node: Node) -> (u8, u64, u64) {
    let two = |kind: u8, a: NodeId, b: NodeId| (kind, a.into(), b.into());
    match node {
        Node::Constant(value) => (0, value.to_bits(), 0),
        Node::Input(index) => two(1, index, 0),
        Node::State(index) => two(2, index, 0),
        Node::Discrete(index) => two(3, index, 0),
        Node::Sum(a, b) => two(4, a.min(b), a.max(b)),
        Node::Difference(a, b) => two(5, a, b),
        Node::Negation(a) => two(6, a, 0),
        Node::Product(a, b) => two(7, a.min(b), a.max(b)),
        Node::Quotient(a, b) => two(8, a, b),
        Node::Sine(a) => two(9, a, 0),
        Node::Cosine(a) => two(10, a, 0),
        Node::SquareRoot(a) => two(11, a, 0),
        Node::Exponential(a) => two(12, a, 0),
        Node::Function(function, a, b) => two(20 + function as u8, a, b),
        Node::Solution { solve, row } => two(14, solve, row),
    }
}
