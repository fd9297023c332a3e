//! How far normal forces move away from their values at the start of a step, bounded from the series of the motion. Where
//! the bound is enough, the series of the normal forces are not needed.

use super::operations::{Operation, Operations, Slot, reads_and_writes};
use super::statics::StaticId;

/// How the change of an expression is bounded.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Rule {
    /// By the coefficients of its series, which the motion computes.
    Series,
    /// That of sine and cosine is at most that of the angle.
    Angle(Slot),
    /// `|a b - a₀ b₀| ≤ |a₀| ρ(b) + |b₀| ρ(a) + ρ(a) ρ(b)`
    Product([Slot; 2]),
    /// The sum of the bounds of the terms.
    Linear(Vec<(Slot, StaticId)>),
}

/// Returns the rules that bound the changes of these expressions, operands first; `None` if they consist of more than sums and
/// products of components, unknowns, sines and cosines.
pub(super) fn radii(
    operations: &Operations,
    slots: impl Iterator<Item = Slot>,
) -> Option<Vec<(Slot, Rule)>> {
    let mut keyed = Vec::new();
    let mut open: Vec<Slot> = slots.collect();
    while let Some(slot) = open.pop() {
        if keyed.iter().any(|(_, known, _)| *known == slot) {
            continue;
        }
        let (place, rule) = rule(operations, slot)?;
        match &rule {
            Rule::Series => {}
            Rule::Angle(angle) => open.push(*angle),
            Rule::Product(factors) => open.extend(factors),
            Rule::Linear(terms) => open.extend(terms.iter().map(|(slot, _)| *slot)),
        }
        keyed.push((place, slot, rule));
    }
    keyed.sort_by_key(|(place, ..)| *place);
    Some(keyed.into_iter().map(|(_, slot, rule)| (slot, rule)).collect())
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
        Operation::SineCosine { angle, .. } => Rule::Angle(*angle),
        Operation::Turning(of) if slot == of.sine_speed => Rule::Product([of.sine, of.speed]),
        Operation::Turning(of) if slot == of.cosine_speed => Rule::Product([of.cosine, of.speed]),
        Operation::Turning(of) => Rule::Angle(of.angle),
        Operation::Solve { out, .. } if out.contains(&slot) => Rule::Series,
        Operation::Solve { products, .. } => {
            let row = products.iter().flatten().find(|products| products.sum == slot);
            match row.map(|products| &products.parts[..]) {
                Some([(a, b, _)]) => Rule::Product([*a, *b]),
                _ => return None,
            }
        }
        _ => return None,
    };
    Some((place + 1, rule))
}
