//! Power series of all expressions of a recorded system in all lanes, order by order, and their first-order changes.
//!
//! Each operation has a rule that gives the coefficient of order `k` of its result from those of its operands up to `k`
//! and its own below `k` (Å. Jorba, M. Zou, Exp. Math. 14 (2005) 99, doi:10.1080/10586458.2005.10128904). The change of
//! the coefficient along a displacement follows from the derivative of the rule. In a sum, the coefficients that were
//! computed last come last, to avoid waiting for them.

use fearless_simd::{mask64x8, prelude::*};

use super::program::{Entry, Operation, Program, Slot};
use crate::motion::evaluator::SMALL_PIVOT;
use crate::motion::lockstep::trigonometry::sin_cos;
use crate::motion::lockstep::vector::{Fused, Vector};
use crate::motion::lockstep::{LANES, Lanes, ORDER};

/// Coefficients of a series.
pub(super) const TERMS: usize = ORDER + 2;

/// The coefficients of all series of all lanes.
pub(super) struct Series<S: Vector> {
    simd: S,
    terms: Vec<Lanes<S>>,
}

impl<S: Vector> Series<S> {
    pub(super) fn zero(simd: S, slots: usize) -> Self {
        Series { simd, terms: vec![Lanes::splat(simd, 0.0); slots * TERMS] }
    }

    /// Returns the coefficients of a series, from order zero.
    #[inline(always)]
    pub(super) fn of(&self, slot: Slot) -> &[Lanes<S>] {
        &self.terms[slot as usize * TERMS..][..TERMS]
    }

    #[inline(always)]
    fn get(&self, slot: Slot, k: usize) -> Lanes<S> {
        self.terms[slot as usize * TERMS + k]
    }

    #[inline(always)]
    fn set(&mut self, slot: Slot, k: usize, value: Lanes<S>) {
        self.terms[slot as usize * TERMS + k] = value;
    }

    #[inline(always)]
    fn number(&self, value: f64) -> Lanes<S> {
        Lanes::splat(self.simd, value)
    }

    /// Sets the state at the start of a step.
    #[inline(always)]
    pub(super) fn start(&mut self, components: &[Lanes<S>]) {
        for (slot, value) in components.iter().enumerate() {
            self.terms[slot * TERMS] = *value;
        }
    }

    /// Sets the coefficients `k + 1` of the components from their rates of change.
    #[inline(always)]
    fn next_state(&mut self, rates: &[Slot], k: usize) {
        let part = self.number(1.0 / (k + 1) as f64);
        for (component, &rate) in rates.iter().enumerate() {
            let next = self.get(rate, k) * part;
            self.set(component as Slot, k + 1, next);
        }
    }

    /// Expands the motion from the state at order zero.
    #[inline(always)]
    pub(super) fn expand(&mut self, program: &Program, constants: &[Lanes<S>]) {
        for k in 0..ORDER {
            self.order(program, constants, k);
            self.next_state(&program.rates, k);
        }
        self.last_of_positions(program, constants);
    }

    /// Sets the last coefficients of the components whose rates are sums of components.
    #[inline(always)]
    fn last_of_positions(&mut self, program: &Program, constants: &[Lanes<S>]) {
        let part = self.number(1.0 / (ORDER + 1) as f64);
        for (component, terms) in &program.kinematic {
            let mut rate = self.number(0.0);
            for (slot, factor) in terms {
                rate = constants[*factor as usize].fused(self.get(*slot, ORDER), rate);
            }
            self.set(*component, ORDER + 1, rate * part);
        }
    }

    #[inline(never)]
    fn order(&mut self, program: &Program, constants: &[Lanes<S>], k: usize) {
        self.simd.vectorize(
            #[inline(always)]
            || {
                for operation in &program.operations {
                    self.apply(operation, constants, k);
                }
            },
        );
    }

    /// Returns the sum of `a_j b_(k-j)` for `j` from `from` up to and without `to`.
    #[inline(always)]
    fn sum(&self, a: Slot, b: Slot, from: usize, to: usize, k: usize) -> Lanes<S> {
        convolution(self, a, self, b, from, to, k)
    }

