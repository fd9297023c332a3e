//! The rules of operations: the coefficient of order `k` of each result.

use std::collections::HashMap;

use super::expansion::{Convolution, ConvolutionTerms, Expansion, pairs};
use crate::graph::{Cell, Instruction, Product};
use crate::model::Function;
use crate::motion::lockstep::TERMS;
use crate::motion::lockstep::general::lu_factors::LuFactors;
use crate::motion::lockstep::general::operations::{MatrixEntry, Operation, Slot, TurningAngle};

impl Expansion<'_> {
    /// Returns the coefficient of order `k` times `k`, which is kept.
    fn rate(&mut self, place: usize, slot: Slot, k: usize) {
        let factor = self.builder.number(k as f64);
        let rate = self.term(slot, k).map(|cell| self.builder.product(factor, cell));
        self.lower[place].rate.resize(k, None);
        self.lower[place].rate.push(rate);
    }

    /// Returns `rate_j b_(k-j)` for `j` from 1 to `most`.
    fn integral(&self, place: usize, b: Slot, most: usize, k: usize) -> Vec<[Cell; 2]> {
        pairs(|j| self.lower[place].rate[j], |j| self.term(b, j), 1..=most, k)
    }

    pub(super) fn apply(&mut self, place: usize, operation: &Operation, k: usize) {
        let one = self.builder.number(1.0);
        match operation {
            Operation::Linear { out, constant, terms } => {
                let start = constant.filter(|_| k == 0);
                let products = self.linear(terms, k);
                self.set(*out, k, start, &products);
            }
            Operation::Product { out, a, b } if a == b && k > 0 => {
                let half = Convolution::of(*a, *b, ConvolutionTerms::Half);
                let half = self.convolution(half, k);
                let two = self.builder.number(2.0);
                let middle = self.term(*a, k / 2).filter(|_| k.is_multiple_of(2));
                let products = half.map(|half| [half, two]).into_iter();
                let products: Vec<_> = products.chain(middle.map(|cell| [cell; 2])).collect();
                self.set(*out, k, None, &products);
            }
            Operation::Product { out, a, b } => {
                let all = Convolution::of(*a, *b, ConvolutionTerms::All);
                let sum = self.convolution(all, k);
                self.set(*out, k, sum, &[]);
            }
            &Operation::SineCosine { sine, cosine, angle } => {
                if k == 0 {
                    let of = self.start(angle);
                    let [sine, cosine] = [sine, cosine].map(|slot| self.place(slot, 0));
                    self.builder.add(Instruction::SineCosine { sine, cosine, of });
                    return;
                }
                self.rate(place, angle, k);
                let [of_sine, of_cosine] =
                    [cosine, sine].map(|other| self.integral(place, other, k, k));
                let part = self.builder.number(1.0 / k as f64);
                if !of_sine.is_empty() {
                    let sum = self.builder.sum(None, &of_sine);
                    self.set(sine, k, None, &[[sum, part]]);
                }
                self.set_rest((cosine, k), None, &of_cosine, part);
            }
            Operation::Turning(turning) => self.turn(turning, k),
            &Operation::Quotient { out, a, b } => {
                if k == 0 {
                    let by = self.start(b);
                    self.lower[place].inverse = Some(self.builder.quotient(one, by));
                }
                let known = pairs(|j| self.term(out, j), |j| self.term(b, j), 0..k, k);
                let inverse = self.lower[place].inverse.unwrap_or(one);
                self.set_rest((out, k), self.term(a, k), &known, inverse);
            }
            &Operation::SquareRoot { out, a } => {
                if k == 0 {
                    let of = self.start(a);
                    let root = self.place(out, 0);
                    self.builder.add(Instruction::SquareRoot { out: root, of });
                    let half = self.builder.number(0.5);
                    self.lower[place].inverse = Some(self.builder.quotient(half, root));
                    return;
                }
                let known = pairs(|j| self.term(out, j), |j| self.term(out, j), 1..k, k);
                let inverse = self.lower[place].inverse.unwrap_or(one);
                self.set_rest((out, k), self.term(a, k), &known, inverse);
            }
            &Operation::Exponential { out, a } => {
                if k == 0 {
                    self.begin(out, Function::Exponential, a);
                    return;
                }
                self.rate(place, a, k);
                let products = self.integral(place, out, k, k);
                if !products.is_empty() {
                    let sum = self.builder.sum(None, &products);
                    let part = self.builder.number(1.0 / k as f64);
                    self.set(out, k, None, &[[sum, part]]);
                }
            }
            &Operation::Function { function, out, a, slope } => {
                if k == 0 {
                    self.begin(out, function, a);
                    let by = self.start(slope);
                    self.lower[place].inverse = Some(self.builder.quotient(one, by));
                    self.lower[place].rate.push(None);
                    return;
                }
                let known = self.integral(place, slope, k - 1, k);
                let known = (!known.is_empty()).then(|| self.builder.sum(None, &known));
                let part = self.builder.number(1.0 / k as f64);
                let products: Vec<_> = known.map(|known| [known, part]).into_iter().collect();
                let inverse = self.lower[place].inverse.unwrap_or(one);
                self.set_rest((out, k), self.term(a, k), &products, inverse);
                self.rate(place, out, k);
            }
            Operation::Solve { .. } => self.solve(place, operation, k),
        }
    }

    /// Computes the products of sine and cosine with the speed, and the next coefficients of sine and cosine.
    fn turn(&mut self, turning: &TurningAngle, k: usize) {
        let TurningAngle { angle, speed, switch, sine, cosine, sine_speed, cosine_speed } =
            *turning;
        if k == 0 {
            let of = self.start(angle);
            let [sine, cosine] = [sine, cosine].map(|slot| self.place(slot, 0));
            self.builder.add(Instruction::SineCosine { sine, cosine, of });
        }
        let ahead = self.ahead.remove(&sine).unwrap_or_default();
        let part = self.builder.number(1.0 / (k + 1) as f64);
        let both = [(sine, sine_speed, cosine), (cosine, cosine_speed, sine)];
        for ((of, product, other), ahead) in both.into_iter().zip(ahead) {
            let now = pairs(|j| self.term(of, j), |j| self.term(speed, j), [0], k);
            self.set(product, k, ahead, &now);
            let Some(product) = self.term(product, k) else { continue };
            let factors = match switch {
                Some(switch) => [product, self.builder.product(switch, part)],
                None => [product, part],
            };
            let next = self.place(other, k + 1);
            // The cosine falls where the sine times the speed is positive.
            self.builder.set(next, None, of == sine, &[factors]);
        }
        let ahead = [sine, cosine].map(|a| {
            let later = Convolution::of(a, speed, ConvolutionTerms::Later);
            self.convolution(Convolution { ahead: 1, ..later }, k)
        });
        self.ahead.insert(sine, ahead);
    }

    /// Returns the coefficient of order zero.
    pub(super) fn start(&mut self, slot: Slot) -> Cell {
        self.term(slot, 0).unwrap_or_else(|| self.builder.number(0.0))
    }

    fn begin(&mut self, out: Slot, function: Function, of: Slot) {
        let of = self.start(of);
        let out = self.place(out, 0);
        self.builder.add(Instruction::Function { out, function, of });
    }

    /// Returns an entry of a matrix at order zero.
    fn entry(&mut self, place: usize, entry: &MatrixEntry) -> Option<Cell> {
        let mut residual_factor = None;
        let value = match entry {
            MatrixEntry::Zero => None,
            MatrixEntry::Constant(number) => Some(*number),
            MatrixEntry::Series { factor, slot, .. } => {
                self.term(*slot, 0).map(|cell| self.builder.product(*factor, cell))
            }
            MatrixEntry::Turned { turning, is_sine, factor, residual, .. } => {
                let [sine, cosine] = [turning.sine, turning.cosine].map(|slot| self.start(slot));
                let (function, other) = if *is_sine { (sine, cosine) } else { (cosine, sine) };
                residual_factor = residual.map(|residual| {
                    let of_other = self.builder.product(*factor, other);
                    let zero = self.builder.number(0.0);
                    let product = [[of_other, residual]];
                    if *is_sine {
                        self.builder.sum(None, &product)
                    } else {
                        self.builder.difference(Some(zero), &product)
                    }
                });
                Some(self.builder.product(*factor, function))
            }
        };
        self.lower[place].residuals.push(residual_factor);
        value
    }

    /// Computes the coefficients of order `k` of the solution of a linear system, which is factored at order zero.
    fn solve(&mut self, place: usize, operation: &Operation, k: usize) {
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
                products.extend(known[&in_row.sum].map(|sum| [in_row.factor, sum]));
            }
            let residuals = self.lower[place].residuals[row * size..][..size].to_vec();
            for (entry, residual) in matrix[row * size..].iter().zip(residuals) {
                let MatrixEntry::Turned { turning, is_sine, factor, square, .. } = entry else {
                    continue;
                };
                if let Some(ahead) = self.ahead[&turning.sine][usize::from(!is_sine)] {
                    let factor = self.builder.product(*factor, order);
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
