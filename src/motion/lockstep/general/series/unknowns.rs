//! The unknowns of linear systems, order by order.

use std::collections::HashMap;

use super::expansion::{Convolution, ConvolutionTerms, Expansion};
use crate::graph::{Cell, Product};
use crate::motion::lockstep::TERMS;
use crate::motion::lockstep::general::lu_factors::LuFactors;
use crate::motion::lockstep::general::operations::{MatrixEntry, Operation};

impl Expansion<'_> {
    /// Returns an entry of a matrix at order zero.
    pub(super) fn entry(&mut self, place: usize, entry: &MatrixEntry) -> Option<Cell> {
        let mut residual_factor = None;
        let value = match entry {
            MatrixEntry::Zero => None,
            MatrixEntry::Constant(number) => Some(self.of.constant(*number)),
            MatrixEntry::Series { factor, slot, .. } => {
                let factor = self.of.constant(*factor);
                self.term(*slot, 0).map(|cell| self.builder.product(factor, cell))
            }
            MatrixEntry::Turned { turning, is_sine, factor, residual, .. } => {
                let [sine, cosine] = [turning.sine, turning.cosine].map(|slot| self.start(slot));
                let factor = self.of.constant(*factor);
                let (function, other) = if *is_sine { (sine, cosine) } else { (cosine, sine) };
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
                Some(self.builder.product(factor, function))
            }
        };
        self.lower[place].residuals.push(residual_factor);
        value
    }

    /// Computes the coefficients of order `k` of the solution of a linear system, which is factored at order zero.
    pub(super) fn solve(&mut self, place: usize, operation: &Operation, k: usize) {
        let Operation::Solve { matrix, products: in_rows, right, out, units, determined } =
            operation
        else {
            return;
        };
        let size = right.len();
        if k == 0 {
            let entries: Vec<_> = matrix.iter().map(|entry| self.entry(place, entry)).collect();
            self.lower[place].elimination =
                Some(LuFactors::new(&mut self.builder, &entries, (units, *determined)));
        }
        // The sums without the coefficients of order `k` of the unknowns.
        let mut known = HashMap::new();
        for in_row in in_rows.iter().flatten() {
            let factors = in_row.parts.clone();
            let later = Convolution { factors, terms: ConvolutionTerms::Later, ahead: 0 };
            known.insert(in_row.sum, self.convolution(later, k));
        }
        let order = self.builder.number((k + 1) as f64);
        let mut values = Vec::with_capacity(size);
        for (row, &right) in right.iter().enumerate() {
            let mut products = Vec::new();
            for in_row in &in_rows[row] {
                products
                    .extend(known[&in_row.sum].map(|sum| [self.of.constant(in_row.factor), sum]));
            }
            let residuals = self.lower[place].residuals[row * size..][..size].to_vec();
            for (entry, residual) in matrix[row * size..].iter().zip(residuals) {
                let MatrixEntry::Turned { turning, is_sine, factor, square, .. } = entry else {
                    continue;
                };
                if let Some(ahead) = self.ahead[&turning.sine][usize::from(!is_sine)] {
                    let factor = self.builder.product(self.of.constant(*factor), order);
                    products.push([factor, ahead]);
                }
                products.extend(residual.zip(self.term(*square, k)).map(|(a, b)| [a, b]));
            }
            let start = self.term(right, k);
            values.push(self.rest(start, &products));
        }
        let cells: Vec<Cell> = out.iter().map(|slot| self.of.coefficient(*slot, k)).collect();
        let Some(elimination) = &self.lower[place].elimination else { return };
        let not_zero = elimination.substitute(&mut self.builder, &values, &cells);
        for (slot, not_zero) in out.iter().zip(not_zero) {
            self.not_zero[*slot as usize * TERMS + k] = not_zero;
            self.known[*slot as usize] = k + 1;
        }
        for in_row in in_rows.iter().flatten() {
            let last = in_row.parts.iter().filter_map(|&(entry, solution, subtracts)| {
                let factors = [self.term(entry, 0)?, self.term(solution, k)?];
                Some(Product { factors, subtracts })
            });
            let last: Vec<Product> = last.collect();
            let known = known[&in_row.sum];
            self.known[in_row.sum as usize] = k + 1;
            if known.is_some() || !last.is_empty() {
                let out = self.place(in_row.sum, k);
                self.builder.combine(out, known, last);
            }
        }
    }
}