    #[inline(always)]
    fn apply(&mut self, operation: &Operation, constants: &[Lanes<S>], k: usize) {
        match operation {
            Operation::Products { shared, others } => match *others.as_slice() {
                [one] => self.products(*shared, [one], k),
                [one, two] => self.products(*shared, [one, two], k),
                [one, two, three] => self.products(*shared, [one, two, three], k),
                [one, two, three, four] => self.products(*shared, [one, two, three, four], k),
                _ => {}
            },
            Operation::Linear { out, constant, terms } => {
                let mut sum = match constant {
                    Some(constant) if k == 0 => constants[*constant as usize],
                    _ => self.number(0.0),
                };
                for (slot, factor) in terms {
                    sum = constants[*factor as usize].fused(self.get(*slot, k), sum);
                }
                self.set(*out, k, sum);
            }
            Operation::Solve { matrix, right, out, factors } => {
                self.solve((matrix, right, out, *factors), constants, k);
            }
            &Operation::SineCosine { sine, cosine, angle, rate } => {
                let of_angle = self.get(angle, k);
                if k == 0 {
                    let (s, c) = sin_cos(of_angle);
                    self.set(sine, 0, s);
                    self.set(cosine, 0, c);
                    return;
                }
                self.set(rate, k, of_angle * self.number(k as f64));
                let part = self.number(1.0 / k as f64);
                let s = self.sum(rate, cosine, 1, k + 1, k) * part;
                let c = -(self.sum(rate, sine, 1, k + 1, k) * part);
                self.set(sine, k, s);
                self.set(cosine, k, c);
            }
            &Operation::Quotient { out, a, b, inverse } => {
                if k == 0 {
                    let one = self.number(1.0) / self.get(b, 0);
                    self.set(inverse, 0, one);
                }
                let known = self.sum(out, b, 0, k, k);
                let value = (self.get(a, k) - known) * self.get(inverse, 0);
                self.set(out, k, value);
            }
            &Operation::SquareRoot { out, a, inverse } => {
                if k == 0 {
                    let root = self.get(a, 0).sqrt();
                    self.set(out, 0, root);
                    self.set(inverse, 0, self.number(0.5) / root);
                    return;
                }
                let known = self.sum(out, out, 1, k, k);
                let value = (self.get(a, k) - known) * self.get(inverse, 0);
                self.set(out, k, value);
            }
            &Operation::Exponential { out, a, rate } => {
                let of_a = self.get(a, k);
                if k == 0 {
                    self.set(out, 0, each(of_a, libm::exp));
                    return;
                }
                self.set(rate, k, of_a * self.number(k as f64));
                let value = self.sum(rate, out, 1, k + 1, k) * self.number(1.0 / k as f64);
                self.set(out, k, value);
            }
            &Operation::ArcTangent { out, a, slope, rate, inverse } => {
                let of_a = self.get(a, k);
                if k == 0 {
                    self.set(out, 0, each(of_a, libm::atan));
                    self.set(inverse, 0, self.number(1.0) / self.get(slope, 0));
                    return;
                }
                let known = self.sum(rate, slope, 1, k, k) * self.number(1.0 / k as f64);
                let value = (of_a - known) * self.get(inverse, 0);
                self.set(out, k, value);
                self.set(rate, k, value * self.number(k as f64));
            }
        }
    }

    #[inline(always)]
    fn products<const M: usize>(&mut self, shared: Slot, others: [(Slot, Slot); M], k: usize) {
        let a = &self.of(shared)[..=k];
        let of_others = others.map(|(other, _)| &self.of(other)[..=k]);
        let mut sums = [self.number(0.0); M];
        for j in 1..k {
            for (sum, b) in sums.iter_mut().zip(of_others) {
                *sum = a[j].fused(b[k - j], *sum);
            }
        }
        for (sum, b) in sums.iter_mut().zip(of_others) {
            if k > 0 {
                *sum = a[0].fused(b[k], *sum);
            }
            *sum = a[k].fused(b[0], *sum);
        }
        for ((_, out), sum) in others.into_iter().zip(sums) {
            self.set(out, k, sum);
        }
    }

