//! Numbers that are constant in time: expressions of inputs alone.

use std::collections::HashMap;

use crate::graph::{Builder, Cell, Instruction};
use crate::model::Function;

/// The place of a static number, which is its cell in programs.
pub(super) type StaticId = Cell;

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
    Function(Function, StaticId),
}

/// Static numbers, operands first; equal ones are one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Statics {
    /// The numbers, by their places.
    pub(super) all: Vec<Static>,
    known: HashMap<(u8, u64, u64), StaticId>,
}

impl Statics {
    /// Returns the place of a static number, which is added if it is new.
    pub(super) fn add(&mut self, number: Static) -> StaticId {
        let two = |kind: u8, a: StaticId, b: StaticId| (kind, u64::from(a), u64::from(b));
        let key = match number {
            Static::Constant(value) => (0, value.to_bits(), 0),
            Static::Input(index) => two(1, index, 0),
            Static::Sum(a, b) => two(2, a, b),
            Static::Difference(a, b) => two(3, a, b),
            Static::Negation(a) => two(4, a, 0),
            Static::Product(a, b) => two(5, a, b),
            Static::Quotient(a, b) => two(6, a, b),
            Static::Sine(a) => two(7, a, 0),
            Static::Cosine(a) => two(8, a, 0),
            Static::SquareRoot(a) => two(9, a, 0),
            Static::Function(function, a) => two(20 + function as u8, a, 0),
            Static::Discrete(component) => two(12, component, 0),
        };
        let statics = &mut self.all;
        *self.known.entry(key).or_insert_with(|| {
            statics.push(number);
            statics.len() as StaticId - 1
        })
    }

    /// Returns a product; signs stand outside of products.
    pub(super) fn times(&mut self, a: StaticId, b: StaticId) -> StaticId {
        match [a, b].map(|id| self.all[id as usize]) {
            [Static::Constant(1.0), _] => b,
            [_, Static::Constant(1.0)] => a,
            [Static::Constant(-1.0), _] => self.negative(b),
            [_, Static::Constant(-1.0)] => self.negative(a),
            [Static::Negation(a), _] => {
                let product = self.times(a, b);
                self.negative(product)
            }
            [_, Static::Negation(b)] => {
                let product = self.times(a, b);
                self.negative(product)
            }
            _ => self.add(Static::Product(a, b)),
        }
    }

    pub(super) fn negative(&mut self, a: StaticId) -> StaticId {
        match self.all[a as usize] {
            Static::Constant(value) => self.add(Static::Constant(-value)),
            Static::Negation(of) => of,
            _ => self.add(Static::Negation(a)),
        }
    }

    /// Returns a static number with another one replaced by zero.
    pub(super) fn with_zero(&mut self, number: StaticId, switch: StaticId) -> StaticId {
        let zero = self.add(Static::Constant(0.0));
        if number == switch {
            return zero;
        }
        match self.all[number as usize] {
            Static::Product(a, b) => {
                let [a, b] = [a, b].map(|factor| self.with_zero(factor, switch));
                if a == zero || b == zero { zero } else { self.times(a, b) }
            }
            Static::Negation(a) => {
                let a = self.with_zero(a, switch);
                if a == zero { zero } else { self.negative(a) }
            }
            Static::Difference(a, b) if b == switch => self.with_zero(a, switch),
            _ => number,
        }
    }

    /// Returns the places and numbers of the inputs, and those of the components that only events change.
    pub(super) fn inputs_and_discrete(&self) -> [Vec<(StaticId, u32)>; 2] {
        let mut found = [(); 2].map(|()| Vec::new());
        for (id, number) in (0..).zip(&self.all) {
            match *number {
                Static::Input(input) => found[0].push((id, input)),
                Static::Discrete(component) => found[1].push((id, component)),
                _ => {}
            }
        }
        found
    }

    /// Computes the static numbers that are neither inputs nor components.
    pub(super) fn emit(&self, builder: &mut Builder) {
        for (out, number) in (0..).zip(&self.all) {
            if let Static::Constant(value) = *number {
                builder.define(out, value);
            }
        }
        let one = builder.number(1.0);
        for (out, number) in (0..).zip(&self.all) {
            match *number {
                Static::Constant(_) | Static::Input(_) | Static::Discrete(_) => {}
                Static::Sum(a, b) => builder.set(out, Some(a), false, &[[b, one]]),
                Static::Difference(a, b) => builder.set(out, Some(a), true, &[[b, one]]),
                Static::Negation(a) => builder.set(out, None, true, &[[a, one]]),
                Static::Product(a, b) => builder.set(out, None, false, &[[a, b]]),
                Static::Quotient(of, by) => builder.add(Instruction::Quotient { out, of, by }),
                Static::Sine(of) => {
                    let cosine = builder.cell();
                    builder.add(Instruction::SineCosine { sine: out, cosine, of });
                }
                Static::Cosine(of) => {
                    let sine = builder.cell();
                    builder.add(Instruction::SineCosine { sine, cosine: out, of });
                }
                Static::SquareRoot(of) => builder.add(Instruction::SquareRoot { out, of }),
                Static::Function(function, of) => {
                    builder.add(Instruction::Function { out, function, of });
                }
            }
        }
    }
}
