//! Machine code of programs, made when they first run (x86-64).
//!
//! Read first `lower`, which numbers the values of a program and interleaves sums that do not depend on each other, then
//! `encode`, which writes instructions, and `registers`, which keeps values in registers. This file runs the code. The code
//! has no branches, and each of its memory operands is a cell below [`Program::cells`].

mod encode;
mod lower;
mod registers;

use std::sync::OnceLock;

use memmap2::{Mmap, MmapMut};

use super::LANES;
use super::run::Numbers;
use super::vector::{Vector, Width, vectorized};
use crate::graph::{Cell, Instruction, Program};
use crate::model::Function;
use encode::Encoder;
use lower::{Line, MachineOperation};

/// The largest program with machine code, in bytes of code.
const MOST_BYTES: usize = 1 << 24;

/// Returns whether programs run as machine code on this machine: the environment variable `STICKSLIP_MACHINE_CODE=off` and
/// systems that refuse executable memory prevent it.
pub(super) fn is_allowed() -> bool {
    static ALLOWED: OnceLock<bool> = OnceLock::new();
    *ALLOWED.get_or_init(|| {
        let is_off = std::env::var_os("STICKSLIP_MACHINE_CODE").is_some_and(|value| value == "off");
        let executable = || MmapMut::map_anon(1).and_then(MmapMut::make_exec);
        cfg!(target_arch = "x86_64") && !is_off && executable().is_ok()
    })
}

/// A part of a program.
#[derive(Clone, Debug)]
enum CodePart {
    /// Machine code, by its place.
    Code(usize),
    /// Sines and cosines: their cells, and those of the angles.
    Turns(Vec<[Cell; 3]>),
    /// Another elementary function, of a cell.
    Function { out: Cell, function: Function, of: Cell },
}

/// The machine code of a program.
#[derive(Debug)]
pub(super) struct MachineCode {
    code: Mmap,
    parts: Vec<CodePart>,
    cells: usize,
    width: Width,
}

impl MachineCode {
    /// Returns the machine code of a program; `None` where the processor lacks its instructions or the system refuses
    /// executable memory, and for a program that is too large.
    pub(super) fn new(program: &Program, width: Width) -> Option<Self> {
        if !is_allowed() || !width.is_here() {
            return None;
        }
        let mut encoder = Encoder::new(width);
        let parts = parts(program, &mut encoder)?;
        let bytes = encoder.finish();
        if bytes.len() > MOST_BYTES {
            return None;
        }
        // The memory is first writable, then executable, never both.
        let mut memory = MmapMut::map_anon(bytes.len().max(1)).ok()?;
        memory[..bytes.len()].copy_from_slice(&bytes);
        Some(MachineCode { code: memory.make_exec().ok()?, parts, cells: program.cells, width })
    }

    /// Runs the program on its cells.
    ///
    /// # Panics
    /// Panics if there are fewer cells than the program has, or if they have another size than those of the code.
    pub(super) fn run<S: Vector, T: Numbers<S>>(&self, simd: S, memory: &mut [T]) {
        for part in &self.parts {
            match part {
                CodePart::Code(place) => self.call(*place, memory),
                CodePart::Turns(turns) => vectorized!(simd, T::sines_cosines(simd, memory, turns)),
                CodePart::Function { out, function, of } => {
                    memory[*out as usize] = memory[*of as usize].image(*function);
                }
            }
        }
    }

    /// Runs the code at a place.
    #[allow(unsafe_code)]
    fn call<S: Vector, T: Numbers<S>>(&self, place: usize, memory: &mut [T]) {
        assert!(memory.len() >= self.cells, "a program needs all of its cells");
        assert!(self.width.bytes() == size_of::<T>(), "the code is for other cells");
        // Unsafe because the compiler cannot see that bytes are a function.
        // SAFETY: `place` is the start of a function in `code`, between `Encoder::begin` and `Encoder::end`. The function has
        // this calling convention, changes no registers but those that a function may change, and has no branch before its
        // return. The processor has its instructions: `new` makes no other code.
        let function: unsafe extern "sysv64" fn(*mut f64) =
            unsafe { std::mem::transmute(self.code.as_ptr().add(place)) };
        let cells = memory.as_mut_ptr().cast::<f64>();
        // Unsafe because the function reads and writes memory by address.
        // SAFETY: the function reads and writes cells below `self.cells` (`registers::assign` refuses others), each of
        // `Width::bytes` bytes; the assertions above ensure that `memory` has at least `self.cells` cells of this size. Cells consist of numbers
        // (`Numbers` has no other types). Code for half of the lanes reads and writes the first four numbers of a cell from the
        // pointer on.
        unsafe {
            function(cells);
            if self.width == Width::Four {
                function(cells.add(LANES / 2));
            }
        }
    }
}

/// Writes the code of a program, and returns its parts.
fn parts(program: &Program, encoder: &mut Encoder) -> Option<Vec<CodePart>> {
    let is_call = |instruction: &Instruction| {
        matches!(instruction, Instruction::SineCosine { .. } | Instruction::Function { .. })
    };
    let mut parts: Vec<CodePart> = Vec::new();
    let mut rest = &program.instructions[..];
    // The last read of each cell, counted in instructions that are left.
    let mut last_read = vec![usize::MAX; program.cells];
    for (place, instruction) in rest.iter().enumerate() {
        for cell in program.reads(instruction) {
            *last_read.get_mut(cell as usize)? = rest.len() - place;
        }
    }
    while let Some(first) = rest.first() {
        match *first {
            Instruction::SineCosine { sine, cosine, of } => {
                let turn = [sine, cosine, of];
                match parts.last_mut() {
                    // Sines and cosines do not depend on each other, unless one is the angle of the next.
                    Some(CodePart::Turns(turns))
                        if turns.iter().all(|[s, c, _]| *s != of && *c != of) =>
                    {
                        turns.push(turn);
                    }
                    _ => parts.push(CodePart::Turns(vec![turn])),
                }
            }
            Instruction::Function { out, function, of } => {
                parts.push(CodePart::Function { out, function, of });
            }
            _ => {
                let count = rest.iter().position(is_call).unwrap_or(rest.len());
                let (part, later) = rest.split_at(count);
                // A cell that is read after this part is stored.
                let stored = |cell: u32| {
                    program.kept[cell as usize] || last_read[cell as usize] <= later.len()
                };
                let lowered = lower::lower(program, part, stored, encoder.width);
                let cells = lowered.values.iter().map(|value| value.cell);
                let is_size = |line: &Line| matches!(line.operation, MachineOperation::Size(_));
                let has_sizes = lowered.lines.iter().any(is_size);
                parts.push(CodePart::Code(encoder.begin(cells, has_sizes)?));
                registers::assign(lowered, encoder, program.cells)?;
                encoder.end()?;
                rest = later;
                continue;
            }
        }
        rest = &rest[1..];
    }
    Some(parts)
}

#[cfg(test)]
mod tests;
