//! Runs a program, in all lanes or for one run: as machine code where the processor and the system allow it, otherwise in an
//! interpreter. Both compute the same bits. Read first `numbers`, then this file.

mod numbers;

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

use super::machine_code::MachineCode;
use super::vector::{Vector, vectorized};
use crate::graph::{Instruction, Product, Program};
pub(super) use numbers::Numbers;

/// A program runs so often in the interpreter before its machine code is made, which takes about as long.
const FIRST_RUNS: u32 = 100;

/// A program with its machine code.
#[derive(Debug)]
pub(super) struct Runner {
    /// The program.
    pub(super) program: Program,
    /// The machine code for each width, where it is possible.
    code: [OnceLock<Option<MachineCode>>; 3],
    /// The number of runs in the interpreter, up to [`FIRST_RUNS`].
    runs: AtomicU32,
}

impl Runner {
    /// Returns a program without machine code.
    pub(super) fn new(program: Program) -> Self {
        let program = program.with_functions_first();
        Runner { program, code: Default::default(), runs: AtomicU32::new(0) }
    }

    /// Runs the program on its cells.
    pub(super) fn run<S: Vector, T: Numbers<S>>(&self, simd: S, memory: &mut [T]) {
        // Which runs are interpreted does not affect their results.
        let is_new = self.runs.load(Ordering::Relaxed) < FIRST_RUNS;
        let code = T::width().filter(|_| !is_new).and_then(|width| {
            let code = &self.code[width as usize];
            code.get_or_init(|| MachineCode::new(&self.program, width)).as_ref()
        });
        if let Some(code) = code {
            return code.run(simd, memory);
        }
        if is_new {
            self.runs.fetch_add(1, Ordering::Relaxed);
        }
        interpret(simd, &self.program, memory);
    }
}

/// Runs a program on its cells, instruction by instruction.
#[inline(never)]
pub(super) fn interpret<S: Vector, T: Numbers<S>>(simd: S, program: &Program, memory: &mut [T]) {
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
