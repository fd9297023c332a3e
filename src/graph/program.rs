//! Straight-line programs over cells.

use std::sync::Arc;

/// The place of a number of each lane.
pub(crate) type Cell = u32;

/// A step of a program. Each cell is written at most once, so that it has one meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Instruction {
    /// `start + a b + c d + …`, or `start - a b - c d - …`, with one fused multiply-add for each product, in their order.
    /// Without a start, the first product is rounded by itself, and nothing is subtracted.
    Sum {
        out: Cell,
        start: Option<Cell>,
        subtracts: bool,
        /// The place and the number of the products in [`Program::products`].
        products: [u32; 2],
    },
    /// `of / by`
    Quotient { out: Cell, of: Cell, by: Cell },
    /// `sqrt of`
    SquareRoot { out: Cell, of: Cell },
    /// `then` if `less[0] < less[1]`, else `other`
    Choice { out: Cell, less: [Cell; 2], then: Cell, other: Cell },
    /// Sine and cosine.
    SineCosine { sine: Cell, cosine: Cell, of: Cell },
    /// Another elementary function.
    Function { out: Cell, function: Function, of: Cell },
}

/// An elementary function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Function {
    Exponential,
    ArcTangent,
}

impl Function {
    /// Returns the value of the function.
    pub(crate) fn of(self, number: f64) -> f64 {
        match self {
            Function::Exponential => libm::exp(number),
            Function::ArcTangent => libm::atan(number),
        }
    }
}

/// Instructions over cells. They have no branches, and every operation is correctly rounded.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Program {
    pub(crate) instructions: Vec<Instruction>,
    /// The factors of the products of all sums; parts of a program share them.
    pub(crate) products: Arc<Vec<[Cell; 2]>>,
    /// The number of cells.
    pub(crate) cells: usize,
    /// The cells that contain the same number whenever the program starts.
    pub(crate) numbers: Arc<Vec<(Cell, f64)>>,
    /// Whether each cell is read after the end of the program.
    pub(crate) kept: Vec<bool>,
}

impl Program {
    /// Returns products by their place and number.
    pub(crate) fn products(&self, [first, count]: [u32; 2]) -> &[[Cell; 2]] {
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
        let (few, products): ([Option<Cell>; 4], &[[Cell; 2]]) = match *instruction {
            Instruction::Sum { start, products, .. } => {
                ([start, None, None, None], self.products(products))
            }
            Instruction::Quotient { of, by, .. } => ([Some(of), Some(by), None, None], &[]),
            Instruction::SquareRoot { of, .. }
            | Instruction::SineCosine { of, .. }
            | Instruction::Function { of, .. } => ([Some(of), None, None, None], &[]),
            Instruction::Choice { less: [x, y], then, other, .. } => {
                ([x, y, then, other].map(Some), &[])
            }
        };
        few.into_iter().flatten().chain(products.iter().flatten().copied())
    }

    /// Returns the program in parts that run one after another: each part computes the cells that are kept after it, and what
    /// the parts before it have not computed. Instructions whose results nobody reads are left out.
    pub(crate) fn parts<const N: usize>(&self, kept: [&[Cell]; N]) -> [Program; N] {
        let mut known = vec![false; self.cells];
        let mut parts = kept.map(|kept| {
            let mut part = Program { kept: vec![false; self.cells], ..self.clone() };
            kept.iter().for_each(|cell| part.kept[*cell as usize] = true);
            part.instructions.retain(|one| !one.writes().any(|cell| known[cell as usize]));
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
    /// Returns the cells that the instruction writes.
    pub(crate) fn writes(&self) -> impl Iterator<Item = Cell> {
        let (one, other) = match *self {
            Instruction::SineCosine { sine, cosine, .. } => (sine, Some(cosine)),
            Instruction::Sum { out, .. }
            | Instruction::Quotient { out, .. }
            | Instruction::SquareRoot { out, .. }
            | Instruction::Choice { out, .. }
            | Instruction::Function { out, .. } => (out, None),
        };
        std::iter::once(one).chain(other)
    }
}
