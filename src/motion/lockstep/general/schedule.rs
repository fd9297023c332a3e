//! The order of operations: operands first, and products that share an operand together.

use std::collections::HashMap;

use super::program::{Entry, MOST_PRODUCTS, Operation, Slot};

/// Returns the slots that an operation reads at the order that it computes, and those that it writes.
pub(super) fn reads_and_writes(operation: &Operation) -> (Vec<Slot>, Vec<Slot>) {
    match operation {
        Operation::Linear { out, terms, .. } => {
            (terms.iter().map(|(slot, _)| *slot).collect(), vec![*out])
        }
        Operation::Products { shared, others } => (
            others.iter().map(|(other, _)| *other).chain([*shared]).collect(),
            others.iter().map(|(_, out)| *out).collect(),
        ),
        Operation::Quotient { out, a, b, .. } => (vec![*a, *b], vec![*out]),
        Operation::SineCosine { sine, cosine, angle, .. } => (vec![*angle], vec![*sine, *cosine]),
        Operation::SquareRoot { out, a, .. } | Operation::Exponential { out, a, .. } => {
            (vec![*a], vec![*out])
        }
        Operation::ArcTangent { out, a, slope, .. } => (vec![*a, *slope], vec![*out]),
        Operation::Solve { matrix, right, out, .. } => {
            let entries = matrix.iter().filter_map(|entry| match entry {
                Entry::Series(slot) => Some(*slot),
                Entry::Constant(_) => None,
            });
            (entries.chain(right.iter().copied()).collect(), out.clone())
        }
    }
}

/// Sorts operations by their depth, and joins products of one depth that share an operand.
pub(super) fn grouped(operations: Vec<Operation>, components: u32) -> Vec<Operation> {
    let mut depth: HashMap<Slot, u32> = (0..components).map(|slot| (slot, 0)).collect();
    let mut levels: Vec<Vec<Operation>> = Vec::new();
    for operation in operations {
        let (reads, writes) = reads_and_writes(&operation);
        let level = reads.iter().map(|slot| depth.get(slot).copied().unwrap_or(0)).max();
        let level = level.unwrap_or(0);
        for slot in writes {
            depth.insert(slot, level + 1);
        }
        levels.resize_with(levels.len().max(level as usize + 1), Vec::new);
        levels[level as usize].push(operation);
    }
    levels.into_iter().flat_map(joined).collect()
}

fn joined(level: Vec<Operation>) -> Vec<Operation> {
    let mut products: Vec<[Slot; 3]> = Vec::new();
    let mut rest = Vec::new();
    for operation in level {
        match operation {
            Operation::Products { shared, others } => {
                products.extend(others.iter().map(|&(other, out)| [shared, other, out]));
            }
            other => rest.push(other),
        }
    }
    let mut grouped = Vec::new();
    while let Some(&[a, b, _]) = products.first() {
        let with = |slot: Slot| products.iter().filter(|p| p[0] == slot || p[1] == slot).count();
        let shared = if with(a) >= with(b) { a } else { b };
        let mut others = Vec::new();
        products.retain(|&[one, other, out]| {
            let takes = others.len() < MOST_PRODUCTS && (one == shared || other == shared);
            if takes {
                others.push((if one == shared { other } else { one }, out));
            }
            !takes
        });
        grouped.push(Operation::Products { shared, others });
    }
    grouped.extend(rest);
    grouped
}
