//! Powers of a perturbation above those of its series.
//!
//! The fastest motion in a perturbation may be much faster than that which determines the length of the steps: in the motion
//! itself it has decayed, but every switch excites it anew in a perturbation. Its higher powers follow from the equations at
//! the start of the step, linearised and with constant coefficients: `δ_(n+1) = J δ_n / (n + 1)`.

use std::collections::HashMap;

use crate::graph::{Builder, Cell, Instruction, Product, Program, tangent};
use crate::motion::lockstep::TERMS;
use crate::motion::lockstep::general::operations::{Operations, Slot};

/// Number of additional powers, from the 17th to the 22nd. The 23rd power is left out: in the longest step, it is
/// `5^23 / 23!`, 5e-7 of the perturbation.
const BEYOND: usize = 6;

/// Returns the program that adds the higher powers to the highest coefficients of a perturbation, for steps of a length that
/// is known. It runs after `perturbation`; `rates` computes the rates of change at the start of the step.
pub(super) fn tail(operations: &Operations, rates: &Program, perturbation: &Program) -> Program {
    let offset = rates.cells as Cell;
    let slots = || (0..).zip(&operations.rates);
    let states: Vec<Cell> = slots().map(|(slot, _)| operations.coefficient(slot, 0)).collect();
    let of_rates = slots().map(|(_, rate)| operations.coefficient(*rate, 0));
    let linear = tangent(rates, states.iter().copied(), of_rates.clone());
    let of_rates: Vec<Cell> = of_rates.collect();
    let mut builder = Builder::with_cells(perturbation.cells);
    let highest = TERMS - 1;
    let before = |slot: Slot| operations.coefficient(slot, highest - 1) + offset;
    let mut powers: Vec<Vec<Option<Cell>>> =
        vec![slots().map(|(slot, _)| Some(before(slot))).collect()];
    for n in highest..highest + BEYOND {
        let latest = &powers[powers.len() - 1];
        let mut known: HashMap<Cell, Cell> = HashMap::new();
        for (state, power) in states.iter().zip(latest) {
            let zero = builder.number(0.0);
            known.insert(state + offset, power.unwrap_or(zero));
        }
        let changes = append(&mut builder, &linear, &mut known);
        let part = builder.number(1.0 / n as f64);
        let next = of_rates.iter().map(|rate| {
            let change = *changes.get(&(rate + offset))?;
            Some(builder.product(change, part))
        });
        let next = next.collect();
        powers.push(next);
    }
    let length = operations.length();
    for (slot, _) in slots() {
        let out = operations.coefficient(slot, highest) + offset;
        let mut sum = None;
        for power in powers[1..].iter().rev() {
            let term = power[slot as usize];
            sum = match sum {
                None => term,
                Some(sum) => Some(builder.sum(term, &[[sum, length]])),
            };
        }
        builder.set(out, sum, false, &[]);
    }
    builder.finish(slots().map(|(slot, _)| operations.coefficient(slot, highest) + offset))
}

/// Adds the instructions of a program with cells of their own. `known` has the cells that take the places of its inputs;
/// returned are those that take the places of all cells that it writes.
fn append(
    builder: &mut Builder,
    program: &Program,
    known: &mut HashMap<Cell, Cell>,
) -> HashMap<Cell, Cell> {
    for (cell, number) in program.numbers.iter() {
        let number = builder.number(*number);
        known.insert(*cell, number);
    }
    for instruction in &program.instructions {
        for cell in instruction.writes() {
            let new_cell = builder.cell();
            known.insert(cell, new_cell);
        }
        let at = |cell: Cell| known.get(&cell).copied().unwrap_or(cell);
        match *instruction {
            Instruction::Sum { out, start, products } => {
                let products = program
                    .products(products)
                    .iter()
                    .map(|product| Product { factors: product.factors.map(at), ..*product });
                let products: Vec<_> = products.collect();
                builder.combine(at(out), start.map(at), products);
            }
            other => builder.add(other.renamed(at)),
        }
    }
    known.clone()
}
