//! Machine instructions for registers and cells.

use std::collections::BTreeMap;

use iced_x86::{Code, Encoder as Assembler, IcedError, Instruction, MemoryOperand, Register};

use super::Width;
use crate::graph::Cell;
use crate::motion::lockstep::LANES;

/// An operand.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    Register(usize),
    Cell(Cell),
}

/// Writes machine instructions. The first argument of each function, in the register `rdi`, points to the cells.
pub(super) struct Encoder {
    assembler: Assembler,
    position: u64,
    width: Width,
    /// Ranges of [`NEAR`] cells, and registers that point to their middles.
    ranges: Vec<(Cell, Register)>,
}

/// The number of cells that short instructions of AVX-512 reach from a register.
const NEAR: Cell = 256;

/// Registers that a function may change, besides `rdi`.
const POINTERS: [Register; 8] = [
    Register::RAX,
    Register::RCX,
    Register::RDX,
    Register::RSI,
    Register::R8,
    Register::R9,
    Register::R10,
    Register::R11,
];

/// A program without machine code, for example because it reads a cell that it does not have.
pub(super) struct NotEncoded;

impl From<IcedError> for NotEncoded {
    fn from(_: IcedError) -> Self {
        NotEncoded
    }
}

/// Whether instructions were written.
pub(super) type Encoded<T = ()> = Result<T, NotEncoded>;

/// Less than; false for NaN, which raises no exception.
const LESS: u32 = 0x11;

impl Encoder {
    pub(super) fn new(width: Width) -> Self {
        Encoder { assembler: Assembler::new(64), position: 0, width, ranges: Vec::new() }
    }

    pub(super) fn width(&self) -> Width {
        self.width
    }

    /// Returns the number of vector registers.
    pub(super) fn registers(&self) -> usize {
        match self.width {
            Width::Eight => 32,
            Width::Four => 16,
        }
    }

    /// Begins a function that reads and writes these cells, and returns its place.
    pub(super) fn begin(&mut self, cells: impl Iterator<Item = Cell>) -> Encoded<usize> {
        let place = self.position as usize;
        self.ranges.clear();
        if self.width == Width::Eight {
            let mut counts: BTreeMap<Cell, usize> = BTreeMap::new();
            cells.for_each(|cell| *counts.entry(cell / NEAR).or_default() += 1);
            let mut counts: Vec<_> = counts.into_iter().collect();
            counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
            for ((range, _), register) in counts.into_iter().zip(POINTERS) {
                let middle = Self::displaced(Register::RDI, range * NEAR + NEAR / 2);
                self.put(Instruction::with2(Code::Lea_r64_m, register, middle))?;
                self.ranges.push((range, register));
            }
        }
        Ok(place)
    }

    /// Ends a function.
    pub(super) fn end(&mut self) -> Encoded {
        self.put(Ok(Instruction::with(Code::VEX_Vzeroupper)))?;
        self.put(Ok(Instruction::with(Code::Retnq)))
    }

    /// Returns the code.
    pub(super) fn finish(mut self) -> Vec<u8> {
        self.assembler.take_buffer()
    }

    fn put(&mut self, instruction: Result<Instruction, IcedError>) -> Encoded {
        self.position += self.assembler.encode(&instruction?, self.position)? as u64;
        Ok(())
    }

    fn pick(&self, eight: Code, four: Code) -> Code {
        match self.width {
            Width::Eight => eight,
            Width::Four => four,
        }
    }

    fn register(&self, number: usize) -> Register {
        let first = match self.width {
            Width::Eight => Register::ZMM0,
            Width::Four => Register::YMM0,
        };
        first + number as u32
    }

    fn displaced(register: Register, cells: impl Into<i64>) -> MemoryOperand {
        MemoryOperand::with_base_displ(register, cells.into() * 8 * LANES as i64)
    }

    fn memory(&self, cell: Cell) -> MemoryOperand {
        match self.ranges.iter().find(|(range, _)| *range == cell / NEAR) {
            Some((range, register)) => {
                Self::displaced(*register, i64::from(cell) - i64::from(range * NEAR + NEAR / 2))
            }
            None => Self::displaced(Register::RDI, cell),
        }
    }

    pub(super) fn load(&mut self, to: usize, cell: Cell) -> Encoded {
        let code = self.pick(Code::EVEX_Vmovupd_zmm_k1z_zmmm512, Code::VEX_Vmovupd_ymm_ymmm256);
        self.put(Instruction::with2(code, self.register(to), self.memory(cell)))
    }

