//! The power series of all expressions of a recorded system as a straight-line program, order by order.
//!
//! Each operation has a rule that gives the coefficient of order `k` of its result from those of its operands up to `k`
//! and its own below `k` (Å. Jorba, M. Zou, Exp. Math. 14 (2005) 99, doi:10.1080/10586458.2005.10128904). Coefficients that
//! are always zero take no part. In a sum, the coefficients that were computed last come last, to avoid waiting for them.

use std::collections::HashMap;

use super::elimination::Elimination;
use super::operations::{Entry, Operation, Operations, Slot, Static, StaticId};
use super::radius::Radii;
use super::turning::Turning;
use crate::graph::{Builder, Cell, Function, Instruction, Program, tangent};
use crate::motion::lockstep::ORDER;

/// Coefficients of a series.
pub(super) const TERMS: usize = ORDER + 2;

/// The programs of a step; each runs after those before it, if at all.
#[derive(Clone, Debug)]
pub(super) struct Programs {
    /// Computes static numbers from the inputs.
    pub(super) statics: Program,
    /// Expands the motion from the state, and the friction forces.
    pub(super) motion: Program,
    /// Computes the normal forces at the start of the step.
    pub(super) start: Program,
    /// Expands the normal forces.
    pub(super) normals: Program,
    /// Expands a displacement of the state; it runs after `motion`.
    pub(super) displacement: Program,
    /// Computes rates and forces at one instant; it runs after `statics`.
    pub(super) instant: Program,
    /// Computes the rates of change of the forces; it runs after `instant`.
    pub(super) ahead: Program,
    /// Bounds the changes of the normal forces during a step without their series, if this is possible.
    pub(super) radii: Option<Radii>,
}

impl Operations {
    /// Returns the place of a static number.
    pub(super) fn constant(&self, id: StaticId) -> Cell {
        id
    }

    /// Returns the place of a coefficient; those of one series stand side by side.
    pub(super) fn coefficient(&self, slot: Slot, k: usize) -> Cell {
        (self.statics.len() + slot as usize * TERMS + k) as Cell
    }

    /// Returns the programs of a step.
    pub(super) fn programs(&self) -> Programs {
        let components = 0..self.rates.len() as Slot;
        let mut expansion = Expansion {
            of: self,
            builder: Builder::with_cells(self.coefficient(self.slots as Slot, 0) as usize),
            not_zero: vec![false; self.slots * TERMS],
            own: self.all.iter().map(|_| Own::default()).collect(),
            ahead: HashMap::new(),
        };
        components.clone().for_each(|slot| expansion.not_zero[slot as usize * TERMS] = true);
        expansion.statics();
        for k in 0..ORDER {
            for (place, operation) in self.all.iter().enumerate() {
                expansion.apply(place, operation, k);
            }
            expansion.next_state(k);
        }
        expansion.last_of_positions();
        let Expansion { builder, not_zero, .. } = expansion;
        let series = |slot: Slot| {
            let orders = (0..TERMS).filter(|k| not_zero[slot as usize * TERMS + k]);
            orders.map(|k| self.coefficient(slot, k)).collect::<Vec<_>>()
        };
        let of_contacts = |which: usize| self.contacts.iter().map(move |contact| contact[which]);
        let moved: Vec<Slot> = components.clone().chain(of_contacts(0)).collect();
        let watched = of_contacts(1).chain(of_contacts(3)).chain(self.guards.iter().copied());
        let radii = Radii::of(self, of_contacts(2));
        let for_radii = radii.iter().flat_map(Radii::series);
        let watched = moved.iter().copied().chain(watched).chain(self.gaps.iter().copied());
        let watched = watched.chain(for_radii);
        let rates = self.rates.iter().map(|rate| self.coefficient(*rate, 0));
        let in_motion: Vec<Cell> = watched.flat_map(series).chain(rates.clone()).collect();
        let normals: Vec<Cell> = of_contacts(2).flat_map(series).collect();
        let forces = |k: usize| {
            let slots = self.contacts.iter().flatten();
            slots.map(|slot| self.coefficient(*slot, k)).collect::<Vec<_>>()
        };
        let factors = radii.iter().flat_map(Radii::factors);
        let starts = of_contacts(2).chain(factors).map(|slot| self.coefficient(slot, 0));
        let starts: Vec<Cell> = starts.collect();
        let statics: Vec<Cell> = (0..self.statics.len() as Cell).collect();
        let all = builder.finish(in_motion.iter().chain(&normals).copied());
        let at_instant = [forces(0), rates.collect()].concat();
        let [_, instant, ahead] = all.parts([&statics, &at_instant, &forces(1)]);
        let [statics, mut motion, start, normals] =
            all.parts([&statics, &in_motion, &starts, &normals]);
        let starts = components.map(|slot| self.coefficient(slot, 0));
        let displacement = tangent(&motion, starts, moved.into_iter().flat_map(series));
        motion.keep_for(&displacement);
        Programs { statics, motion, start, normals, displacement, instant, ahead, radii }
    }
}

