//! How the nodes of a graph depend on components of the state: whether equations are affine.

use super::{Graph, Node, NodeId};

/// How a number depends on variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Degree {
    /// It does not depend on them.
    Constant,
    /// It is affine in them.
    Affine,
    /// It depends on them in another way, or may do so.
    Other,
}

impl Graph {
    /// Returns how each node depends on components of the state that are variables, at these values of the nodes. What is
    /// multiplied by a constant zero, such as the mode of a contact, does not count.
    pub fn degrees(&self, values: &[f64], is_variable: impl Fn(usize) -> bool) -> Vec<Degree> {
        let mut degrees: Vec<Degree> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let of = |node: NodeId| degrees[node as usize];
            let is_zero =
                |node: NodeId| of(node) == Degree::Constant && values[node as usize] == 0.0;
            let degree = match *node {
                Node::Constant(_) | Node::Input(_) => Degree::Constant,
                Node::State(component) | Node::Discrete(component) => {
                    if is_variable(component as usize) { Degree::Affine } else { Degree::Constant }
                }
                Node::Sum(a, b) | Node::Difference(a, b) => of(a).max(of(b)),
                Node::Negation(a) => of(a),
                Node::Product(a, b) if is_zero(a) || is_zero(b) => Degree::Constant,
                Node::Product(a, b) => match (of(a), of(b)) {
                    (Degree::Constant, degree) => degree,
                    (degree, Degree::Constant) => degree,
                    _ => Degree::Other,
                },
                Node::Solution { solve, .. } => {
                    let solve = &self.solves[solve as usize];
                    let is_constant = |node: &NodeId| of(*node) == Degree::Constant;
                    match solve.matrix.iter().all(is_constant) {
                        true => solve
                            .right
                            .iter()
                            .map(|node| of(*node))
                            .max()
                            .unwrap_or(Degree::Constant),
                        false => Degree::Other,
                    }
                }
                Node::Quotient(a, b) if of(b) == Degree::Constant => of(a),
                _ => {
                    let operands = node.operands(&self.solves);
                    let is_constant = |node: &NodeId| of(*node) == Degree::Constant;
                    if operands.iter().all(is_constant) { Degree::Constant } else { Degree::Other }
                }
            };
            degrees.push(degree);
        }
        degrees
    }
}
