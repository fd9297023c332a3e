//! How far normal forces move away from their values at the start of a step, bounded from the series of the motion. Where
//! the bound is enough, the series of the normal forces are not needed.

use fearless_simd::prelude::*;

use super::operations::{Entry, Operation, Operations, Slot};
use super::room::Room;
use super::schedule::reads_and_writes;
use super::series::TERMS;
use super::statics::StaticId;
use crate::motion::lockstep::Lanes;
use crate::motion::lockstep::vector::{Fused, Vector};

/// How the change of an expression is bounded.
#[derive(Clone, Debug, PartialEq)]
enum Rule {
    /// By the coefficients of its series, which the motion computes.
    Series,
    /// `|a b - a₀ b₀| ≤ |a₀| ρ(b) + |b₀| ρ(a) + ρ(a) ρ(b)`
    Product([Slot; 2]),
    /// The sum of the bounds of the terms.
    Linear(Vec<(Slot, StaticId)>),
}

/// The rules that bound the changes of expressions, operands first.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Radii {
    rules: Vec<(Slot, Rule)>,
}

impl Radii {
    /// Returns the rules for the changes of these expressions; `None` if they consist of more than sums and products of
    /// components, unknowns, sines and cosines.
    pub(super) fn of(operations: &Operations, slots: impl Iterator<Item = Slot>) -> Option<Self> {
        let mut keyed = Vec::new();
        let mut open: Vec<Slot> = slots.collect();
        while let Some(slot) = open.pop() {
            if keyed.iter().any(|(_, known, _)| *known == slot) {
                continue;
            }
            let (place, rule) = rule(operations, slot)?;
            match &rule {
                Rule::Series => {}
                Rule::Product(factors) => open.extend(factors),
                Rule::Linear(terms) => open.extend(terms.iter().map(|(slot, _)| *slot)),
            }
            keyed.push((place, slot, rule));
        }
        keyed.sort_by_key(|(place, ..)| *place);
        Some(Radii { rules: keyed.into_iter().map(|(_, slot, rule)| (slot, rule)).collect() })
    }

    /// Returns the expressions whose series the motion must keep.
    pub(super) fn series(&self) -> impl Iterator<Item = Slot> {
        self.rules.iter().filter(|(_, rule)| *rule == Rule::Series).map(|(slot, _)| *slot)
    }

    /// Returns the expressions whose values at the start of the step must be known.
    pub(super) fn factors(&self) -> impl Iterator<Item = Slot> {
        let factors = self.rules.iter().filter_map(|(_, rule)| match rule {
            Rule::Product(factors) => Some(*factors),
            Rule::Series | Rule::Linear(_) => None,
        });
        factors.flatten()
    }

    /// Bounds the changes during a step of this length. `radii` has a place for each series.
    #[inline(always)]
    pub(super) fn bound<S: Vector>(
        &self,
        room: &Room<S>,
        length: Lanes<S>,
        radii: &mut [Lanes<S>],
    ) {
        let zero = Lanes::splat(length.simd, 0.0);
        let series = room.series();
        for (slot, rule) in &self.rules {
            let mut radius = zero;
            match rule {
                Rule::Series => {
                    let terms = series.of(*slot);
                    for k in (1..TERMS).rev() {
                        radius = radius.fused(length, terms[k].abs());
                    }
                    radius *= length;
                }
                Rule::Product([a, b]) => {
                    let [of_a, of_b] = [radii[*a as usize], radii[*b as usize]];
                    let [at_a, at_b] = [series.of(*a)[0].abs(), series.of(*b)[0].abs()];
                    radius = at_a.fused(of_b, (at_b + of_b) * of_a);
                }
                Rule::Linear(terms) => {
                    for (slot, factor) in terms {
                        let factor = room.constant(*factor).abs();
                        radius = factor.fused(radii[*slot as usize], radius);
                    }
                }
            }
            radii[*slot as usize] = radius;
        }
    }
}

/// Returns the rule of an expression, with the place of the operation that computes it.
fn rule(operations: &Operations, slot: Slot) -> Option<(usize, Rule)> {
    if (slot as usize) < operations.rates.len() {
        return Some((0, Rule::Series));
    }
    let computes = |operation: &&Operation| reads_and_writes(operation).1.contains(&slot);
    let place = operations.all.iter().position(|operation| computes(&operation))?;
    let rule = match &operations.all[place] {
        Operation::Linear { terms, .. } => Rule::Linear(terms.clone()),
        Operation::Product { a, b, .. } => Rule::Product([*a, *b]),
        Operation::SineCosine { .. } => Rule::Series,
        Operation::Turning(of) if slot == of.sine_speed => Rule::Product([of.sine, of.speed]),
        Operation::Turning(of) if slot == of.cosine_speed => Rule::Product([of.cosine, of.speed]),
        Operation::Turning(_) => Rule::Series,
        Operation::Solve { out, .. } if out.contains(&slot) => Rule::Series,
        Operation::Solve { matrix, out, .. } => {
            let factors = (0..).zip(matrix).find_map(|(place, entry): (usize, _)| match entry {
                Entry::Series { slot: entry, product, .. } if *product == slot => {
                    Some([*entry, out[place % out.len()]])
                }
                _ => None,
            });
            Rule::Product(factors?)
        }
        _ => return None,
    };
    Some((place + 1, rule))
}
