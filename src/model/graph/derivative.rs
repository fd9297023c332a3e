//! Derivatives of recorded expressions by the state.

use super::{Expression, Node, NodeId, Recorder};
use crate::model::Number;

impl Recorder {
    /// Returns the rate of change of an expression whose components of the state or inputs change at these rates: each pair is
    /// one of them and its rate. All others are constant.
    ///
    /// # Panics
    /// Panics if the expression contains an unknown of a linear system: the caller writes gaps and sliding speeds, which
    /// depend on positions, speeds and time only.
    pub fn rate_of_change<'r>(
        &'r self,
        of: Expression<'r>,
        rates: &[(Expression<'r>, Expression<'r>)],
    ) -> Expression<'r> {
        let zero = Expression::constant(0.0);
        let last = of.id(self);
        let rates: Vec<(NodeId, Expression<'r>)> =
            rates.iter().map(|(component, rate)| (component.id(self), *rate)).collect();
        let nodes = self.nodes_until(last);
        let mut is_needed = vec![false; nodes.len()];
        is_needed[last as usize] = true;
        for (place, node) in nodes.iter().enumerate().rev() {
            let is_unknown = matches!(node, Node::Solution { .. });
            if is_needed[place] && !is_unknown {
                node.operands(&[]).iter().for_each(|operand| is_needed[*operand as usize] = true);
            }
        }
        // The operands of a node stand before it; the nodes of the derivative are added behind all of them.
        let mut changes = vec![zero; nodes.len()];
        for (place, node) in (0..).zip(nodes).filter(|(place, _)| is_needed[*place as usize]) {
            let change = |node: NodeId| changes[node as usize];
            let value = |node: NodeId| Expression::node(self, node);
            changes[place as usize] = match node {
                Node::Constant(_) | Node::Discrete(_) => zero,
                Node::Input(_) | Node::State(_) => {
                    rates.iter().find(|(of, _)| *of == place).map_or(zero, |(_, rate)| *rate)
                }
                Node::Sum(a, b) => change(a) + change(b),
                Node::Difference(a, b) => change(a) - change(b),
                Node::Negation(a) => -change(a),
                Node::Product(a, b) => change(a) * value(b) + value(a) * change(b),
                Node::Quotient(a, b) => (change(a) - value(place) * change(b)) / value(b),
                Node::Sine(angle) => value(place + 1) * change(angle),
                Node::Cosine(angle) => -(value(place - 1) * change(angle)),
                Node::SquareRoot(a) => Expression::constant(0.5) * change(a) / value(place),
                Node::Exponential(a) => value(place) * change(a),
                Node::Function(_, a, slope) => change(a) / value(slope),
                Node::Solution { .. } => panic!("a gap or a sliding speed contains an unknown"),
            };
        }
        changes[last as usize]
    }
}
