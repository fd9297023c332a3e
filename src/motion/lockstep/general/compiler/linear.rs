//! Linear combinations of series with static factors, and products of sums that are multiplied out.

use super::{Compiler, LinearCombination};
use crate::model::{Node, NodeId};
use crate::motion::lockstep::general::operations::{Operation, RowProducts, Slot};
use crate::motion::lockstep::general::statics::{Static, StaticId};

impl Compiler<'_> {
    /// Returns a node as a linear combination.
    pub(super) fn linear_of(&mut self, place: NodeId) -> LinearCombination {
        let mut sum = LinearCombination::default();
        let one = self.statics.add(Static::Constant(1.0));
        self.linear(place, one, &mut sum);
        sum
    }

    /// Returns the series of a linear combination.
    pub(super) fn emit_linear(&mut self, mut sum: LinearCombination) -> Slot {
        for known in self.in_rows.clone() {
            self.replace(&mut sum, &known);
        }
        let LinearCombination { constant, terms } = sum;
        if let ([(slot, factor)], None) = (terms.as_slice(), constant)
            && self.statics.all[*factor as usize] == Static::Constant(1.0)
        {
            return *slot;
        }
        let out = self.new_slot();
        self.operations.push(Operation::Linear { out, constant, terms });
        out
    }

    /// Replaces the products in a linear combination by their known sum, if they have the same factor.
    fn replace(&mut self, sum: &mut LinearCombination, known: &RowProducts) {
        let mut factors = Vec::with_capacity(known.parts.len());
        for &(a, b, subtracts) in &known.parts {
            let slot = self.pairs.get(&[a.min(b), a.max(b)]);
            let term = sum.terms.iter().find(|term| Some(&term.0) == slot);
            let Some(&(slot, factor)) = term else { return };
            factors.push((slot, if subtracts { self.statics.negative(factor) } else { factor }));
        }
        let factor = factors[0].1;
        if factors.iter().all(|term| term.1 == factor) {
            sum.terms.retain(|term| factors.iter().all(|(slot, _)| term.0 != *slot));
            self.add_term(sum, known.sum, factor);
        }
    }

    /// Adds a node times a static factor to a linear combination.
    pub(super) fn linear(&mut self, place: NodeId, factor: StaticId, sum: &mut LinearCombination) {
        if let Some(number) = self.static_of[place as usize] {
            let part = self.statics.times(number, factor);
            return self.add_constant(sum, part);
        }
        if let Some(slot) = self.slot_of[place as usize] {
            return self.add_term(sum, slot, factor);
        }
        match self.graph.nodes[place as usize] {
            Node::Sum(a, b) => {
                self.linear(a, factor, sum);
                self.linear(b, factor, sum);
            }
            Node::Difference(a, b) => {
                self.linear(a, factor, sum);
                let minus = self.statics.negative(factor);
                self.linear(b, minus, sum);
            }
            Node::Negation(a) => {
                let minus = self.statics.negative(factor);
                self.linear(a, minus, sum);
            }
            Node::Product(a, b) if !self.is_static(a) && !self.is_static(b) => {
                self.multiply_out([a, b], factor, sum);
            }
            Node::Product(a, b) => {
                let (series, number) = match self.static_of[a as usize] {
                    Some(number) => (b, number),
                    None => (a, self.static_of[b as usize].unwrap_or(factor)),
                };
                let factor = self.statics.times(number, factor);
                self.linear(series, factor, sum);
            }
            Node::Quotient(a, b) => {
                let number = self.static_of[b as usize].unwrap_or(factor);
                let factor = self.statics.add(Static::Quotient(factor, number));
                self.linear(a, factor, sum);
            }
            // Everything else has a slot.
            _ => {}
        }
    }

    fn add_constant(&mut self, sum: &mut LinearCombination, part: StaticId) {
        let add = |constant| self.statics.add(Static::Sum(constant, part));
        sum.constant = Some(sum.constant.map_or(part, add));
    }

    fn add_term(&mut self, sum: &mut LinearCombination, slot: Slot, factor: StaticId) {
        match sum.terms.iter().position(|(other, _)| *other == slot) {
            Some(at) => sum.terms[at].1 = self.statics.add(Static::Sum(sum.terms[at].1, factor)),
            None => sum.terms.push((slot, factor)),
        }
    }

    /// Adds the product of two sums times a static factor to a linear combination.
    pub(super) fn multiply_out(
        &mut self,
        factors: [NodeId; 2],
        factor: StaticId,
        sum: &mut LinearCombination,
    ) {
        let [a, b] = factors.map(|place| self.linear_of(place));
        for (constant, other) in [(a.constant, &b), (b.constant, &a)] {
            let Some(constant) = constant else { continue };
            let part = self.statics.times(constant, factor);
            for &(slot, number) in &other.terms {
                let part = self.statics.times(part, number);
                self.add_term(sum, slot, part);
            }
        }
        if let (Some(a), Some(b)) = (a.constant, b.constant) {
            let both = self.statics.times(a, b);
            let part = self.statics.times(both, factor);
            self.add_constant(sum, part);
        }
        for &(left, number) in &a.terms {
            let part = self.statics.times(number, factor);
            for &(right, number) in &b.terms {
                let slot = self.pair([left, right]);
                let part = self.statics.times(part, number);
                self.add_term(sum, slot, part);
            }
        }
    }

    /// Returns the product of two series.
    pub(super) fn pair(&mut self, mut pair: [Slot; 2]) -> Slot {
        pair.sort_unstable();
        if let Some(&slot) = self.pairs.get(&pair) {
            return slot;
        }
        let out = self.new_slot();
        self.pairs.insert(pair, out);
        let [a, b] = pair;
        self.operations.push(Operation::Product { out, a, b });
        out
    }
}