    /// Computes the coefficients of order `k` of the solution of a linear system, which is factored at order zero.
    #[inline(always)]
    fn solve(
        &mut self,
        (matrix, right, out, factors): (&[Entry], &[Slot], &[Slot], Slot),
        constants: &[Lanes<S>],
        k: usize,
    ) {
        let size = right.len();
        if k == 0 {
            self.factor(matrix, constants, size, factors);
        }
        for (row, &right) in right.iter().enumerate() {
            let mut value = self.get(right, k);
            for (column, &solution) in out.iter().enumerate() {
                if let Entry::Series(entry) = matrix[row * size + column] {
                    value -= self.sum(entry, solution, 1, k + 1, k);
                }
            }
            self.set(out[row], k, value);
        }
        self.substitute(None, out, factors, k);
    }

    /// Factors the matrix of a linear system: `L U` of its rows in another order, with the inverse of the diagonal of `U`.
    /// Rows with small pivots are exchanged ([`SMALL_PIVOT`]). At order 1, the factors hold 1 below the diagonal in the lanes
    /// in which row and column are exchanged, scales of the rows on the diagonal, and first whether there are exchanges.
    #[inline(always)]
    fn factor(&mut self, matrix: &[Entry], constants: &[Lanes<S>], size: usize, factors: Slot) {
        let place = |row: usize, column: usize| factors + (row * size + column) as Slot;
        for (i, entry) in matrix.iter().enumerate() {
            let value = match *entry {
                Entry::Constant(number) => constants[number as usize],
                Entry::Series(slot) => self.get(slot, 0),
            };
            self.set(factors + i as Slot, 0, value);
        }
        let [zero, one] = [0.0, 1.0].map(|value| self.number(value));
        for row in 0..size {
            let mut scale = zero;
            for column in 0..size {
                scale = scale.max(self.get(place(row, column), 0).abs());
            }
            self.set(place(row, row), 1, scale);
        }
        let mut any = zero;
        for column in 0..size {
            for row in column + 1..size {
                let [scale, of_other] = [column, row].map(|row| self.get(place(row, row), 1));
                let [pivot, other] = [column, row].map(|row| self.get(place(row, column), 0));
                let least = self.number(SMALL_PIVOT) * other.abs() * scale;
                let small = (pivot.abs() * of_other).simd_lt(least);
                self.set(place(row, column), 1, small.select(one, zero));
                if small.to_bitmask() != 0 {
                    any = one;
                    for j in 0..size {
                        self.exchange([place(row, j), place(column, j)], 0, small);
                    }
                    self.exchange([place(row, row), place(column, column)], 1, small);
                }
            }
            let inverse = self.number(1.0) / self.get(place(column, column), 0);
            self.set(place(column, column), 0, inverse);
            for row in column + 1..size {
                let factor = self.get(place(row, column), 0) * inverse;
                self.set(place(row, column), 0, factor);
                for j in column + 1..size {
                    let value = self.get(place(row, j), 0);
                    let above = self.get(place(column, j), 0);
                    self.set(place(row, j), 0, (-factor).fused(above, value));
                }
            }
        }
        self.set(factors, 1, any);
    }

    /// Exchanges two coefficients in some lanes.
    #[inline(always)]
    fn exchange(&mut self, slots: [Slot; 2], k: usize, lanes: mask64x8<S>) {
        let [one, other] = slots.map(|slot| self.get(slot, k));
        self.set(slots[0], k, lanes.select(other, one));
        self.set(slots[1], k, lanes.select(one, other));
    }

