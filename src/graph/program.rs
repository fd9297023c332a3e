//! Straight-line programs over cells.

use std::sync::Arc;

use crate::model::Function;

/// The place of a number of each lane.
pub(crate) type Cell = u32;

/// A step of a program. Each cell is written at most once, so that it has one meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Instruction {
    /// `start ± a b ± c d ± …`, with one fused multiply-add for each product, in their order. Without a start, the first product
    /// is rounded by itself and not subtracted.
    Sum {
        out: Cell,
        start: Option<Cell>,
        /// The place and the number of the products in [`Program::products`].
        products: [u32; 2],
    },
    /// `of / by`
    Quotient { out: Cell, of: Cell, by: Cell },
    /// `sqrt of`
    SquareRoot { out: Cell, of: Cell },
    /// `|of|`
    Size { out: Cell, of: Cell },
    /// `then` if `less[0] < less[1]`, else `other`
    Choice { out: Cell, less: [Cell; 2], then: Cell, other: Cell },
    /// Sine and cosine.
    SineCosine { sine: Cell, cosine: Cell, of: Cell },
    /// Another elementary function.
    Function { out: Cell, function: Function, of: Cell },
}

/// A product in a sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Product {
    pub(crate) factors: [Cell; 2],
    /// Whether it is subtracted.
    pub(crate) subtracts: bool,
}

impl Product {
    /// A product that is added.
    pub(crate) fn plus(factors: [Cell; 2]) -> Self {
        Product { factors, subtracts: false }
    }

    /// A product that is subtracted.
    pub(crate) fn minus(factors: [Cell; 2]) -> Self {
        Product { factors, subtracts: true }
    }
}

/// Instructions over cells. They have no branches, and every operation is correctly rounded.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Program {
    pub(crate) instructions: Vec<Instruction>,
    /// The products of all sums; parts of a program share them.
    pub(crate) products: Arc<Vec<Product>>,
    /// The number of cells.
    pub(crate) cells: usize,
    /// The cells that contain the same number whenever the program starts.
    pub(crate) numbers: Arc<Vec<(Cell, f64)>>,
    /// Whether each cell is read after the end of the program.
    pub(crate) kept: Vec<bool>,
}

impl Program {
    /// Returns products by their place and number.
    pub(crate) fn products(&self, [first, count]: [u32; 2]) -> &[Product] {
        &self.products[first as usize..][..count as usize]
    }

    /// Returns the number of products.
    pub(crate) fn cost(&self) -> u32 {
        let of = |instruction: &Instruction| match instruction {
            Instruction::Sum { products, .. } => products[1],
            _ => 0,
        };
        self.instructions.iter().map(of).sum()
    }

    /// Returns the cells that an instruction reads.
    pub(crate) fn reads(&self, instruction: &Instruction) -> impl Iterator<Item = Cell> {
        let mut copy = *instruction;
        let (_, few) = copy.cells();
        let few = few.map(|cell| cell.copied());
        let products = match *instruction {
            Instruction::Sum { products, .. } => self.products(products),
            _ => &[],
        };
        let factors = products.iter().flat_map(|product| product.factors);
        few.into_iter().flatten().chain(factors)
    }

    /// Returns the program in parts that run one after another: each part computes the cells that are kept after it, and what
    /// the parts before it have not computed. Instructions whose results nobody reads are left out.
    pub(crate) fn parts<const N: usize>(&self, kept: [&[Cell]; N]) -> [Program; N] {
        let mut known = vec![false; self.cells];
        let mut parts = kept.map(|kept| {
            let mut part = Program { kept: vec![false; self.cells], ..self.clone() };
            kept.iter().for_each(|cell| part.kept[*cell as usize] = true);
            part.instructions.retain(|step| !step.writes().any(|cell| known[cell as usize]));
            let part = part.without_unused();
            for cell in part.instructions.iter().flat_map(Instruction::writes) {
                known[cell as usize] = true;
            }
            part
        });
        for (later, kept) in kept.iter().enumerate() {
            let (before, after) = parts.split_at_mut(later);
            for part in before {
                kept.iter().for_each(|cell| part.kept[*cell as usize] = true);
                part.keep_for(&after[0]);
            }
        }
        parts
    }

