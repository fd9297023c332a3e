//! The changes of all cells of a program along a displacement, to first order: each instruction is differentiated (forward
//! mode; A. Griewank, A. Walther, *Evaluating Derivatives*, 2nd ed., SIAM 2008, chapter 3,
//! doi:10.1137/1.9780898717761).

use super::builder::Builder;
use super::program::{Cell, Instruction, Product, Program};
use crate::model::Function;

/// Returns the program that computes the changes of the cells in `kept` from those of the cells in `displaced`. It runs after
/// the program itself and reads its cells. The change of a cell has the place of the cell plus [`Program::cells`]. Cells that
/// do not change are not written.
pub(crate) fn tangent(
    program: &Program,
    displaced: impl IntoIterator<Item = Cell>,
    kept: impl IntoIterator<Item = Cell>,
) -> Program {
    let cells = program.cells;
    let mut changes = TangentBuilder {
        builder: Builder::with_cells(2 * cells),
        offset: cells as Cell,
        changed: vec![false; cells],
    };
    program.numbers.iter().for_each(|(cell, number)| changes.builder.define(*cell, *number));
    displaced.into_iter().for_each(|cell| changes.changed[cell as usize] = true);
    for instruction in &program.instructions {
        if program.reads(instruction).any(|cell| changes.changed[cell as usize]) {
            changes.differentiate(program, instruction);
            instruction.writes().for_each(|cell| changes.changed[cell as usize] = true);
        }
    }
    let TangentBuilder { builder, offset, changed } = changes;
    builder
        .finish(kept.into_iter().filter(|cell| changed[*cell as usize]).map(|cell| cell + offset))
}

struct TangentBuilder {
    builder: Builder,
    offset: Cell,
    /// Whether each cell changes.
    changed: Vec<bool>,
}

impl TangentBuilder {
    /// Returns the change of a cell, unless it is zero.
    fn of(&self, cell: Cell) -> Option<Cell> {
        self.changed[cell as usize].then_some(cell + self.offset)
    }

    fn differentiate(&mut self, program: &Program, instruction: &Instruction) {
        let offset = self.offset;
        match *instruction {
            Instruction::Sum { out, start, products } => {
                let mut terms = Vec::new();
                for &Product { factors: [a, b], subtracts } in program.products(products) {
                    let term = |factors| Product { factors, subtracts };
                    terms.extend(self.of(a).map(|change| term([change, b])));
                    terms.extend(self.of(b).map(|change| term([a, change])));
                }
                let start = start.and_then(|start| self.of(start));
                self.builder.combine(out + offset, start, terms);
            }
            Instruction::Quotient { out, of, by } => {
                // q' = (a' - q b') / b
                let change = self.of(of);
                let products: Vec<_> = self.of(by).map(|by| [out, by]).into_iter().collect();
                let of = self.builder.difference(change, &products);
                self.builder.add(Instruction::Quotient { out: out + offset, of, by });
            }
            Instruction::SquareRoot { out, of } => {
                // r' = a' / 2r
                let two = self.builder.number(2.0);
                let by = self.builder.product(two, out);
                let of = of + offset;
                self.builder.add(Instruction::Quotient { out: out + offset, of, by });
            }
            Instruction::Size { out, of } => {
                // |a|' = a' where a > 0, else -a'
                let [zero, one] = [0.0, 1.0].map(|number| self.builder.number(number));
                let change = of + offset;
                let minus = self.builder.difference(None, &[[one, change]]);
                let (less, then) = ([zero, of], change);
                self.builder.add(Instruction::Choice {
                    out: out + offset,
                    less,
                    then,
                    other: minus,
                });
            }
            Instruction::Choice { out, less, then, other } => {
                let zero = self.builder.number(0.0);
                let [then, other] = [then, other].map(|cell| self.of(cell).unwrap_or(zero));
                self.builder.add(Instruction::Choice { out: out + offset, less, then, other });
            }
            Instruction::SineCosine { sine, cosine, of } => {
                let change = of + offset;
                self.builder.set(sine + offset, None, false, &[[cosine, change]]);
                self.builder.set(cosine + offset, None, true, &[[sine, change]]);
            }
            Instruction::Function { out, function: Function::Exponential, of } => {
                self.builder.set(out + offset, None, false, &[[out, of + offset]]);
            }
            Instruction::Function { out, function, of } => {
                // (atan a)' = a' / (1 + a²), (log a)' = a' / a
                let one = self.builder.number(1.0);
                let by = match function {
                    Function::ArcTangent => self.builder.sum(Some(one), &[[of, of]]),
                    _ => of,
                };
                let of = of + offset;
                self.builder.add(Instruction::Quotient { out: out + offset, of, by });
            }
        }
    }
}
