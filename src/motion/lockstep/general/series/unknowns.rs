//! The unknowns of linear systems, order by order.

use super::{Expansion, TERMS, pairs};
use crate::graph::Cell;
use crate::motion::lockstep::general::elimination::Elimination;
use crate::motion::lockstep::general::operations::{Entry, Slot};

impl Expansion<'_> {
    /// Returns an entry of a matrix at order zero.
    pub(super) fn entry(&mut self, place: usize, entry: &Entry) -> Option<Cell> {
        let mut residual_factor = None;
        let value = match entry {
            Entry::Zero => None,
            Entry::Constant(number) => Some(self.of.constant(*number)),
            Entry::Series { factor, slot, .. } => {
                let factor = self.of.constant(*factor);
                self.term(*slot, 0).map(|cell| self.builder.product(factor, cell))
            }
            Entry::Turned { turning, is_sine, factor, residual, .. } => {
                let [sine, cosine] = [turning.sine, turning.cosine].map(|slot| self.start(slot));
                let factor = self.of.constant(*factor);
                let (own, other) = if *is_sine { (sine, cosine) } else { (cosine, sine) };
                residual_factor = residual.map(|residual| {
                    let residual = self.of.constant(residual);
                    let of_other = self.builder.product(factor, other);
                    let zero = self.builder.number(0.0);
                    let product = [[of_other, residual]];
                    if *is_sine {
                        self.builder.sum(None, &product)
                    } else {
                        self.builder.difference(Some(zero), &product)
                    }
                });
                Some(self.builder.product(factor, own))
            }
        };
        self.own[place].residuals.push(residual_factor);
        value
    }

    /// Computes the coefficients of order `k` of the solution of a linear system, which is factored at order zero.
    pub(super) fn solve(
        &mut self,
        place: usize,
        (matrix, right, out, units): (&[Entry], &[Slot], &[Slot], &[bool]),
        k: usize,
    ) {
        let size = right.len();
        if k == 0 {
            let entries: Vec<_> = matrix.iter().map(|entry| self.entry(place, entry)).collect();
            self.own[place].elimination =
                Some(Elimination::new(&mut self.builder, &entries, units));
        }
        let orders = || (2..k).chain([1, k]).take(k);
        let order = self.builder.number((k + 1) as f64);
        let mut values = Vec::with_capacity(size);
        let mut of_products = Vec::new();
        for (row, &right) in right.iter().enumerate() {
            let mut products = Vec::new();
            for (entry, &solution) in matrix[row * size..][..size].iter().zip(out) {
                let &Entry::Series { factor, slot, product } = entry else { continue };
                let terms = pairs(|j| self.term(slot, j), |j| self.term(solution, j), orders(), k);
                let known = (!terms.is_empty()).then(|| self.builder.sum(None, &terms));
                products.extend(known.map(|known| [self.of.constant(factor), known]));
                of_products.push((product, known, [slot, solution]));
            }
            for (entry, residual) in matrix[row * size..][..size]
                .iter()
                .zip(self.own[place].residuals[row * size..].to_vec())
            {
                let Entry::Turned { turning, is_sine, factor, square, .. } = entry else {
                    continue;
                };
                let ahead = self.ahead[&turning.sine][usize::from(!is_sine)];
                products.extend(
                    ahead.map(|ahead| {
                        [self.of.constant(*factor), self.builder.product(ahead, order)]
                    }),
                );
                products.extend(residual.zip(self.term(*square, k)).map(|(a, b)| [a, b]));
            }
            let start = self.term(right, k);
            values.push(self.rest(start, &products));
        }
        let cells: Vec<Cell> = out.iter().map(|slot| self.of.coefficient(*slot, k)).collect();
        let Some(elimination) = &self.own[place].elimination else { return };
        let not_zero = elimination.substitute(&mut self.builder, &values, &cells);
        for (slot, not_zero) in out.iter().zip(not_zero) {
            self.not_zero[*slot as usize * TERMS + k] = not_zero;
        }
        for (product, known, [entry, solution]) in of_products {
            let last = pairs(|_| self.term(entry, 0), |j| self.term(solution, j), [0], k);
            self.set(product, k, known, &last);
        }
    }
}
