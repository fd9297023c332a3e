//! A recorded system as a list of operations on power series.
//!
//! Expressions of inputs alone are numbers that are constant in time (`Static`). What is linear in series with such
//! factors becomes one operation, a linear combination; products that share an operand become one operation, too.
//! Operations are sorted so that operands come first.

use super::compiler::compile;
use crate::model::Graph;

/// A number that is constant in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Static {
    Constant(f64),
    Input(u32),
    /// A component of the state that only events change.
    Discrete(u32),
    Sum(StaticId, StaticId),
    Difference(StaticId, StaticId),
    Negation(StaticId),
    Product(StaticId, StaticId),
    Quotient(StaticId, StaticId),
    Sine(StaticId),
    Cosine(StaticId),
    SquareRoot(StaticId),
    Exponential(StaticId),
    ArcTangent(StaticId),
}

/// The place of a static number.
pub(super) type StaticId = u32;
/// The place of a series.
pub(super) type Slot = u32;

/// An operation that computes the next coefficient of one or more series.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Operation {
    /// A constant and a sum of series with constant factors.
    Linear { out: Slot, constant: Option<StaticId>, terms: Vec<(Slot, StaticId)> },
    /// Products of one series with others, each with its result; at most [`MOST_PRODUCTS`].
    Products { shared: Slot, others: Vec<(Slot, Slot)> },
    /// `a / b`; `inverse` holds one over the first coefficient of `b`.
    Quotient { out: Slot, a: Slot, b: Slot, inverse: Slot },
    /// Sine and cosine; `rate` holds the coefficients of the angle times their order.
    SineCosine { sine: Slot, cosine: Slot, angle: Slot, rate: Slot },
    /// Square root; `inverse` holds one over twice its first coefficient.
    SquareRoot { out: Slot, a: Slot, inverse: Slot },
    /// Exponential; `rate` holds the coefficients of the operand times their order.
    Exponential { out: Slot, a: Slot, rate: Slot },
    /// Arc tangent; `slope` is `1 + a²`, and `rate` holds the coefficients of the result times their order.
    ArcTangent { out: Slot, a: Slot, slope: Slot, rate: Slot, inverse: Slot },
    /// A linear system; `factors` is the first of `size²` slots with its factors at order 0 and the exchanges of its rows
    /// at order 1.
    Solve { matrix: Vec<Entry>, right: Vec<Slot>, out: Vec<Slot>, factors: Slot },
}

/// An entry of the matrix of a linear system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Entry {
    Constant(StaticId),
    Series(Slot),
}

/// The largest number of products in one operation.
pub(super) const MOST_PRODUCTS: usize = 4;

/// The operations of a recorded system.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Program {
    pub(super) statics: Vec<Static>,
    pub(super) operations: Vec<Operation>,
    pub(super) slots: usize,
    /// The rate of change of each component; the components themselves are the first slots.
    pub(super) rates: Vec<Slot>,
    /// The components whose rates are sums of components with constant factors, such as positions. Their series have
    /// one more coefficient.
    pub(super) kinematic: Vec<(Slot, Vec<(Slot, StaticId)>)>,
    /// Sliding speed, sliding acceleration, normal force and friction force of each contact.
    pub(super) contacts: Vec<[Slot; 4]>,
    /// The function of each event that falls through zero.
    pub(super) guards: Vec<Slot>,
    /// The force in each gap.
    pub(super) gaps: Vec<Slot>,
}

impl Program {
    /// Compiles a recorded system, with products of sums multiplied out if fewer products remain.
    pub(super) fn new(graph: &Graph) -> Self {
        let plain = compile(graph, false);
        let expanded = compile(graph, true);
        if expanded.cost() < plain.cost() { expanded } else { plain }
    }

    /// Returns a measure of the time of an expansion: the number of products, with less for what is linear.
    fn cost(&self) -> usize {
        let of = |operation: &Operation| match operation {
            Operation::Products { others, .. } => 10 * others.len(),
            Operation::Linear { terms, .. } => terms.len() + 1,
            _ => 0,
        };
        self.operations.iter().map(of).sum()
    }

    /// Computes the static numbers from the inputs of a run and its state.
    pub(super) fn statics(&self, inputs: &[f64], state: &[f64], values: &mut Vec<f64>) {
        values.clear();
        for number in &self.statics {
            let at = |id: StaticId| values[id as usize];
            let value = match *number {
                Static::Constant(value) => value,
                Static::Input(index) => inputs[index as usize],
                Static::Discrete(component) => state[component as usize],
                Static::Sum(a, b) => at(a) + at(b),
                Static::Difference(a, b) => at(a) - at(b),
                Static::Negation(a) => -at(a),
                Static::Product(a, b) => at(a) * at(b),
                Static::Quotient(a, b) => at(a) / at(b),
                Static::Sine(a) => libm::sin(at(a)),
                Static::Cosine(a) => libm::cos(at(a)),
                Static::SquareRoot(a) => libm::sqrt(at(a)),
                Static::Exponential(a) => libm::exp(at(a)),
                Static::ArcTangent(a) => libm::atan(at(a)),
            };
            values.push(value);
        }
    }
}
