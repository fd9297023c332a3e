//! The coefficients of all series that a program computes, as far as they are known, and sums of their products, whose terms
//! are computed early and together.
//!
//! At the start of an order, most terms of all its sums are known, and at the start of an even order, most terms of the next
//! order, too. Sums that are computed side by side share factors, which are loaded once: loads take longer than arithmetic.

use std::collections::HashMap;

use crate::graph::{Builder, Cell, Product};
use crate::motion::lockstep::general::lu_factors::LuFactors;
use crate::motion::lockstep::general::operations::{Operation, Operations, Slot};
use crate::motion::lockstep::general::statics::StaticId;
use crate::motion::lockstep::{ORDER, TERMS};

/// A sum of `a_j b_(n-j)`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Convolution {
    /// `a`, `b`, and whether their product is subtracted.
    pub(super) factors: Vec<(Slot, Slot, bool)>,
    pub(super) terms: ConvolutionTerms,
    /// `n` less the order at which the sum is used.
    pub(super) ahead: usize,
}

/// The terms of a sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ConvolutionTerms {
    All,
    /// Those without `a_0`.
    Later,
    /// Those with `j < n - j`: half of the terms of a square.
    Half,
}

/// A sum with the terms that have been added.
pub(super) struct RunningSum {
    of: Convolution,
    /// For each `n`: the sum, and for each pair of factors the `j` of its terms as a bit mask.
    sums: Vec<(Option<Cell>, Vec<u32>)>,
}

impl Convolution {
    /// The product of two series.
    pub(super) fn of(a: Slot, b: Slot, terms: ConvolutionTerms) -> Self {
        Convolution { factors: vec![(a, b, false)], terms, ahead: 0 }
    }
}

/// What an operation knows from lower orders.
#[derive(Default)]
pub(super) struct LowerOrders {
    /// One over the first coefficient of a divisor, or one over twice that of a root.
    pub(super) inverse: Option<Cell>,
    /// Coefficients times their order.
    pub(super) rate: Vec<Option<Cell>>,
    pub(super) elimination: Option<LuFactors>,
    /// For each entry of a matrix, the factor of the square of a speed that is a residual.
    pub(super) residuals: Vec<Option<Cell>>,
}

pub(super) struct Expansion<'o> {
    pub(super) of: &'o Operations,
    pub(super) builder: Builder,
    /// Whether a coefficient may differ from zero.
    pub(super) not_zero: Vec<bool>,
    pub(super) lower: Vec<LowerOrders>,
    /// By the sine of a turning angle: the next coefficients of the products of sine and cosine with the speed, without
    /// those that contain the coefficient of the speed.
    pub(super) ahead: HashMap<Slot, [Option<Cell>; 2]>,
    /// The number of coefficients of each series that are known.
    pub(super) known: Vec<usize>,
    pub(super) running: Vec<RunningSum>,
}

/// The pairs of a sum of `a_j b_(k-j)` for `j` in `orders`.
pub(super) fn pairs(
    a: impl Fn(usize) -> Option<Cell>,
    b: impl Fn(usize) -> Option<Cell>,
    orders: impl IntoIterator<Item = usize>,
    k: usize,
) -> Vec<[Cell; 2]> {
    let pair = |j: usize| Some([a(j)?, b(k - j)?]);
    orders.into_iter().filter_map(pair).collect()
}

impl Expansion<'_> {
    /// Returns a coefficient unless it is zero.
    pub(super) fn term(&self, slot: Slot, k: usize) -> Option<Cell> {
        self.not_zero[slot as usize * TERMS + k].then(|| self.of.coefficient(slot, k))
    }

    /// Returns the place of a coefficient that is not zero.
    pub(super) fn place(&mut self, slot: Slot, k: usize) -> Cell {
        self.not_zero[slot as usize * TERMS + k] = true;
        self.known[slot as usize] = k + 1;
        self.of.coefficient(slot, k)
    }

    /// Sets a coefficient to a start plus products; without any, it is zero.
    pub(super) fn set(
        &mut self,
        slot: Slot,
        k: usize,
        start: Option<Cell>,
        products: &[[Cell; 2]],
    ) {
        self.known[slot as usize] = k + 1;
        if start.is_some() || !products.is_empty() {
            let out = self.place(slot, k);
            self.builder.set(out, start, false, products);
        }
    }

    /// Sets the coefficient of order `k` to `factor (start - products)`; without any of both, it is zero.
    pub(super) fn set_rest(
        &mut self,
        (slot, k): (Slot, usize),
        start: Option<Cell>,
        products: &[[Cell; 2]],
        factor: Cell,
    ) {
        if let Some(rest) = self.rest(start, products) {
            self.set(slot, k, None, &[[rest, factor]]);
        }
    }

    /// Returns a start minus products.
    pub(super) fn rest(&mut self, start: Option<Cell>, products: &[[Cell; 2]]) -> Option<Cell> {
        if products.is_empty() { start } else { Some(self.builder.difference(start, products)) }
    }

    /// Sets the coefficients `k + 1` of the components from their rates of change.
    pub(super) fn next_state(&mut self, k: usize) {
        let part = self.builder.number(1.0 / (k + 1) as f64);
        for (component, &rate) in (0..).zip(&self.of.rates) {
            // One product by a static number, which is computed once, instead of two.
            let single = self.of.all.iter().find_map(|operation| match operation {
                Operation::Linear { out, constant: None, terms } if *out == rate => match terms[..]
                {
                    [(slot, factor)] => Some((slot, factor)),
                    _ => None,
                },
                _ => None,
            });
            let product = match single {
                Some((slot, factor)) => {
                    self.term(slot, k).map(|term| [self.builder.product(factor, part), term])
                }
                None => self.term(rate, k).map(|rate| [rate, part]),
            };
            self.set(component, k + 1, None, product.as_slice());
        }
    }

    /// Sets the last coefficients of the components whose rates are sums of components.
    pub(super) fn last_of_positions(&mut self) {
        let part = self.builder.number(1.0 / (ORDER + 1) as f64);
        for (component, terms) in &self.of.kinematic {
            let products = self.linear(terms, ORDER);
            if !products.is_empty() {
                let rate = self.builder.sum(None, &products);
                self.set(*component, ORDER + 1, None, &[[rate, part]]);
            }
        }
    }

    pub(super) fn linear(&self, terms: &[(Slot, StaticId)], k: usize) -> Vec<[Cell; 2]> {
        let product = |(slot, factor): &(Slot, StaticId)| Some([*factor, self.term(*slot, k)?]);
        terms.iter().filter_map(product).collect()
    }

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
