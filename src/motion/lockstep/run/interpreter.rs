//! Runs a program instruction by instruction.

use fearless_simd::prelude::*;

use crate::graph::{Instruction, Product, Program};
use crate::motion::lockstep::trigonometry::sin_cos;
use crate::motion::lockstep::vector::{Fused, Vector};
use crate::motion::lockstep::{LANES, Lanes};

/// Runs a program on its cells.
#[inline(never)]
pub(in crate::motion::lockstep) fn run<S: Vector>(
    simd: S,
    program: &Program,
    memory: &mut [Lanes<S>],
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for instruction in &program.instructions {
                step(simd, program, memory, instruction);
            }
        },
    );
}

#[inline(always)]
fn step<S: Vector>(simd: S, program: &Program, memory: &mut [Lanes<S>], instruction: &Instruction) {
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
                (None, []) => Lanes::splat(simd, 0.0),
            };
            for &Product { factors: [a, b], subtracts } in products {
                let a = at!(a);
                sum = if subtracts { -a } else { a }.fused(at!(b), sum);
            }
            at!(out) = sum;
        }
        Instruction::Quotient { out, of, by } => at!(out) = at!(of) / at!(by),
        Instruction::SquareRoot { out, of } => at!(out) = at!(of).sqrt(),
        Instruction::Size { out, of } => at!(out) = at!(of).abs(),
        Instruction::Choice { out, less: [a, b], then, other } => {
            at!(out) = at!(a).simd_lt(at!(b)).select(at!(then), at!(other));
        }
        Instruction::SineCosine { sine, cosine, of } => {
            let (s, c) = sin_cos(at!(of));
            at!(sine) = s;
            at!(cosine) = c;
        }
        Instruction::Function { out, function, of } => {
            let mut value = at!(of);
            for lane in 0..LANES {
                value[lane] = function.of(value[lane]);
            }
            at!(out) = value;
        }
    }
}
