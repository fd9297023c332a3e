//! Runs a program in all lanes: as machine code where the processor and the system allow it, otherwise in an interpreter.
//! Both compute the same bits.

mod interpreter;

use std::sync::OnceLock;

use super::Lanes;
use super::machine_code::Code;
use super::vector::Vector;
use crate::graph::Program;
#[cfg(test)]
pub(super) use interpreter::run as interpret;

/// A program with its machine code.
#[derive(Debug)]
pub(super) struct Runner {
    program: Program,
    /// The machine code for each width, where it is possible.
    code: [OnceLock<Option<Code>>; 2],
}

impl Runner {
    /// Machine code is made when the program runs for the first time.
    pub(super) fn new(program: Program) -> Self {
        Runner { program, code: Default::default() }
    }

    /// Returns the program.
    pub(super) fn program(&self) -> &Program {
        &self.program
    }

    /// Runs the program on its cells.
    pub(super) fn run<S: Vector>(&self, simd: S, memory: &mut [Lanes<S>]) {
        let code = S::WIDTH.and_then(|width| {
            let code = &self.code[width as usize];
            code.get_or_init(|| Code::new(&self.program, width)).as_ref()
        });
        match code {
            Some(code) => code.run(simd, memory),
            None => interpreter::run(simd, &self.program, memory),
        }
    }
}
