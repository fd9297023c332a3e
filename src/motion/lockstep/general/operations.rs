//! A recorded system as a list of operations on power series.
//!
//! Expressions of inputs alone are numbers that are constant in time (`Static`). What is linear in series with such
//! factors becomes one operation, a linear combination. Operations are sorted so that operands come first, and products
//! that can be computed together stand together.

use super::compiler::compile;
use super::series::Programs;
use super::statics::{StaticId, Statics};
use super::turning::Turning;
use crate::graph::Program;
use crate::model::Graph;

/// The place of a series.
pub(super) type Slot = u32;

/// An operation that computes the next coefficient of one or more series.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Operation {
    /// A constant and a sum of series with constant factors.
    Linear { out: Slot, constant: Option<StaticId>, terms: Vec<(Slot, StaticId)> },
    /// `a b`
    Product { out: Slot, a: Slot, b: Slot },
    /// `a / b`
    Quotient { out: Slot, a: Slot, b: Slot },
    /// Sine and cosine.
    SineCosine { sine: Slot, cosine: Slot, angle: Slot },
    /// Sine and cosine of an angle whose rate is a speed, one order ahead, and their products with the speed.
    Turning(Turning),
    /// Square root.
    SquareRoot { out: Slot, a: Slot },
    /// Exponential.
    Exponential { out: Slot, a: Slot },
    /// Arc tangent; `slope` is `1 + a²`.
    ArcTangent { out: Slot, a: Slot, slope: Slot },
    /// A linear system; the matrix row by row. The unknowns of `units` have the factor 1 on the diagonal and may be
    /// eliminated first.
    Solve { matrix: Vec<Entry>, right: Vec<Slot>, out: Vec<Slot>, units: Vec<bool> },
}

/// An entry of the matrix of a linear system.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Entry {
    Zero,
    Constant(StaticId),
    /// A constant factor times a series. `product` is the product of the series with the unknown.
    Series {
        factor: StaticId,
        slot: Slot,
        product: Slot,
    },
    /// `factor` times sine or cosine. The entry stands for its part of a total derivative
    /// ([`super::turning`]); `residual` is `σ`, and `square` the square of the speed.
    Turned {
        turning: Turning,
        is_sine: bool,
        factor: StaticId,
        residual: Option<StaticId>,
        square: Slot,
    },
}

/// The operations of a recorded system.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Operations {
    pub(super) statics: Statics,
    pub(super) all: Vec<Operation>,
    /// The number of series.
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

impl Operations {
    /// Returns the operations of a recorded system and their programs, with products of sums multiplied out if fewer products
    /// remain.
    pub(super) fn new(graph: &Graph) -> (Self, Programs) {
        let forms = [true, false].map(|expands| {
            let operations = compile(graph, expands);
            let programs = operations.programs();
            (operations, programs)
        });
        let [expanded, plain] = forms;
        let cost = |programs: &Programs| {
            let parts = [&programs.motion, &programs.normals];
            parts.map(Program::cost).iter().sum::<u32>()
        };
        if cost(&expanded.1) <= cost(&plain.1) { expanded } else { plain }
    }
}
