//! The order of operations: operands first, and at each depth products before what is linear in them.

use std::collections::HashMap;

use super::operations::{MatrixEntry, Operation, Slot};

/// Returns the slots that an operation reads at the order that it computes, and those that it writes.
pub(super) fn reads_and_writes(operation: &Operation) -> (Vec<Slot>, Vec<Slot>) {
    match operation {
        Operation::Linear { out, terms, .. } => {
            (terms.iter().map(|(slot, _)| *slot).collect(), vec![*out])
        }
        Operation::Product { out, a, b } | Operation::Quotient { out, a, b } => {
            (vec![*a, *b], vec![*out])
        }
        Operation::SineCosine { sine, cosine, angle } => (vec![*angle], vec![*sine, *cosine]),
        Operation::Turning(of) => {
            (vec![of.angle, of.speed], vec![of.sine, of.cosine, of.sine_speed, of.cosine_speed])
        }
        Operation::SquareRoot { out, a } | Operation::Exponential { out, a } => {
            (vec![*a], vec![*out])
        }
        Operation::Function { out, a, slope, .. } => (vec![*a, *slope], vec![*out]),
        Operation::Solve { matrix, products, right, out, .. } => {
            let entries = matrix.iter().flat_map(|entry| match entry {
                MatrixEntry::Series { slot, .. } => vec![*slot],
                MatrixEntry::Turned { turning, square, .. } => vec![turning.sine_speed, *square],
                MatrixEntry::Zero | MatrixEntry::Constant(_) => Vec::new(),
            });
            let sums = products.iter().flatten().map(|products| products.sum);
            let writes = out.iter().copied().chain(sums).collect();
            (entries.chain(right.iter().copied()).collect(), writes)
        }
    }
}

/// Sorts operations by their depth; components of the state have depth 0.
pub(super) fn sorted(operations: Vec<Operation>, components: u32) -> Vec<Operation> {
    let mut depth: HashMap<Slot, u32> = (0..components).map(|slot| (slot, 0)).collect();
    let mut keyed = Vec::with_capacity(operations.len());
    for operation in operations {
        let (reads, writes) = reads_and_writes(&operation);
        let level = reads.iter().map(|slot| depth.get(slot).copied().unwrap_or(0)).max();
        let level = level.unwrap_or(0);
        for slot in writes {
            depth.insert(slot, level + 1);
        }
        keyed.push((level, !matches!(operation, Operation::Product { .. }), operation));
    }
    keyed.sort_by_key(|(level, is_late, _)| (*level, *is_late));
    keyed.into_iter().map(|(_, _, operation)| operation).collect()
}
