//! The nodes of a graph of expressions. The operands of a node stand before the node.

use smallvec::{SmallVec, smallvec};

use crate::model::{Elementary, Function};

/// The place of a node in its graph.
pub type NodeId = u32;

/// An expression whose operands are nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// A number.
    Constant(f64),
    /// A number that is constant during a step, such as a parameter of the system or the mode of a contact.
    Input(u32),
    /// A component of the state.
    State(u32),
    /// A component of the state that only events change.
    Discrete(u32),
    /// `a + b`
    Sum(NodeId, NodeId),
    /// `a - b`
    Difference(NodeId, NodeId),
    /// `-a`
    Negation(NodeId),
    /// `a b`
    Product(NodeId, NodeId),
    /// `a / b`
    Quotient(NodeId, NodeId),
    /// `sin a`; the next node is its cosine.
    Sine(NodeId),
    /// `cos a`; the previous node is its sine.
    Cosine(NodeId),
    /// `sqrt a`
    SquareRoot(NodeId),
    /// `exp a`
    Exponential(NodeId),
    /// A function of `a` other than the exponential, with the node whose reciprocal is the derivative of the function by `a`:
    /// `1 + a²` for `atan a`, and `a` for `log a`.
    Function(Function, NodeId, NodeId),
    /// A component of the solution of a linear system.
    Solution {
        /// The system, by its place in [`super::Graph::solves`].
        solve: u32,
        /// The component.
        row: u32,
    },
}

impl Node {
    /// Returns the value of the node from those of its operands, the inputs and the components of the state; 0 for an unknown of
    /// a linear system.
    #[inline(always)]
    pub fn value<T: Elementary>(
        &self,
        at: impl Fn(NodeId) -> T,
        input: impl Fn(usize) -> T,
        state: impl Fn(usize) -> T,
    ) -> T {
        match *self {
            Node::Constant(value) => T::constant(value),
            Node::Input(index) => input(index as usize),
            Node::State(component) | Node::Discrete(component) => state(component as usize),
            Node::Sum(a, b) => at(a) + at(b),
            Node::Difference(a, b) => at(a) - at(b),
            Node::Negation(a) => -at(a),
            Node::Product(a, b) => at(a) * at(b),
            Node::Quotient(a, b) => at(a) * at(b).reciprocal(),
            Node::Sine(angle) => at(angle).sin_cos().0,
            Node::Cosine(angle) => at(angle).sin_cos().1,
            Node::SquareRoot(a) => at(a).sqrt(),
            Node::Exponential(a) => at(a).function(Function::Exponential),
            Node::Function(function, a, _) => at(a).function(function),
            Node::Solution { .. } => T::constant(0.0),
        }
    }

    /// Returns the operands of the node; `solves` are the linear systems of its graph.
    pub fn operands(&self, solves: &[Solve]) -> SmallVec<[NodeId; 2]> {
        match *self {
            Node::Constant(_) | Node::Input(_) | Node::State(_) | Node::Discrete(_) => smallvec![],
            Node::Sum(a, b)
            | Node::Difference(a, b)
            | Node::Product(a, b)
            | Node::Quotient(a, b)
            | Node::Function(_, a, b) => smallvec![a, b],
            Node::Negation(a)
            | Node::Sine(a)
            | Node::Cosine(a)
            | Node::SquareRoot(a)
            | Node::Exponential(a) => smallvec![a],
            Node::Solution { solve, .. } => {
                let solve = &solves[solve as usize];
                solve.matrix.iter().chain(&solve.right).copied().collect()
            }
        }
    }
}

/// A linear system `A x = b` of `b.len()` equations.
#[derive(Clone, Debug, PartialEq)]
pub struct Solve {
    /// The matrix, row by row.
    pub matrix: Vec<NodeId>,
    /// The right-hand side.
    pub right: Vec<NodeId>,
    /// Whether an unknown that its own equation contains with the factor 1 is eliminated first, without a comparison of
    /// pivots.
    pub has_sound_diagonal: bool,
    /// The number of first unknowns that the equations determine. Those behind them are 0 where dependent equations leave them open.
    pub determined: usize,
}
