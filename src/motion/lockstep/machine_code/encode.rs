//! Machine instructions for registers and cells.

use std::collections::BTreeMap;

use iced_x86::{Code, Encoder as Assembler, IcedError, Instruction, MemoryOperand, Register};

use crate::graph::Cell;
use crate::motion::lockstep::vector::Width;

/// An operand.
#[derive(Clone, Copy, Debug)]
pub(super) enum Operand {
    Register(usize),
    Cell(Cell),
}

/// Writes machine instructions. The first argument of each function, in the register `rdi`, points to the cells.
pub(super) struct Encoder {
    assembler: Assembler,
    position: u64,
    pub(super) width: Width,
    /// Whether the last register contains all bits but the sign.
    has_mask: bool,
    /// Ranges of [`Encoder::near`] cells, and registers that point to their middles.
    ranges: Vec<(Cell, Register)>,
}

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

/// `None` for a program without machine code, for example because it reads a cell that it does not have.
pub(super) type Encoded<T = ()> = Option<T>;

/// Less than; false for NaN, which raises no exception.
const LESS: u32 = 0x11;

/// Operations with two operands: their codes for eight, four and one numbers.
macro_rules! three {
    ($($(#[$doc:meta])* $name:ident: $eight:ident, $four:ident, $one:ident;)*) => {
        $($(#[$doc])*
        pub(super) fn $name(&mut self, to: usize, a: usize, b: Operand) -> Encoded {
            self.three(self.pick([Code::$eight, Code::$four, Code::$one]), to, a, b)
        })*
    };
}

impl Encoder {
    pub(super) fn new(width: Width) -> Self {
        let assembler = Assembler::new(64);
        Encoder { assembler, position: 0, width, has_mask: false, ranges: Vec::new() }
    }

    /// Returns the number of vector registers for values.
    pub(super) fn registers(&self) -> usize {
        self.all_registers() - usize::from(self.has_mask)
    }

    fn all_registers(&self) -> usize {
        match self.width {
            Width::Eight => 32,
            Width::Four | Width::One => 16,
        }
    }

    /// Returns the register with all bits but the sign.
    fn mask(&self) -> Register {
        self.register(self.all_registers() - 1)
    }

    /// Returns the number of cells that short instructions reach from a register.
    fn near(&self) -> Option<Cell> {
        match self.width {
            Width::Eight => Some(256),
            Width::Four => None,
            Width::One => Some(32),
        }
    }

    /// Begins a function that reads and writes these cells, and returns its place. Only a function that is said to do so
    /// computes sizes.
    pub(super) fn begin(
        &mut self,
        cells: impl Iterator<Item = Cell>,
        has_sizes: bool,
    ) -> Encoded<usize> {
        let place = self.position as usize;
        self.has_mask = has_sizes;
        if has_sizes {
            let mask = self.mask();
            let ones = match self.width {
                Width::Eight => {
                    let code = Code::EVEX_Vpternlogq_zmm_k1z_zmm_zmmm512b64_imm8;
                    Instruction::with4(code, mask, mask, mask, 0xff_u32)
                }
                Width::Four => {
                    Instruction::with3(Code::VEX_Vpcmpeqd_ymm_ymm_ymmm256, mask, mask, mask)
                }
                Width::One => {
                    Instruction::with3(Code::VEX_Vpcmpeqd_xmm_xmm_xmmm128, mask, mask, mask)
                }
            };
            self.put(ones)?;
            let shift = self.pick([
                Code::EVEX_Vpsrlq_zmm_k1z_zmmm512b64_imm8,
                Code::VEX_Vpsrlq_ymm_ymm_imm8,
                Code::VEX_Vpsrlq_xmm_xmm_imm8,
            ]);
            self.put(Instruction::with3(shift, mask, mask, 1_u32))?;
        }
        self.ranges.clear();
        if let Some(near) = self.near() {
            let mut counts: BTreeMap<Cell, usize> = BTreeMap::new();
            cells.for_each(|cell| *counts.entry(cell / near).or_default() += 1);
            let mut counts: Vec<_> = counts.into_iter().collect();
            counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
            for ((range, _), register) in counts.into_iter().zip(POINTERS) {
                let middle = self.displaced(Register::RDI, range * near + near / 2);
                self.put(Instruction::with2(Code::Lea_r64_m, register, middle))?;
                self.ranges.push((range, register));
            }
        }
        Some(place)
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
        self.position += self.assembler.encode(&instruction.ok()?, self.position).ok()? as u64;
        Some(())
    }

    fn pick(&self, [eight, four, one]: [Code; 3]) -> Code {
        match self.width {
            Width::Eight => eight,
            Width::Four => four,
            Width::One => one,
        }
    }

    fn register(&self, number: usize) -> Register {
        let first = match self.width {
            Width::Eight => Register::ZMM0,
            Width::Four => Register::YMM0,
            Width::One => Register::XMM0,
        };
        first + number as u32
    }

    fn displaced(&self, register: Register, cells: impl Into<i64>) -> MemoryOperand {
        MemoryOperand::with_base_displ(register, cells.into() * self.width.bytes() as i64)
    }

    fn memory(&self, cell: Cell) -> MemoryOperand {
        let near = self.near().unwrap_or(Cell::MAX);
        match self.ranges.iter().find(|(range, _)| *range == cell / near) {
            Some((range, register)) => {
                self.displaced(*register, i64::from(cell) - i64::from(range * near + near / 2))
            }
            None => self.displaced(Register::RDI, cell),
        }
    }

    pub(super) fn load(&mut self, to: usize, cell: Cell) -> Encoded {
        let code = self.pick([
            Code::EVEX_Vmovupd_zmm_k1z_zmmm512,
            Code::VEX_Vmovupd_ymm_ymmm256,
            Code::VEX_Vmovsd_xmm_m64,
        ]);
        self.put(Instruction::with2(code, self.register(to), self.memory(cell)))
    }

    pub(super) fn store(&mut self, cell: Cell, from: usize) -> Encoded {
        let code = self.pick([
            Code::EVEX_Vmovupd_zmmm512_k1z_zmm,
            Code::VEX_Vmovupd_ymmm256_ymm,
            Code::VEX_Vmovsd_m64_xmm,
        ]);
        self.put(Instruction::with2(code, self.memory(cell), self.register(from)))
    }

    fn three(&mut self, code: Code, to: usize, a: usize, b: Operand) -> Encoded {
        let [to, a] = [to, a].map(|number| self.register(number));
        self.put(match b {
            Operand::Register(b) => Instruction::with3(code, to, a, self.register(b)),
            Operand::Cell(cell) => Instruction::with3(code, to, a, self.memory(cell)),
        })
    }

    pub(super) fn copy(&mut self, to: usize, of: usize) -> Encoded {
        let code = self.pick([
            Code::EVEX_Vmovapd_zmm_k1z_zmmm512,
            Code::VEX_Vmovapd_ymm_ymmm256,
            Code::VEX_Vmovapd_xmm_xmmm128,
        ]);
        self.put(Instruction::with2(code, self.register(to), self.register(of)))
    }

    pub(super) fn square_root(&mut self, to: usize, of: usize) -> Encoded {
        let code = self.pick([
            Code::EVEX_Vsqrtpd_zmm_k1z_zmmm512b64_er,
            Code::VEX_Vsqrtpd_ymm_ymmm256,
            Code::VEX_Vsqrtsd_xmm_xmm_xmmm64,
        ]);
        if self.width == Width::One {
            return self.three(code, to, of, Operand::Register(of));
        }
        self.put(Instruction::with2(code, self.register(to), self.register(of)))
    }

    /// Clears the sign of each number.
    pub(super) fn size(&mut self, to: usize, of: usize) -> Encoded {
        let code = self.pick([
            Code::EVEX_Vpandq_zmm_k1z_zmm_zmmm512b64,
            Code::VEX_Vandpd_ymm_ymm_ymmm256,
            Code::VEX_Vandpd_xmm_xmm_xmmm128,
        ]);
        self.three(code, to, self.all_registers() - 1, Operand::Register(of))
    }

    three! {
        product: EVEX_Vmulpd_zmm_k1z_zmm_zmmm512b64_er, VEX_Vmulpd_ymm_ymm_ymmm256, VEX_Vmulsd_xmm_xmm_xmmm64;
        quotient: EVEX_Vdivpd_zmm_k1z_zmm_zmmm512b64_er, VEX_Vdivpd_ymm_ymm_ymmm256, VEX_Vdivsd_xmm_xmm_xmmm64;
        /// Writes `a` where it is less than `b`, and `b` elsewhere, also where one of them is not a number.
        smaller: EVEX_Vminpd_zmm_k1z_zmm_zmmm512b64_sae, VEX_Vminpd_ymm_ymm_ymmm256, VEX_Vminsd_xmm_xmm_xmmm64;
        /// Writes `a` where it is greater than `b`, and `b` elsewhere, also where one of them is not a number.
        larger: EVEX_Vmaxpd_zmm_k1z_zmm_zmmm512b64_sae, VEX_Vmaxpd_ymm_ymm_ymmm256, VEX_Vmaxsd_xmm_xmm_xmmm64;
    }

    /// Adds `a b` to a register, or subtracts it.
    pub(super) fn fused(&mut self, sum: usize, a: usize, b: Operand, subtracts: bool) -> Encoded {
        let codes = if subtracts {
            [
                Code::EVEX_Vfnmadd231pd_zmm_k1z_zmm_zmmm512b64_er,
                Code::VEX_Vfnmadd231pd_ymm_ymm_ymmm256,
                Code::VEX_Vfnmadd231sd_xmm_xmm_xmmm64,
            ]
        } else {
            [
                Code::EVEX_Vfmadd231pd_zmm_k1z_zmm_zmmm512b64_er,
                Code::VEX_Vfmadd231pd_ymm_ymm_ymmm256,
                Code::VEX_Vfmadd231sd_xmm_xmm_xmmm64,
            ]
        };
        self.three(self.pick(codes), sum, a, b)
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
                let mut blend = Instruction::with3(blend, to, other, then).ok()?;
                blend.set_op_mask(Register::K1);
                self.put(Ok(blend))
            }
            Width::Four | Width::One => {
                let [compare, blend] = if self.width == Width::Four {
                    [Code::VEX_Vcmppd_ymm_ymm_ymmm256_imm8, Code::VEX_Vblendvpd_ymm_ymm_ymmm256_ymm]
                } else {
                    [Code::VEX_Vcmpsd_xmm_xmm_xmmm64_imm8, Code::VEX_Vblendvpd_xmm_xmm_xmmm128_xmm]
                };
                self.put(Instruction::with4(compare, to, a, b, LESS))?;
                self.put(Instruction::with4(blend, to, other, then, to))
            }
        }
    }
}
