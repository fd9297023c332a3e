//! Linear systems: accelerations and other unknowns, and the friction that they require.

use super::{Compiler, LinearCombination};
use crate::model::{Node, NodeId};
use crate::motion::lockstep::general::operations::{MatrixEntry, Operation, RowProducts, Slot};
use crate::motion::lockstep::general::statics::{Static, StaticId};

impl Compiler<'_> {
    /// Returns the series of the friction force that a contact requires to stick.
    pub(super) fn required_friction(&mut self, contact: usize) -> Slot {
        let friction = self.graph.contacts[contact][3];
        let mut sum = self.linear_of(friction);
        // Each contact has a switch, which is 0 in stick.
        let switches = &self.graph.switches;
        if switches.len() == self.graph.contacts.len() {
            let switch = self.statics.add(Static::Input(switches[contact]));
            let zero = self.statics.add(Static::Constant(0.0));
            sum.constant = sum.constant.map(|constant| self.statics.with_zero(constant, switch));
            for (_, factor) in &mut sum.terms {
                *factor = self.statics.with_zero(*factor, switch);
            }
            sum.terms.retain(|(_, factor)| *factor != zero);
        }
        self.emit_linear(sum)
    }

    pub(super) fn emit_solve(&mut self, index: u32) {
        let solve = self.graph.solves[index as usize].clone();
        let size = solve.right.len();
        let is_constant =
            |node: NodeId, value: f64| self.graph.nodes[node as usize] == Node::Constant(value);
        let out: Vec<Slot> = (0..size).map(|_| self.new_slot()).collect();
        let mut matrix = Vec::with_capacity(size * size);
        let mut products = Vec::with_capacity(size);
        let mut right = Vec::with_capacity(size);
        for (row, entries) in solve.matrix.chunks(size).enumerate() {
            let mut right_side = self.linear_of(solve.right[row]);
            let mut in_row: Vec<RowProducts> = Vec::new();
            for (column, &node) in (0..).zip(entries) {
                matrix.push(match self.static_of[node as usize] {
                    Some(_) if is_constant(node, 0.0) => MatrixEntry::Zero,
                    Some(number) => MatrixEntry::Constant(number),
                    None => {
                        let (factor, slot) = self.scaled_series(node);
                        let unknown = Node::Solution { solve: index, row: column };
                        match self.total_derivative((slot, factor), unknown, &mut right_side) {
                            Some(turned) => turned,
                            None => {
                                let unknown = out[column as usize];
                                self.add_product(&mut in_row, factor, (slot, unknown));
                                MatrixEntry::Series { factor, slot }
                            }
                        }
                    }
                });
            }
            right.push(self.emit_linear(right_side));
            products.push(in_row);
        }
        for in_row in products.iter_mut().flatten() {
            match in_row.parts[..] {
                [(a, b, _)] => in_row.sum = self.pair_with([a, b]),
                _ => {
                    in_row.sum = self.new_slot();
                    self.in_rows.push(in_row.clone());
                }
            }
        }
        let diagonal = solve.matrix.iter().step_by(size + 1);
        let units = diagonal.map(|node| solve.has_sound_diagonal && is_constant(*node, 1.0));
        let units = units.collect();
        for (place, node) in self.graph.nodes.iter().enumerate() {
            if let Node::Solution { solve, row } = *node
                && solve == index
            {
                self.slot_of[place] = Some(out[row as usize]);
            }
        }
        let determined = solve.determined;
        self.operations.push(Operation::Solve { matrix, products, right, out, units, determined });
    }

    /// Adds the product of a series and an unknown to those of a row.
    fn add_product(
        &mut self,
        in_row: &mut Vec<RowProducts>,
        factor: StaticId,
        (slot, unknown): (Slot, Slot),
    ) {
        let minus = self.statics.negative(factor);
        match in_row.iter_mut().find(|group| group.factor == factor || group.factor == minus) {
            Some(group) => group.parts.push((slot, unknown, group.factor != factor)),
            None => {
                // The place of the sum is not yet known.
                let parts = vec![(slot, unknown, false)];
                in_row.push(RowProducts { factor, parts, sum: Slot::MAX });
            }
        }
    }

    /// Returns a node as a constant factor times a series.
    pub(super) fn scaled_series(&mut self, mut node: NodeId) -> (StaticId, Slot) {
        let mut factor = self.statics.add(Static::Constant(1.0));
        loop {
            let (inner, by) = match self.graph.nodes[node as usize] {
                Node::Negation(a) => (a, self.statics.add(Static::Constant(-1.0))),
                Node::Product(a, b) => match [a, b].map(|place| self.static_of[place as usize]) {
                    [Some(by), _] => (b, by),
                    [_, Some(by)] => (a, by),
                    _ => break,
                },
                _ => break,
            };
            factor = self.statics.times(by, factor);
            node = inner;
        }
        if let Some(slot) = self.slot_of[node as usize] {
            return (factor, slot);
        }
        let sum = self.linear_of(node);
        let slot = self.emit_linear(sum);
        self.slot_of[node as usize] = Some(slot);
        (factor, slot)
    }

    /// Returns the entry of a matrix whose product with an unknown is part of a total derivative (`general::turning`); the
    /// other part leaves the right-hand side.
    pub(super) fn total_derivative(
        &mut self,
        (slot, factor): (Slot, StaticId),
        unknown: Node,
        right: &mut LinearCombination,
    ) -> Option<MatrixEntry> {
        let (turning, nodes) = self.turning.iter().find(|(turning, nodes)| {
            let acceleration = nodes.acceleration.map(|node| self.graph.nodes[node as usize]);
            (slot == turning.sine || slot == turning.cosine) && acceleration == Some(unknown)
        })?;
        let is_sine = slot == turning.sine;
        let other = if is_sine { turning.cosine } else { turning.sine };
        let square = *self.pairs.get(&[turning.speed; 2])?;
        let mut pair = [other, square];
        pair.sort_unstable();
        let product = *self.pairs.get(&pair)?;
        let residual = nodes.residual.and_then(|node| self.static_of[node as usize]);
        let turning = turning.clone();
        let expected = if is_sine { self.statics.negative(factor) } else { factor };
        let place = right.terms.iter().position(|term| *term == (product, expected))?;
        right.terms.remove(place);
        Some(MatrixEntry::Turned { turning, is_sine, factor, residual, square })
    }
}
