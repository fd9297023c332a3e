//! Where conditions certainly hold throughout a step: lower bounds of their values, from the coefficients of their series.
//!
//! A condition is bounded by its values and slopes at both ends and by a bound of its fourth derivative
//! ([`crate::motion::lockstep::root_isolation`]).

use super::expansion::Expansion;
use crate::graph::{Cell, Product};
use crate::motion::lockstep::general::operations::{ContactCell, GapCell, Operations, Slot};
use crate::motion::lockstep::general::radius::Rule;
use crate::motion::lockstep::root_isolation::FOURTH;
use crate::motion::lockstep::{ORDER, TERMS};

/// The cells with lower bounds of conditions. Where a bound is negative or not a number, the condition may fail.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::motion::lockstep::general) struct Screen {
    /// Whether the series of the normal forces must be known.
    pub(in crate::motion::lockstep::general) needs_normals: bool,
    /// The lower bounds of the conditions of each contact ([`ConditionBound`]).
    pub(in crate::motion::lockstep::general) contacts: Vec<[Cell; 4]>,
    /// The least of the conditions of the forces of each contact.
    pub(in crate::motion::lockstep::general) forces: Vec<Cell>,
    /// The least of all conditions of each contact, of each event, and of each gap.
    pub(in crate::motion::lockstep::general) all: Vec<Cell>,
}

impl Screen {
    /// Returns all cells.
    pub(super) fn cells(&self) -> Vec<Cell> {
        [self.contacts.as_flattened(), &self.forces, &self.all].concat()
    }
}

/// The place of a condition's lower bound among those of a contact.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion::lockstep::general) enum ConditionBound {
    /// It slips, or is in transition.
    Slips,
    /// It is held against a forward force.
    Forward,
    /// It is held against a backward force.
    Backward,
    /// The normal force does not pull.
    Closed,
}

/// Values and slopes of a function at both ends of a step whose length is the unit of time, and a bound of its fourth
/// derivative.
#[derive(Clone, Copy)]
struct BoundCells {
    values: [Cell; 2],
    changes: [Cell; 2],
    bound: Cell,
}

/// What is known of a normal force.
enum NormalBound {
    /// A lower bound, which is constant.
    AtLeast(Cell),
    Over(BoundCells),
}

/// Powers of the length of a step, with factors.
struct LengthPowers {
    /// `h^k`
    plain: Vec<Cell>,
    /// `k h^k`
    slopes: Vec<Cell>,
    /// `k (k - 1) (k - 2) (k - 3) h^k`
    fourths: Vec<Cell>,
}

