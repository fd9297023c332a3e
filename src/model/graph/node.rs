//! The nodes of a graph of expressions. The operands of a node stand before the node.

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
    /// `atan a`, with the node `1 + a²`.
    ArcTangent(NodeId, NodeId),
    /// A component of the solution of a linear system.
    Solution {
        /// The system, by its place in [`super::Graph::solves`].
        solve: u32,
        /// The component.
        row: u32,
    },
}

/// A linear system `A x = b` of `b.len()` equations.
#[derive(Clone, Debug, PartialEq)]
pub struct Solve {
    /// The matrix, row by row.
    pub matrix: Vec<NodeId>,
    /// The right-hand side.
    pub right: Vec<NodeId>,
}
