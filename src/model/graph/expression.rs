//! An expression while a system is recorded: a number, or a node of the recorder, with its derivatives by the state.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::part::needed_by;
use super::{Node, NodeId, Recorder};
use crate::model::{Function, Number};

/// An expression of a recorder, or a number. Sums, products and quotients of numbers are numbers, and neutral elements
/// leave no node.
#[derive(Clone, Copy)]
pub struct Expression<'r>(NumberOrNode<'r>);

#[derive(Clone, Copy)]
enum NumberOrNode<'r> {
    Number(f64),
    Node(&'r Recorder, NodeId),
}

use NumberOrNode::{Node as Recorded, Number as Known};

impl<'r> Expression<'r> {
    pub(super) fn node(recorder: &'r Recorder, node: NodeId) -> Self {
        Expression(Recorded(recorder, node))
    }

    /// Returns the node of this expression in a recorder, which must be its own.
    pub(super) fn id(self, recorder: &Recorder) -> NodeId {
        match self.0 {
            Known(value) => recorder.add(Node::Constant(value)),
            Recorded(_, node) => node,
        }
    }

    /// Returns the number, if this is one.
    pub(in crate::model) fn known(self) -> Option<f64> {
        match self.0 {
            Known(value) => Some(value),
            Recorded(..) => None,
        }
    }

    fn function(self, value: fn(f64) -> f64, node: impl Fn(&Recorder, NodeId) -> NodeId) -> Self {
        match self.0 {
            Known(number) => Number::constant(value(number)),
            Recorded(recorder, id) => Expression::node(recorder, node(recorder, id)),
        }
    }

    fn with(self, other: Self, value: f64, node: fn(NodeId, NodeId) -> Node) -> Self {
        match (self.0, other.0) {
            (Recorded(recorder, _), _) | (_, Recorded(recorder, _)) => {
                let (left, right) = (self.id(recorder), other.id(recorder));
                Expression::node(recorder, recorder.add(node(left, right)))
            }
            _ => Number::constant(value),
        }
    }

    /// Returns the square root.
    pub fn sqrt(self) -> Self {
        self.function(libm::sqrt, |recorder, id| recorder.add(Node::SquareRoot(id)))
    }

    /// Returns the exponential.
    pub fn exp(self) -> Self {
        self.function(libm::exp, |recorder, id| recorder.add(Node::Exponential(id)))
    }

    /// Returns the arc tangent.
    pub fn atan(self) -> Self {
        self.function(libm::atan, |recorder, id| {
            let square = recorder.add(Node::Product(id, id));
            let one = recorder.add(Node::Constant(1.0));
            let slope = recorder.add(Node::Sum(one, square));
            recorder.add(Node::Function(Function::ArcTangent, id, slope))
        })
    }

    /// Returns the natural logarithm.
    pub fn log(self) -> Self {
        self.function(libm::log, |recorder, id| {
            recorder.add(Node::Function(Function::Logarithm, id, id))
        })
    }

    /// Returns this times a power of two. Factors of several calls become one, so that a conversion to other units and back leaves
    /// nothing.
    pub(in crate::model) fn times_power_of_two(self, factor: f64) -> Self {
        if let Recorded(recorder, id) = self.0
            && let Node::Product(known, other) = recorder.node(id)
            && let Node::Constant(earlier) = recorder.node(known)
            && libm::frexp(earlier).0 == 0.5
        {
            return Expression::constant(factor * earlier) * Expression::node(recorder, other);
        }
        Expression::constant(factor) * self
    }
}

impl Add for Expression<'_> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        match (self.known(), other.known()) {
            (Some(0.0), None) => other,
            (None, Some(0.0)) => self,
            (a, b) => self.with(other, a.unwrap_or(0.0) + b.unwrap_or(0.0), Node::Sum),
        }
    }
}

impl Sub for Expression<'_> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        match (self.known(), other.known()) {
            (Some(0.0), None) => -other,
            (None, Some(0.0)) => self,
            (a, b) => self.with(other, a.unwrap_or(0.0) - b.unwrap_or(0.0), Node::Difference),
        }
    }
}

impl Mul for Expression<'_> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        match (self.known(), other.known()) {
            (Some(0.0), None) | (None, Some(0.0)) => Number::constant(0.0),
            (Some(1.0), None) => other,
            (None, Some(1.0)) => self,
            (a, b) => self.with(other, a.unwrap_or(0.0) * b.unwrap_or(0.0), Node::Product),
        }
    }
}

impl Div for Expression<'_> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        match (self.known(), other.known()) {
            (Some(0.0), None) => Number::constant(0.0),
            (None, Some(1.0)) => self,
            (a, b) => self.with(other, a.unwrap_or(0.0) / b.unwrap_or(0.0), Node::Quotient),
        }
    }
}

impl Neg for Expression<'_> {
    type Output = Self;

    fn neg(self) -> Self {
        self.function(|value| -value, |recorder, id| recorder.add(Node::Negation(id)))
    }
}

impl Number for Expression<'_> {
    fn constant(value: f64) -> Self {
        Expression(Known(value))
    }

    fn sin_cos(self) -> (Self, Self) {
        match self.0 {
            Known(value) => {
                let (sine, cosine) = libm::sincos(value);
                (Number::constant(sine), Number::constant(cosine))
            }
            Recorded(recorder, id) => {
                // The cosine comes after the sine.
                let [sine, cosine] = [Node::Sine(id), Node::Cosine(id)].map(|of| recorder.add(of));
                (Expression::node(recorder, sine), Expression::node(recorder, cosine))
            }
        }
    }

    fn reciprocal(self) -> Self {
        Expression(Known(1.0)) / self
    }
}

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
        let is_needed = needed_by(&nodes, &self.0.borrow().solves, [last]);
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