impl Expansion<'_> {
    /// Adds the instructions that bound all conditions. The normal forces are bounded by `radii`, or else by their series.
    pub(super) fn screen(&mut self, radii: Option<&[(Slot, Rule)]>) -> Screen {
        let of: &Operations = self.of;
        let powers = self.powers();
        let normals: Vec<NormalBound> = match radii {
            Some(radii) => {
                self.least_normals(radii, &powers).into_iter().map(NormalBound::AtLeast).collect()
            }
            None => {
                let curve = |slots: &[Slot; 4]| self.curve(slots[2], ORDER - 1, &powers);
                of.contacts.iter().map(curve).map(NormalBound::Over).collect()
            }
        };
        let speeds: Vec<_> =
            of.contacts.iter().map(|slots| self.curve(slots[0], ORDER, &powers)).collect();
        let frictions: Vec<_> =
            of.contacts.iter().map(|slots| self.curve(slots[3], ORDER - 1, &powers)).collect();
        let others = of.guards.iter().chain(&of.gaps);
        let others: Vec<_> = others.map(|slot| self.curve(*slot, ORDER - 1, &powers)).collect();
        let mut screen = Screen { needs_normals: radii.is_none(), ..Screen::default() };
        let one = self.builder.number(1.0);
        for contact in 0..of.contacts.len() {
            let number = |which: ContactCell| of.of_contact(contact, which);
            let sign = number(ContactCell::Sign);
            let size = self.builder.size(sign);
            let slips = self.scaled(sign, size, &speeds[contact], number(ContactCell::Offset));
            let slips = self.least(&slips);
            let (normal, friction) = (&normals[contact], &frictions[contact]);
            let aim = number(ContactCell::Aim);
            let closed = match normal {
                NormalBound::AtLeast(least) => self.builder.sum(Some(aim), &[[one, *least]]),
                NormalBound::Over(curve) => {
                    let closed = self.scaled(one, one, curve, aim);
                    self.least(&closed)
                }
            };
            let mut forces = closed;
            let mut bounds = [slips, closed, closed, closed];
            // Friction holds a contact that sticks against both directions.
            let [limit, slack] = [ContactCell::Limit, ContactCell::Slack].map(number);
            for (place, subtracts) in
                [(ConditionBound::Backward, false), (ConditionBound::Forward, true)]
            {
                let builder = &mut self.builder;
                let mut part = |start: Option<Cell>, normal: Option<Cell>, friction: Cell| {
                    let out = builder.cell();
                    let normal = normal.map(|normal| Product::plus([limit, normal]));
                    let friction = Product { factors: [one, friction], subtracts };
                    builder.combine(out, start, normal.into_iter().chain([friction]));
                    out
                };
                let (of_values, of_changes, bound) = match normal {
                    NormalBound::AtLeast(least) => ([Some(*least); 2], [None; 2], None),
                    NormalBound::Over(BoundCells { values, changes, bound }) => {
                        (values.map(Some), changes.map(Some), Some(*bound))
                    }
                };
                let ends = [0, 1];
                let values = ends.map(|i| part(Some(slack), of_values[i], friction.values[i]));
                let changes = ends.map(|i| part(None, of_changes[i], friction.changes[i]));
                let bound = bound.map_or(friction.bound, |bound| {
                    builder.sum(Some(friction.bound), &[[limit, bound]])
                });
                let held = BoundCells { values, changes, bound };
                let held = self.least(&held);
                let zero = self.builder.number(0.0);
                let held = self.builder.choice([zero, number(ContactCell::Stuck)], held, one);
                bounds[place as usize] = held;
                forces = self.builder.smaller(held, forces);
            }
            screen.contacts.push(bounds);
            screen.forces.push(forces);
            screen.all.push(self.builder.smaller(slips, forces));
        }
        for (place, curve) in others.iter().enumerate() {
            let least = match place.checked_sub(of.guards.len()) {
                None => self.least(curve),
                Some(gap) => {
                    let weight = of.of_gap(gap, GapCell::Weight);
                    let pressed =
                        self.scaled(weight, weight, curve, of.of_gap(gap, GapCell::Offset));
                    self.least(&pressed)
                }
            };
            screen.all.push(least);
        }
        screen
    }

    fn powers(&mut self) -> LengthPowers {
        let length = self.of.length();
        let mut plain = vec![self.builder.number(1.0), length];
        for k in 2..TERMS {
            let factors = [plain[k / 2], plain[k - k / 2]];
            plain.push(self.builder.product(factors[0], factors[1]));
        }
        let mut weighted = |weight: &dyn Fn(usize) -> f64| {
            let product = |(k, power): (usize, &Cell)| {
                let weight = self.builder.number(weight(k));
                self.builder.product(weight, *power)
            };
            plain.iter().enumerate().take(ORDER + 1).map(product).collect::<Vec<_>>()
        };
        let slopes = weighted(&|k| k as f64);
        let fourths = weighted(&|k| FOURTH[k]);
        LengthPowers { plain, slopes, fourths }
    }

    /// Returns the bounds of a series with coefficients up to the power `highest`.
    fn curve(&mut self, slot: Slot, highest: usize, powers: &LengthPowers) -> BoundCells {
        let zero = self.builder.number(0.0);
        let terms: Vec<_> = (1..=highest).filter_map(|k| Some((k, self.term(slot, k)?))).collect();
        let start = self.term(slot, 0).unwrap_or(zero);
        let sizes: Vec<[Cell; 2]> = terms
            .iter()
            .filter(|(k, _)| *k >= 4)
            .map(|(k, term)| [self.builder.size(*term), powers.fourths[*k]])
            .collect();
        let products = |weights: &[Cell]| {
            let product = |(k, term): &(usize, Cell)| [*term, weights[*k]];
            terms.iter().rev().map(product).collect::<Vec<_>>()
        };
        let end = self.builder.sum(Some(start), &products(&powers.plain));
        let slope = self.builder.sum(Some(zero), &products(&powers.slopes));
        let bound = self.builder.sum(Some(zero), &sizes);
        let first = match terms.first() {
            Some((1, term)) => self.builder.product(*term, powers.plain[1]),
            _ => zero,
        };
        BoundCells { values: [start, end], changes: [first, slope], bound }
    }

    /// Returns a curve times a factor plus an offset; `size` is the size of the factor.
    fn scaled(&mut self, factor: Cell, size: Cell, curve: &BoundCells, offset: Cell) -> BoundCells {
        let BoundCells { values, changes, bound } = *curve;
        BoundCells {
            values: values.map(|value| self.builder.sum(Some(offset), &[[factor, value]])),
            changes: changes.map(|change| self.builder.product(factor, change)),
            bound: self.builder.product(size, bound),
        }
    }

    /// Returns the least coefficient of the Bernstein form of degree four, with the least possible middle one.
    fn least(&mut self, curve: &BoundCells) -> Cell {
        let BoundCells { values: [a, b], changes: [p, q], bound } = *curve;
        let builder = &mut self.builder;
        let [fourth, sixth, half] = [0.25, 1.0 / 6.0, 0.5].map(|number| builder.number(number));
        let part = builder.number(1.0 / 144.0);
        let early = builder.sum(Some(a), &[[fourth, p]]);
        let late = builder.difference(Some(b), &[[fourth, q]]);
        let middle = builder.cell();
        let products = [
            Product::plus([half, a]),
            Product::plus([half, b]),
            Product::plus([sixth, p]),
            Product::minus([sixth, q]),
            Product::minus([part, bound]),
        ];
        builder.combine(middle, None, products);
        let ends = builder.smaller(a, b);
        let inner = builder.smaller(early, late);
        let inner = builder.smaller(inner, middle);
        builder.smaller(ends, inner)
    }

    /// Returns lower bounds of the normal forces.
    fn least_normals(&mut self, radii: &[(Slot, Rule)], powers: &LengthPowers) -> Vec<Cell> {
        let zero = self.builder.number(0.0);
        let mut of = vec![zero; self.of.slots];
        for (slot, rule) in radii {
            of[*slot as usize] = match rule {
                Rule::Angle(angle) => of[*angle as usize],
                Rule::Series => {
                    let terms: Vec<_> =
                        (1..TERMS).filter_map(|k| Some((k, self.term(*slot, k)?))).collect();
                    let product =
                        |(k, term): &(usize, Cell)| [self.builder.size(*term), powers.plain[*k]];
                    let products: Vec<_> = terms.iter().rev().map(product).collect();
                    self.builder.sum(Some(zero), &products)
                }
                Rule::Product(factors) => {
                    let [radius_a, radius_b] = factors.map(|factor| of[factor as usize]);
                    let [a, b] = factors.map(|factor| {
                        let start = self.start(factor);
                        self.builder.size(start)
                    });
                    let one = self.builder.number(1.0);
                    let b = self.builder.sum(Some(radius_b), &[[one, b]]);
                    self.builder.sum(None, &[[a, radius_b], [b, radius_a]])
                }
                Rule::Linear(terms) => {
                    let product = |(slot, factor): &(Slot, _)| {
                        [self.builder.size(*factor), of[*slot as usize]]
                    };
                    let products: Vec<_> = terms.iter().map(product).collect();
                    self.builder.sum(Some(zero), &products)
                }
            };
        }
        let slots = self.of.contacts.iter().map(|contact| contact[2]);
        let normals = slots.map(|slot| {
            let start = self.start(slot);
            let one = self.builder.number(1.0);
            self.builder.difference(Some(start), &[[one, of[slot as usize]]])
        });
        normals.collect()
    }
}