    /// Returns the instructions that do not depend on these cells, and the others, which run after them.
    pub(crate) fn split(&self, varying: impl IntoIterator<Item = Cell>) -> [Program; 2] {
        let mut varies = vec![false; self.cells];
        varying.into_iter().for_each(|cell| varies[cell as usize] = true);
        let mut parts = [(); 2].map(|()| Program { instructions: Vec::new(), ..self.clone() });
        for instruction in &self.instructions {
            let depends = self.reads(instruction).any(|cell| varies[cell as usize]);
            if depends {
                instruction.writes().for_each(|cell| varies[cell as usize] = true);
            }
            parts[usize::from(depends)].instructions.push(*instruction);
        }
        let [mut constant, varying] = parts;
        constant.keep_for(&varying);
        [constant, varying]
    }

    /// Keeps the cells that a later program reads.
    pub(crate) fn keep_for(&mut self, later: &Program) {
        for instruction in &later.instructions {
            for cell in later.reads(instruction) {
                if let Some(kept) = self.kept.get_mut(cell as usize) {
                    *kept = true;
                }
            }
        }
    }

    /// Moves elementary functions of cells that the program does not write to its begin, where they stand together.
    pub(crate) fn with_functions_first(mut self) -> Self {
        let mut written = vec![false; self.cells];
        let cells = self.instructions.iter().flat_map(Instruction::writes);
        cells.for_each(|cell| written[cell as usize] = true);
        self.instructions.sort_by_key(|instruction| match instruction {
            Instruction::SineCosine { of, .. } => u8::from(written[*of as usize]),
            Instruction::Function { of, .. } => u8::from(written[*of as usize]),
            _ => 1,
        });
        self
    }

    /// Removes the instructions whose results nobody reads.
    pub(crate) fn without_unused(mut self) -> Self {
        let mut used = self.kept.clone();
        let is_used = |instruction: &Instruction| {
            let used_here = instruction.writes().any(|cell| used[cell as usize]);
            if used_here {
                self.reads(instruction).for_each(|cell| used[cell as usize] = true);
            }
            used_here
        };
        let mut left: Vec<Instruction> =
            self.instructions.iter().rev().copied().filter(is_used).collect();
        left.reverse();
        self.instructions = left;
        self
    }
}

impl Instruction {
    /// Returns the cells that the instruction writes, and those that it reads; the factors of sums are in the program.
    fn cells(&mut self) -> ([Option<&mut Cell>; 2], [Option<&mut Cell>; 4]) {
        match self {
            Instruction::Sum { out, start, .. } => {
                ([Some(out), None], [start.as_mut(), None, None, None])
            }
            Instruction::Quotient { out, of, by } => {
                ([Some(out), None], [Some(of), Some(by), None, None])
            }
            Instruction::SquareRoot { out, of }
            | Instruction::Size { out, of }
            | Instruction::Function { out, of, .. } => {
                ([Some(out), None], [Some(of), None, None, None])
            }
            Instruction::Choice { out, less: [a, b], then, other } => {
                ([Some(out), None], [Some(a), Some(b), Some(then), Some(other)])
            }
            Instruction::SineCosine { sine, cosine, of } => {
                ([Some(sine), Some(cosine)], [Some(of), None, None, None])
            }
        }
    }

    /// Returns the instruction with other cells. Products of sums are those of the program.
    pub(crate) fn renamed(mut self, at: impl Fn(Cell) -> Cell) -> Self {
        let (writes, reads) = self.cells();
        writes.into_iter().chain(reads).flatten().for_each(|cell| *cell = at(*cell));
        self
    }

    /// Returns the cells that the instruction writes.
    pub(crate) fn writes(&self) -> impl Iterator<Item = Cell> + use<> {
        let mut copy = *self;
        let (writes, _) = copy.cells();
        writes.map(|cell| cell.copied()).into_iter().flatten()
    }
}