    pub(super) fn store(&mut self, cell: Cell, from: usize) -> Encoded {
        let code = self.pick(Code::EVEX_Vmovupd_zmmm512_k1z_zmm, Code::VEX_Vmovupd_ymmm256_ymm);
        self.put(Instruction::with2(code, self.memory(cell), self.register(from)))
    }

    fn two(&mut self, code: Code, to: usize, of: usize) -> Encoded {
        self.put(Instruction::with2(code, self.register(to), self.register(of)))
    }

    fn three(&mut self, code: Code, to: usize, a: usize, b: Place) -> Encoded {
        let [to, a] = [to, a].map(|number| self.register(number));
        self.put(match b {
            Place::Register(b) => Instruction::with3(code, to, a, self.register(b)),
            Place::Cell(cell) => Instruction::with3(code, to, a, self.memory(cell)),
        })
    }

    pub(super) fn copy(&mut self, to: usize, of: usize) -> Encoded {
        let code = self.pick(Code::EVEX_Vmovapd_zmm_k1z_zmmm512, Code::VEX_Vmovapd_ymm_ymmm256);
        self.two(code, to, of)
    }

    pub(super) fn square_root(&mut self, to: usize, of: usize) -> Encoded {
        let code =
            self.pick(Code::EVEX_Vsqrtpd_zmm_k1z_zmmm512b64_er, Code::VEX_Vsqrtpd_ymm_ymmm256);
        self.two(code, to, of)
    }

    /// Clears the sign of each number.
    pub(super) fn size(&mut self, to: usize, of: usize) -> Encoded {
        let [shifts_left, shifts_right] = match self.width {
            Width::Eight => [
                Code::EVEX_Vpsllq_zmm_k1z_zmmm512b64_imm8,
                Code::EVEX_Vpsrlq_zmm_k1z_zmmm512b64_imm8,
            ],
            Width::Four => [Code::VEX_Vpsllq_ymm_ymm_imm8, Code::VEX_Vpsrlq_ymm_ymm_imm8],
        };
        for (code, from) in [(shifts_left, of), (shifts_right, to)] {
            let [to, from] = [to, from].map(|number| self.register(number));
            self.put(Instruction::with3(code, to, from, 1_u32))?;
        }
        Ok(())
    }

    pub(super) fn product(&mut self, to: usize, a: usize, b: Place) -> Encoded {
        let code = self
            .pick(Code::EVEX_Vmulpd_zmm_k1z_zmm_zmmm512b64_er, Code::VEX_Vmulpd_ymm_ymm_ymmm256);
        self.three(code, to, a, b)
    }

    pub(super) fn quotient(&mut self, to: usize, of: usize, by: Place) -> Encoded {
        let code = self
            .pick(Code::EVEX_Vdivpd_zmm_k1z_zmm_zmmm512b64_er, Code::VEX_Vdivpd_ymm_ymm_ymmm256);
        self.three(code, to, of, by)
    }

    /// Adds `a b` to a register, or subtracts it.
    pub(super) fn fused(&mut self, sum: usize, a: usize, b: Place, subtracts: bool) -> Encoded {
        let code = if subtracts {
            self.pick(
                Code::EVEX_Vfnmadd231pd_zmm_k1z_zmm_zmmm512b64_er,
                Code::VEX_Vfnmadd231pd_ymm_ymm_ymmm256,
            )
        } else {
            self.pick(
                Code::EVEX_Vfmadd231pd_zmm_k1z_zmm_zmmm512b64_er,
                Code::VEX_Vfmadd231pd_ymm_ymm_ymmm256,
            )
        };
        self.three(code, sum, a, b)
    }

    /// Writes the third register where the first is less than the second, else the fourth. `to` is none of them.
    pub(super) fn choice(&mut self, to: usize, of: [usize; 4]) -> Encoded {
        let [a, b, then, other] = of.map(|number| self.register(number));
        let to = self.register(to);
        match self.width {
            Width::Eight => {
                let compare = Code::EVEX_Vcmppd_kr_k1_zmm_zmmm512b64_imm8_sae;
                self.put(Instruction::with4(compare, Register::K1, a, b, LESS))?;
                let blend = Code::EVEX_Vblendmpd_zmm_k1z_zmm_zmmm512b64;
                let mut blend = Instruction::with3(blend, to, other, then)?;
                blend.set_op_mask(Register::K1);
                self.put(Ok(blend))
            }
            Width::Four => {
                let compare = Code::VEX_Vcmppd_ymm_ymm_ymmm256_imm8;
                self.put(Instruction::with4(compare, to, a, b, LESS))?;
                let blend = Code::VEX_Vblendvpd_ymm_ymm_ymmm256_ymm;
                self.put(Instruction::with4(blend, to, other, then, to))
            }
        }
    }
}
