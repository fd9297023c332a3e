//! A recorded system as a list of operations on power series.
//!
//! Expressions of inputs alone are numbers that are constant in time (`Static`). What is linear in series with such
//! factors becomes one operation, a linear combination. Operations are sorted so that operands come first, and products
//! that can be computed together stand together.

use std::collections::HashMap;

use super::statics::{StaticId, Statics};
use crate::graph::Cell;
use crate::model::Function;
use crate::motion::lockstep::TERMS;

/// The place of a series.
pub(super) type Slot = u32;

/// The number of sums that are computed together.
pub(super) const SIDE_BY_SIDE: usize = 4;

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
    Turning(TurningAngle),
    /// Square root.
    SquareRoot { out: Slot, a: Slot },
    /// Exponential.
    Exponential { out: Slot, a: Slot },
    /// Another function, whose derivative by `a` is `1 / slope`.
    Function { function: Function, out: Slot, a: Slot, slope: Slot },
    /// A linear system; the matrix row by row. The unknowns of `units` have the factor 1 on the diagonal and may be
    /// eliminated first.
    Solve {
        matrix: Vec<MatrixEntry>,
        /// The products of series with unknowns in each row.
        products: Vec<Vec<RowProducts>>,
        right: Vec<Slot>,
        out: Vec<Slot>,
        units: Vec<bool>,
        /// The number of first unknowns that the equations determine.
        determined: usize,
    },
}

/// An angle whose rate is a speed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TurningAngle {
    pub(super) angle: Slot,
    pub(super) speed: Slot,
    /// `κ`; `None` is 1.
    pub(super) switch: Option<StaticId>,
    pub(super) sine: Slot,
    pub(super) cosine: Slot,
    /// `s v`
    pub(super) sine_speed: Slot,
    /// `c v`
    pub(super) cosine_speed: Slot,
}

/// Products of series with unknowns whose factors in a row of a linear system differ at most in their signs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RowProducts {
    pub(super) factor: StaticId,
    /// A series, an unknown, and whether their product is subtracted.
    pub(super) parts: Vec<(Slot, Slot, bool)>,
    /// The sum of the products, without the factor.
    pub(super) sum: Slot,
}