/// What an operation knows from lower orders.
#[derive(Default)]
struct Own {
    /// One over the first coefficient of a divisor, or one over twice that of a root.
    inverse: Option<Cell>,
    /// Coefficients times their order.
    rate: Vec<Option<Cell>>,
    elimination: Option<Elimination>,
    /// For each entry of a matrix, the factor of the square of a speed that is a residual.
    residuals: Vec<Option<Cell>>,
}

struct Expansion<'o> {
    of: &'o Operations,
    builder: Builder,
    /// Whether a coefficient may differ from zero.
    not_zero: Vec<bool>,
    own: Vec<Own>,
    /// By the sine of a turning angle: the next coefficients of the products of sine and cosine with the speed, without
    /// those that contain the coefficient of the speed.
    ahead: HashMap<Slot, [Option<Cell>; 2]>,
}

/// The pairs of a sum of `a_j b_(k-j)` for `j` in `orders`.
fn pairs(
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
    fn term(&self, slot: Slot, k: usize) -> Option<Cell> {
        self.not_zero[slot as usize * TERMS + k].then(|| self.of.coefficient(slot, k))
    }

    /// Returns the place of a coefficient that is not zero.
    fn place(&mut self, slot: Slot, k: usize) -> Cell {
        self.not_zero[slot as usize * TERMS + k] = true;
        self.of.coefficient(slot, k)
    }

    /// Computes the static numbers that are neither inputs nor components.
    fn statics(&mut self) {
        let builder = &mut self.builder;
        for (out, number) in (0..).zip(&self.of.statics) {
            if let Static::Constant(value) = *number {
                builder.define(out, value);
            }
        }
        let one = builder.number(1.0);
        for (out, number) in (0..).zip(&self.of.statics) {
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
                Static::Exponential(of) => {
                    let function = Function::Exponential;
                    builder.add(Instruction::Function { out, function, of });
                }
                Static::ArcTangent(of) => {
                    let function = Function::ArcTangent;
                    builder.add(Instruction::Function { out, function, of });
                }
            }
        }
    }

    /// Sets a coefficient to a start plus products; without any, it is zero.
    fn set(&mut self, slot: Slot, k: usize, start: Option<Cell>, products: &[[Cell; 2]]) {
        if start.is_some() || !products.is_empty() {
            let out = self.place(slot, k);
            self.builder.set(out, start, false, products);
        }
    }

    /// Sets the coefficient of order `k` to `factor (start - products)`; without any of both, it is zero.
    fn set_rest(
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
    fn rest(&mut self, start: Option<Cell>, products: &[[Cell; 2]]) -> Option<Cell> {
        if products.is_empty() { start } else { Some(self.builder.difference(start, products)) }
    }

    /// Sets the coefficients `k + 1` of the components from their rates of change.
    fn next_state(&mut self, k: usize) {
        let part = self.builder.number(1.0 / (k + 1) as f64);
        for (component, &rate) in (0..).zip(&self.of.rates) {
            if let Some(rate) = self.term(rate, k) {
                self.set(component, k + 1, None, &[[rate, part]]);
            }
        }
    }

    /// Sets the last coefficients of the components whose rates are sums of components.
    fn last_of_positions(&mut self) {
        let part = self.builder.number(1.0 / (ORDER + 1) as f64);
        for (component, terms) in &self.of.kinematic {
            let products = self.linear(terms, ORDER);
            if !products.is_empty() {
                let rate = self.builder.sum(None, &products);
                self.set(*component, ORDER + 1, None, &[[rate, part]]);
            }
        }
    }

    fn linear(&self, terms: &[(Slot, StaticId)], k: usize) -> Vec<[Cell; 2]> {
        let product = |(slot, factor): &(Slot, StaticId)| {
            Some([self.of.constant(*factor), self.term(*slot, k)?])
        };
        terms.iter().filter_map(product).collect()
    }

    /// Returns the coefficient of order `k` times `k`, which is kept.
    fn rate(&mut self, place: usize, slot: Slot, k: usize) {
        let factor = self.builder.number(k as f64);
        let rate = self.term(slot, k).map(|cell| self.builder.product(factor, cell));
        self.own[place].rate.resize(k, None);
        self.own[place].rate.push(rate);
    }

    /// Returns `rate_j b_(k-j)` for `j` from 1 to `most`.
    fn integral(&self, place: usize, b: Slot, most: usize, k: usize) -> Vec<[Cell; 2]> {
        pairs(|j| self.own[place].rate[j], |j| self.term(b, j), 1..=most, k)
    }

    fn apply(&mut self, place: usize, operation: &Operation, k: usize) {
        let one = self.builder.number(1.0);
        match operation {
            Operation::Linear { out, constant, terms } => {
                let start = constant.filter(|_| k == 0).map(|id| self.of.constant(id));
                let products = self.linear(terms, k);
                self.set(*out, k, start, &products);
            }
            Operation::Product { out, a, b } if a == b && k > 0 => {
                let own = |j: usize| self.term(*a, j);
                let products = pairs(own, own, (1..k.div_ceil(2)).chain([0]), k);
                let middle = own(k / 2).filter(|_| k.is_multiple_of(2));
                let middle = middle.map(|cell| [cell; 2]);
                if products.is_empty() {
                    self.set(*out, k, None, middle.as_slice());
                    return;
                }
                let two = self.builder.number(2.0);
                let half = self.builder.sum(None, &products);
                let all: Vec<_> = std::iter::once([half, two]).chain(middle).collect();
                self.set(*out, k, None, &all);
            }
            Operation::Product { out, a, b } => {
                let orders = (1..k).chain([0, k]).take(k + 1);
                let products = pairs(|j| self.term(*a, j), |j| self.term(*b, j), orders, k);
                self.set(*out, k, None, &products);
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
                    self.own[place].inverse = Some(self.builder.quotient(one, by));
                }
                let known = pairs(|j| self.term(out, j), |j| self.term(b, j), 0..k, k);
                let inverse = self.own[place].inverse.unwrap_or(one);
                self.set_rest((out, k), self.term(a, k), &known, inverse);
            }
            &Operation::SquareRoot { out, a } => {
                if k == 0 {
                    let of = self.start(a);
                    let root = self.place(out, 0);
                    self.builder.add(Instruction::SquareRoot { out: root, of });
                    let half = self.builder.number(0.5);
                    self.own[place].inverse = Some(self.builder.quotient(half, root));
                    return;
                }
                let known = pairs(|j| self.term(out, j), |j| self.term(out, j), 1..k, k);
                let inverse = self.own[place].inverse.unwrap_or(one);
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
            &Operation::ArcTangent { out, a, slope } => {
                if k == 0 {
                    self.begin(out, Function::ArcTangent, a);
                    let by = self.start(slope);
                    self.own[place].inverse = Some(self.builder.quotient(one, by));
                    self.own[place].rate.push(None);
                    return;
                }
                let known = self.integral(place, slope, k - 1, k);
                let known = (!known.is_empty()).then(|| self.builder.sum(None, &known));
                let part = self.builder.number(1.0 / k as f64);
                let products: Vec<_> = known.map(|known| [known, part]).into_iter().collect();
                let inverse = self.own[place].inverse.unwrap_or(one);
                self.set_rest((out, k), self.term(a, k), &products, inverse);
                self.rate(place, out, k);
            }
            Operation::Solve { matrix, right, out, units } => {
                self.solve(place, (matrix, right, out, units), k);
            }
        }
    }

    /// Computes the products of sine and cosine with the speed, and the next coefficients of sine and cosine.
    fn turn(&mut self, turning: &Turning, k: usize) {
        let Turning { angle, speed, switch, sine, cosine, sine_speed, cosine_speed } = *turning;
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
                Some(switch) => [self.builder.product(product, part), self.of.constant(switch)],
                None => [product, part],
            };
            let next = self.place(other, k + 1);
            // The cosine falls where the sine times the speed is positive.
            self.builder.set(next, None, of == sine, &[factors]);
        }
        let orders = || (2..=k).chain([1, k + 1]).take(k + 1);
        let ahead = [sine, cosine].map(|of| {
            let products = pairs(|j| self.term(of, j), |j| self.term(speed, j), orders(), k + 1);
            (!products.is_empty()).then(|| self.builder.sum(None, &products))
        });
        self.ahead.insert(sine, ahead);
    }

    /// Returns the coefficient of order zero.
    fn start(&mut self, slot: Slot) -> Cell {
        self.term(slot, 0).unwrap_or_else(|| self.builder.number(0.0))
    }

    fn begin(&mut self, out: Slot, function: Function, of: Slot) {
        let of = self.start(of);
        let out = self.place(out, 0);
        self.builder.add(Instruction::Function { out, function, of });
    }

    /// Returns an entry of a matrix at order zero.
    fn entry(&mut self, place: usize, entry: &Entry) -> Option<Cell> {
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
    fn solve(
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