    /// Replaces the right-hand sides in `out` by the solution; the factors are those of this series or of another one
    /// of the same program.
    #[inline(always)]
    fn substitute(&mut self, other: Option<&Self>, out: &[Slot], factors: Slot, k: usize) {
        let size = out.len();
        let at_order = |own: &Self, row: usize, column: usize, order: usize| {
            other.unwrap_or(own).get(factors + (row * size + column) as Slot, order)
        };
        let entry = |own: &Self, row: usize, column: usize| at_order(own, row, column, 0);
        if at_order(self, 0, 0, 1)[0] != 0.0 {
            for column in 0..size {
                for row in column + 1..size {
                    let exchanged = at_order(self, row, column, 1).simd_gt(self.number(0.0));
                    self.exchange([out[row], out[column]], k, exchanged);
                }
            }
        }
        for row in 0..size {
            let mut value = self.get(out[row], k);
            for (column, &solution) in out[..row].iter().enumerate() {
                let factor = -entry(self, row, column);
                value = factor.fused(self.get(solution, k), value);
            }
            self.set(out[row], k, value);
        }
        for row in (0..size).rev() {
            let mut value = self.get(out[row], k);
            for (column, &solution) in out.iter().enumerate().skip(row + 1) {
                let factor = -entry(self, row, column);
                value = factor.fused(self.get(solution, k), value);
            }
            let value = value * entry(self, row, row);
            self.set(out[row], k, value);
        }
    }
}

/// The changes of all series along a displacement of the state, to first order.
impl<S: Vector> Series<S> {
    /// Expands the displacement at order zero of this series, from the expanded motion.
    #[inline(always)]
    pub(super) fn expand_displacement(
        &mut self,
        program: &Program,
        constants: &[Lanes<S>],
        motion: &Series<S>,
    ) {
        for k in 0..ORDER {
            self.order_of_displacement(program, constants, motion, k);
            self.next_state(&program.rates, k);
        }
        self.last_of_positions(program, constants);
    }

    #[inline(never)]
    fn order_of_displacement(
        &mut self,
        program: &Program,
        constants: &[Lanes<S>],
        motion: &Series<S>,
        k: usize,
    ) {
        self.simd.vectorize(
            #[inline(always)]
            || {
                for operation in &program.operations {
                    self.displace(operation, constants, motion, k);
                }
            },
        );
    }

    #[inline(always)]
    fn change_of_products<const M: usize>(
        &mut self,
        motion: &Series<S>,
        shared: Slot,
        others: [(Slot, Slot); M],
        k: usize,
    ) {
        let [a, change_of_a] = [motion, &*self].map(|series| &series.of(shared)[..=k]);
        let of_others =
            others.map(|(other, _)| [motion, &*self].map(|series| &series.of(other)[..=k]));
        let mut sums = [self.number(0.0); M];
        for j in (1..k).chain([0, k]).take(k + 1) {
            for (sum, [b, change_of_b]) in sums.iter_mut().zip(of_others) {
                *sum = change_of_a[j].fused(b[k - j], *sum);
                *sum = a[j].fused(change_of_b[k - j], *sum);
            }
        }
        for ((_, out), sum) in others.into_iter().zip(sums) {
            self.set(out, k, sum);
        }
    }

    /// Returns the change of the sum of `rate_j b_(k-j)` from `j = 1`, over `k`.
    #[inline(always)]
    fn change_of_integral(
        &self,
        motion: &Series<S>,
        [rate, b]: [Slot; 2],
        to: usize,
        k: usize,
    ) -> Lanes<S> {
        let of_rate = convolution(self, rate, motion, b, 1, to, k);
        let sum = of_rate + convolution(motion, rate, self, b, 1, k + 1, k);
        sum * self.number(1.0 / k as f64)
    }

