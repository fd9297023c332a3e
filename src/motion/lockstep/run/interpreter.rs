//! Runs a program instruction by instruction.

use super::Numbers;
use crate::graph::{Instruction, Product, Program};
use crate::motion::lockstep::vector::{Vector, vectorized};

/// Runs a program on its cells.
#[inline(never)]
pub(in crate::motion::lockstep) fn run<S: Vector, T: Numbers<S>>(
    simd: S,
    program: &Program,
    memory: &mut [T],
) {
    vectorized!(simd, {
        for instruction in &program.instructions {
            step(simd, program, memory, instruction);
        }
    });
}

#[inline(always)]
fn step<S: Vector, T: Numbers<S>>(
    simd: S,
    program: &Program,
    memory: &mut [T],
    instruction: &Instruction,
) {
    macro_rules! at {
        ($cell:expr) => {
            memory[$cell as usize]
        };
    }
    match *instruction {
        Instruction::Sum { out, start, products } => {
            let mut products = program.products(products).iter();
            let mut sum = match (start, products.as_slice()) {
                (Some(start), _) => at!(start),
                (None, [Product { factors: [a, b], .. }, ..]) => {
                    products.next();
                    at!(*a) * at!(*b)
                }
                (None, []) => T::of(simd, 0.0),
            };
            for &Product { factors: [a, b], subtracts } in products {
                let a = at!(a);
                sum = if subtracts { -a } else { a }.times_plus(at!(b), sum);
            }
            at!(out) = sum;
        }
        Instruction::Quotient { out, of, by } => at!(out) = at!(of) / at!(by),
        Instruction::SquareRoot { out, of } => at!(out) = at!(of).root(),
        Instruction::Size { out, of } => at!(out) = at!(of).size(),
        Instruction::Choice { out, less: [a, b], then, other } => {
            at!(out) = T::choice([at!(a), at!(b)], at!(then), at!(other));
        }
        Instruction::SineCosine { sine, cosine, of } => {
            T::sines_cosines(simd, memory, &[[sine, cosine, of]]);
        }
        Instruction::Function { out, function, of } => at!(out) = at!(of).image(function),
    }
}