/// An entry of the matrix of a linear system.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum MatrixEntry {
    Zero,
    Constant(StaticId),
    /// A constant factor times a series.
    Series {
        factor: StaticId,
        slot: Slot,
    },
    /// `factor` times sine or cosine. The entry stands for its part of a total derivative
    /// ([`super::turning`]); `residual` is `σ`, and `square` the square of the speed.
    Turned {
        turning: TurningAngle,
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
    /// The inputs that depend on modes, and the parameters: their places, and their numbers among the inputs.
    pub(super) inputs: [Vec<(StaticId, u32)>; 2],
    /// The components that only events change, with the places of their numbers.
    pub(super) discrete: Vec<(StaticId, u32)>,
    pub(super) all: Vec<Operation>,
    /// The number of series.
    pub(super) slots: usize,
    /// The rate of change of each component; the components themselves are the first slots.
    pub(super) rates: Vec<Slot>,
    /// The rates that are zero in a steady motion: those of components that no translation of the system displaces.
    pub(super) settling: Vec<Slot>,
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

/// A number of a contact that its conditions contain.
#[derive(Clone, Copy, Debug)]
pub(super) enum ContactCell {
    /// The first condition of a contact that does not stick is `sign v + offset` with its sliding speed `v`.
    Sign,
    Offset,
    /// 1 if it sticks, else 0.
    Stuck,
    /// Static coefficient of friction.
    Limit,
    /// Slack of the conditions of friction.
    Slack,
    /// Half of the width within which events are located.
    Aim,
}

/// The condition that a closed gap is under pressure is `weight λ + offset`, with the force `λ` in it.
#[derive(Clone, Copy, Debug)]
pub(super) enum GapCell {
    Weight,
    Offset,
}

impl Operations {
    /// Returns the arguments of all exponential functions.
    pub(super) fn exponents(&self) -> Vec<Slot> {
        let of = |operation: &Operation| match operation {
            Operation::Exponential { a, .. } => Some(*a),
            _ => None,
        };
        let mut exponents: Vec<Slot> = self.all.iter().filter_map(of).collect();
        exponents.sort_unstable();
        exponents.dedup();
        exponents
    }

    /// Returns the normal and friction forces of all contacts if a component has a constant rate of change, as the time has. While
    /// all contacts stick, the forces then change, but no velocity does.
    pub(super) fn forces_over_time(&self) -> Vec<Slot> {
        let is_clock = |operation: &Operation| match operation {
            Operation::Linear { out, constant: Some(_), terms } => {
                terms.is_empty() && self.rates.contains(out)
            }
            _ => false,
        };
        let has_clock = self.all.iter().any(is_clock);
        let forces = self.contacts.iter().flat_map(|[_, _, normal, friction]| [*normal, *friction]);
        forces.filter(|_| has_clock).collect()
    }

    /// Returns the place of a coefficient; those of one order stand side by side.
    pub(super) fn coefficient(&self, slot: Slot, k: usize) -> Cell {
        (self.statics.all.len() + k * self.slots + slot as usize) as Cell
    }

    /// Returns the place of the length of a step.
    pub(super) fn length(&self) -> Cell {
        self.coefficient(0, TERMS)
    }

    /// Returns the place of a number of a contact.
    pub(super) fn of_contact(&self, contact: usize, which: ContactCell) -> Cell {
        self.length() + 1 + (contact * 6) as Cell + which as Cell
    }

    /// Returns the place of a number of a gap.
    pub(super) fn of_gap(&self, gap: usize, which: GapCell) -> Cell {
        self.of_contact(self.contacts.len() + gap, ContactCell::Sign) + which as Cell
    }

    /// Returns the number of cells whose meaning is known before programs are made.
    pub(super) fn cells(&self) -> usize {
        self.of_gap(self.gaps.len(), GapCell::Weight) as usize
    }
}

/// Returns the slots that an operation reads at the order that it computes, and those that it writes.
pub(super) fn reads_and_writes(operation: &Operation) -> (Vec<Slot>, Vec<Slot>) {
    match operation {
        Operation::Linear { out, terms, .. } => {
            (terms.iter().map(|(slot, _)| *slot).collect(), vec![*out])
        }
        Operation::Product { out, a, b } | Operation::Quotient { out, a, b } => {
            (vec![*a, *b], vec![*out])
        }
        Operation::SineCosine { sine, cosine, angle } => (vec![*angle], vec![*sine, *cosine]),
        Operation::Turning(of) => {
            (vec![of.angle, of.speed], vec![of.sine, of.cosine, of.sine_speed, of.cosine_speed])
        }
        Operation::SquareRoot { out, a } | Operation::Exponential { out, a } => {
            (vec![*a], vec![*out])
        }
        Operation::Function { out, a, slope, .. } => (vec![*a, *slope], vec![*out]),
        Operation::Solve { matrix, products, right, out, .. } => {
            let entries = matrix.iter().flat_map(|entry| match entry {
                MatrixEntry::Series { slot, .. } => vec![*slot],
                MatrixEntry::Turned { turning, square, .. } => vec![turning.sine_speed, *square],
                MatrixEntry::Zero | MatrixEntry::Constant(_) => Vec::new(),
            });
            let sums = products.iter().flatten().map(|products| products.sum);
            let writes = out.iter().copied().chain(sums).collect();
            (entries.chain(right.iter().copied()).collect(), writes)
        }
    }
}

/// Sorts operations by their depth; components of the state have depth 0.
pub(super) fn sorted(operations: Vec<Operation>, components: u32) -> Vec<Operation> {
    let mut depth: HashMap<Slot, u32> = (0..components).map(|slot| (slot, 0)).collect();
    let mut keyed = Vec::with_capacity(operations.len());
    for operation in operations {
        let (reads, writes) = reads_and_writes(&operation);
        let level = reads.iter().map(|slot| depth.get(slot).copied().unwrap_or(0)).max();
        let level = level.unwrap_or(0);
        for slot in writes {
            depth.insert(slot, level + 1);
        }
        keyed.push((level, !matches!(operation, Operation::Product { .. }), operation));
    }
    keyed.sort_by_key(|(level, is_late, _)| (*level, *is_late));
    keyed.into_iter().map(|(_, _, operation)| operation).collect()
}
