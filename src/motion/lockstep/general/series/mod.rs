//! The power series of all expressions of a recorded system as a straight-line program, order by order.
//!
//! Each operation has a rule that gives the coefficient of order `k` of its result from those of its operands up to `k`
//! and its own below `k` (Å. Jorba, M. Zou, Exp. Math. 14 (2005) 99, doi:10.1080/10586458.2005.10128904). Coefficients that
//! are always zero take no part. In a sum, the coefficients that were computed last come last, to avoid waiting for them.

mod rules;
mod unknowns;

use std::collections::HashMap;

use super::elimination::Elimination;
use super::operations::{Operations, Slot};
use super::radius::Radii;
use super::statics::StaticId;
use crate::graph::{Builder, Cell, Program, tangent};
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
        (self.statics.all().len() + slot as usize * TERMS + k) as Cell
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
        self.statics.emit(&mut expansion.builder);
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
        let statics: Vec<Cell> = (0..self.statics.all().len() as Cell).collect();
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
}