    #[inline(always)]
    fn displace(
        &mut self,
        operation: &Operation,
        constants: &[Lanes<S>],
        motion: &Series<S>,
        k: usize,
    ) {
        match operation {
            Operation::Linear { out, terms, .. } => {
                let mut sum = self.number(0.0);
                for (slot, factor) in terms {
                    sum = constants[*factor as usize].fused(self.get(*slot, k), sum);
                }
                self.set(*out, k, sum);
            }
            Operation::Products { shared, others } => match *others.as_slice() {
                [one] => self.change_of_products(motion, *shared, [one], k),
                [one, two] => self.change_of_products(motion, *shared, [one, two], k),
                [one, two, three] => {
                    self.change_of_products(motion, *shared, [one, two, three], k);
                }
                [one, two, three, four] => {
                    self.change_of_products(motion, *shared, [one, two, three, four], k);
                }
                _ => {}
            },
            Operation::Solve { matrix, right, out, factors } => {
                let size = right.len();
                for (row, &right) in right.iter().enumerate() {
                    let mut value = self.get(right, k);
                    for (column, &solution) in out.iter().enumerate() {
                        if let Entry::Series(entry) = matrix[row * size + column] {
                            value -= convolution(motion, entry, self, solution, 1, k + 1, k);
                            value -= convolution(self, entry, motion, solution, 0, k + 1, k);
                        }
                    }
                    self.set(out[row], k, value);
                }
                self.substitute(Some(motion), out, *factors, k);
            }
            &Operation::SineCosine { sine, cosine, angle, rate } => {
                let of_angle = self.get(angle, k);
                if k == 0 {
                    self.set(sine, 0, motion.get(cosine, 0) * of_angle);
                    self.set(cosine, 0, -(motion.get(sine, 0) * of_angle));
                    return;
                }
                self.set(rate, k, of_angle * self.number(k as f64));
                let s = self.change_of_integral(motion, [rate, cosine], k + 1, k);
                let c = -self.change_of_integral(motion, [rate, sine], k + 1, k);
                self.set(sine, k, s);
                self.set(cosine, k, c);
            }
            &Operation::Quotient { out, a, b, inverse } => {
                let own = convolution(self, out, motion, b, 0, k, k);
                let known = own + convolution(motion, out, self, b, 0, k + 1, k);
                let value = (self.get(a, k) - known) * motion.get(inverse, 0);
                self.set(out, k, value);
            }
            &Operation::SquareRoot { out, a, inverse } => {
                // r r = a, so that 2 r δr = δa.
                let known = convolution(self, out, motion, out, 0, k, k);
                let value = (self.get(a, k) - (known + known)) * motion.get(inverse, 0);
                self.set(out, k, value);
            }
            &Operation::Exponential { out, a, rate } => {
                let of_a = self.get(a, k);
                if k == 0 {
                    self.set(out, 0, motion.get(out, 0) * of_a);
                    return;
                }
                self.set(rate, k, of_a * self.number(k as f64));
                let value = self.change_of_integral(motion, [rate, out], k + 1, k);
                self.set(out, k, value);
            }
            &Operation::ArcTangent { out, a, slope, rate, inverse } => {
                let of_a = self.get(a, k);
                let known = match k {
                    0 => self.number(0.0),
                    _ => self.change_of_integral(motion, [rate, slope], k, k),
                };
                let value = (of_a - known) * motion.get(inverse, 0);
                self.set(out, k, value);
                self.set(rate, k, value * self.number(k as f64));
            }
        }
    }
}

/// Applies a function of one number to each lane.
#[inline(always)]
fn each<S: Vector>(mut value: Lanes<S>, function: impl Fn(f64) -> f64) -> Lanes<S> {
    for lane in 0..LANES {
        value[lane] = function(value[lane]);
    }
    value
}

/// Returns the sum of `a_j b_(k-j)` for `j` from `from` up to and without `to`; the last coefficients come last.
#[inline(always)]
pub(super) fn convolution<S: Vector>(
    of: &Series<S>,
    a: Slot,
    with: &Series<S>,
    b: Slot,
    from: usize,
    to: usize,
    k: usize,
) -> Lanes<S> {
    let (a, b) = (of.of(a), with.of(b));
    let mut sums = [of.number(0.0); 2];
    let mut j = from;
    while j + 1 < to {
        sums[0] = a[j].fused(b[k - j], sums[0]);
        sums[1] = a[j + 1].fused(b[k - j - 1], sums[1]);
        j += 2;
    }
    if j < to {
        sums[0] = a[j].fused(b[k - j], sums[0]);
    }
    sums[0] + sums[1]
}
