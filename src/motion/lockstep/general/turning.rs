//! Angles whose rate of change is a speed, and what follows for sine and cosine.
//!
//! With the angle `a' = κ v`, sine and cosine have the rates `κ c v` and `-κ s v`: their series follow from two products that
//! the equations often contain, too. With `v' = u - σ v` and an unknown acceleration `u`, what a turning mass exerts on its
//! support is a total derivative, whose series follows from the same products one order ahead:
//!
//! ```text
//! s u + c v² = (s v)' + σ c v²        c u - s v² = (c v)' - σ s v²
//! ```
//!
//! without `(s v)' = κ c v² + s (u - σ v)`'s own products. This holds for `κ = 1`, `σ = 0`, and for a switch `κ` of 0 or 1
//! with `σ = 1 - κ`, where the angle is constant while `κ = 0`.

use crate::model::{Graph, Node, NodeId};

/// An angle whose rate is a speed, in a graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TurningNodes {
    /// The component that is the speed.
    pub(super) speed: u32,
    /// The node `κ`.
    pub(super) switch: Option<NodeId>,
    /// The unknown acceleration `u`.
    pub(super) acceleration: Option<NodeId>,
    /// The node `σ`.
    pub(super) residual: Option<NodeId>,
}

impl TurningNodes {
    /// Returns what is known of an angle, if its rate is a speed.
    pub(super) fn of(graph: &Graph, angle: NodeId) -> Option<Self> {
        let node = |id: NodeId| graph.nodes[id as usize];
        let Node::State(angle) = node(angle) else { return None };
        let (speed, switch) = match node(graph.derivative[angle as usize]) {
            Node::State(speed) => (speed, None),
            Node::Product(a, b) => match (node(a), node(b)) {
                (Node::Input(input), Node::State(speed)) if graph.switches.contains(&input) => {
                    (speed, Some(a))
                }
                (Node::State(speed), Node::Input(input)) if graph.switches.contains(&input) => {
                    (speed, Some(b))
                }
                _ => return None,
            },
            _ => return None,
        };
        let is_unknown = |id: NodeId| matches!(node(id), Node::Solution { .. });
        let rate = graph.derivative[speed as usize];
        let is_rest = |id: NodeId| match node(id) {
            Node::Difference(a, b) => node(a) == Node::Constant(1.0) && Some(b) == switch,
            _ => false,
        };
        let (acceleration, residual) = match node(rate) {
            Node::Solution { .. } if switch.is_none() => (Some(rate), None),
            Node::Difference(unknown, rest) if is_unknown(unknown) => match node(rest) {
                Node::Product(a, b) if node(b) == Node::State(speed) && is_rest(a) => {
                    (Some(unknown), Some(a))
                }
                Node::Product(b, a) if node(b) == Node::State(speed) && is_rest(a) => {
                    (Some(unknown), Some(a))
                }
                _ => (None, None),
            },
            _ => (None, None),
        };
        Some(TurningNodes { speed, switch, acceleration, residual })
    }
}
