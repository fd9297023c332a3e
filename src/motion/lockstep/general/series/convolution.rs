//! Sums of products of the coefficients of two series, whose terms are computed early and together.
//!
//! At the start of an order, most terms of all its sums are known, and at the start of an even order, most terms of the next
//! order, too. Sums that are computed side by side share factors, which are loaded once: loads take longer than arithmetic.

use super::expansion::{Convolution, ConvolutionTerms, Expansion, RunningSum};
use crate::graph::{Cell, Product};
use crate::motion::lockstep::ORDER;

impl Expansion<'_> {
    /// Returns a sum; without terms, it is zero.
    pub(super) fn convolution(&mut self, of: Convolution, k: usize) -> Option<Cell> {
        let place = match self.running.iter().position(|running| running.of == of) {
            Some(place) => place,
            None => {
                let sums = vec![(None, vec![0; of.factors.len()]); ORDER + 2];
                self.running.push(RunningSum { of: of.clone(), sums });
                // Sums with a factor in common stand together.
                let factors = |sum: &RunningSum| sum.of.factors[0];
                let key = |sum: &RunningSum| {
                    (sum.of.terms == ConvolutionTerms::Half, factors(sum).1, factors(sum).0)
                };
                self.running.sort_by_key(key);
                self.running.iter().position(|running| running.of == of).unwrap_or(0)
            }
        };
        self.add_known(place, k + of.ahead);
        self.running[place].sums[k + of.ahead].0
    }

    /// Adds the known terms of all sums of an order, and at even orders those of the next order.
    pub(super) fn begin_order(&mut self, k: usize) {
        for place in 0..self.running.len() {
            let n = k + self.running[place].of.ahead;
            self.add_known(place, n);
            if k.is_multiple_of(2) && k + 1 < ORDER {
                self.add_known(place, n + 1);
            }
        }
    }

    /// Adds the terms that have become known, those with the lowest `n - j` first.
    fn add_known(&mut self, place: usize, n: usize) {
        let RunningSum { of: Convolution { factors, terms, .. }, sums } = &self.running[place];
        let (start, mut added) = sums[n].clone();
        let orders = match terms {
            ConvolutionTerms::All => 0..n + 1,
            ConvolutionTerms::Later => 1..n + 1,
            ConvolutionTerms::Half => 0..n.div_ceil(2),
        };
        let mut products = Vec::new();
        for j in orders.rev() {
            for (&(a, b, subtracts), added) in factors.iter().zip(&mut added) {
                let is_known = self.known[a as usize] > j && self.known[b as usize] > n - j;
                if is_known && *added & 1 << j == 0 {
                    *added |= 1 << j;
                    let factors = self.term(a, j).zip(self.term(b, n - j));
                    products.extend(factors.map(|(a, b)| Product { factors: [a, b], subtracts }));
                }
            }
        }
        let sum = match products.is_empty() {
            true => start,
            false => {
                let out = self.builder.cell();
                self.builder.combine(out, start, products);
                Some(out)
            }
        };
        self.running[place].sums[n] = (sum, added);
    }
}
