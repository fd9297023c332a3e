//! Numbers the values of a part of a program, and interleaves sums that do not depend on each other.

use std::collections::HashMap;

use crate::graph::{Cell, Instruction, Product, Program};
use crate::motion::lockstep::vector::Width;

/// The number of a value.
pub(super) type Id = u32;

/// An operation of one machine instruction, or of two.
#[derive(Clone, Copy, Debug)]
pub(super) enum MachineOperation {
    /// `a b`
    Product([Id; 2]),
    /// `c + a b`, or `c - a b`
    Fused { factors: [Id; 2], sum: Id, subtracts: bool },
    /// `a / b`
    Quotient([Id; 2]),
    /// `sqrt a`
    SquareRoot(Id),
    /// `|a|`
    Size(Id),
    /// The third where the first is less than the second, else the fourth.
    Choice([Id; 4]),
    /// The first where it is less than the second, else the second.
    Smaller([Id; 2]),
    /// The first where it is greater than the second, else the second.
    Larger([Id; 2]),
    /// A copy of a value for another cell.
    Copy(Id),
}

impl MachineOperation {
    /// Returns the values that the operation reads.
    pub(super) fn reads(&self) -> impl Iterator<Item = Id> + use<> {
        let all: [Option<Id>; 4] = match *self {
            MachineOperation::Product([a, b])
            | MachineOperation::Quotient([a, b])
            | MachineOperation::Smaller([a, b])
            | MachineOperation::Larger([a, b]) => [Some(a), Some(b), None, None],
            MachineOperation::Fused { factors: [a, b], sum, .. } => {
                [Some(a), Some(b), Some(sum), None]
            }
            MachineOperation::SquareRoot(a)
            | MachineOperation::Size(a)
            | MachineOperation::Copy(a) => [Some(a), None, None, None],
            MachineOperation::Choice(all) => all.map(Some),
        };
        all.into_iter().flatten()
    }
}

/// An operation with its result.
pub(super) struct Line {
    pub(super) operation: MachineOperation,
    pub(super) result: Id,
    /// Whether the result is stored in its cell.
    pub(super) stores: bool,
}

/// A number that a line reads or computes, and where it is.
#[derive(Default)]
pub(super) struct Value {
    /// The cell in which it is stored, if it is stored. Partial sums use the cell of the sum.
    pub(super) cell: Cell,
    /// Whether the cell contains it: at the start, if it is an input.
    pub(super) is_in_memory: bool,
    /// Whether its cell is stored in the end; before, the cell is its own.
    pub(super) is_stored: bool,
    /// Whether it waits in a free cell.
    pub(super) is_waiting: bool,
    pub(super) register: Option<usize>,
    /// The lines that read it, and how many of them are past.
    pub(super) reads: Vec<u32>,
    pub(super) past: usize,
}

impl Value {
    pub(super) fn next_read(&self) -> Option<u32> {
        self.reads.get(self.past).copied()
    }

    /// Whether no line after this one reads it.
    pub(super) fn ends_at(&self, line: u32) -> bool {
        self.reads.last().is_none_or(|last| *last <= line)
    }
}

/// The lines of a part of a program.
#[derive(Default)]
pub(super) struct Lowered {
    pub(super) lines: Vec<Line>,
    pub(super) values: Vec<Value>,
}

/// Sums that are computed together.
fn together(width: Width) -> usize {
    match width {
        Width::Eight => 16,
        Width::Four | Width::One => 6,
    }
}

/// Returns the lines of instructions without elementary functions; `stored` tells the cells that are read later.
pub(super) fn lower(
    program: &Program,
    instructions: &[Instruction],
    stored: impl Fn(Cell) -> bool,
    width: Width,
) -> Lowered {
    let values = vec![None; program.cells];
    let sizes = HashMap::new();
    let mut lowering = Lowering { lowered: Lowered::default(), value_of: values, sizes, stored };
    let mut rest = instructions;
    while let Some(first) = rest.first() {
        let group = independent_sums(program, rest, together(width));
        if group.is_empty() {
            lowering.single(first);
            rest = &rest[1..];
        } else {
            lowering.sums(program, group);
            rest = &rest[group.len()..];
        }
    }
    lowering.lowered
}

/// Returns the sums with which `instructions` begin, up to the first sum that reads the result of an earlier one.
fn independent_sums<'i>(
    program: &Program,
    instructions: &'i [Instruction],
    most: usize,
) -> &'i [Instruction] {
    let mut written = Vec::new();
    for instruction in instructions.iter().take(most) {
        let Instruction::Sum { out, .. } = *instruction else { break };
        if program.reads(instruction).any(|cell| written.contains(&cell)) {
            break;
        }
        written.push(out);
    }
    &instructions[..written.len()]
}

/// A sum that is being computed.
struct Partial<'p> {
    out: Cell,
    products: &'p [Product],
    sum: Option<Id>,
}

struct Lowering<F> {
    lowered: Lowered,
    /// The value in each cell.
    value_of: Vec<Option<Id>>,
    /// Cells with the size of another cell, which is computed where it is first read, so that it does not occupy a register.
    sizes: HashMap<Cell, Cell>,
    stored: F,
}

impl<F: Fn(Cell) -> bool> Lowering<F> {
    fn value(&mut self, cell: Cell, is_in_memory: bool) -> Id {
        self.lowered.values.push(Value { cell, is_in_memory, ..Value::default() });
        (self.lowered.values.len() - 1) as Id
    }

    /// Returns the value in a cell.
    fn at(&mut self, cell: Cell) -> Id {
        match self.value_of[cell as usize] {
            Some(id) => id,
            None => {
                if let Some(of) = self.sizes.remove(&cell) {
                    let of = self.at(of);
                    return self.line(MachineOperation::Size(of), cell, true);
                }
                let id = self.value(cell, true);
                self.value_of[cell as usize] = Some(id);
                id
            }
        }
    }

    /// Adds a line that computes a value of a cell, or if not `last`, a part of it.
    fn line(&mut self, operation: MachineOperation, cell: Cell, last: bool) -> Id {
        let line = self.lowered.lines.len() as u32;
        for id in operation.reads() {
            self.lowered.values[id as usize].reads.push(line);
        }
        let result = self.value(cell, false);
        let stores = last && (self.stored)(cell);
        self.lowered.lines.push(Line { operation, result, stores });
        if last {
            self.value_of[cell as usize] = Some(result);
        }
        result
    }

    fn single(&mut self, instruction: &Instruction) {
        let (out, operation) = match *instruction {
            Instruction::Quotient { out, of, by } => {
                (out, MachineOperation::Quotient([of, by].map(|cell| self.at(cell))))
            }
            Instruction::Size { out, of } if !(self.stored)(out) => {
                self.sizes.insert(out, of);
                return;
            }
            Instruction::Size { out, of } => (out, MachineOperation::Size(self.at(of))),
            Instruction::SquareRoot { out, of } => (out, MachineOperation::SquareRoot(self.at(of))),
            Instruction::Choice { out, less: [a, b], then, other } => {
                let of = [a, b, then, other].map(|cell| self.at(cell));
                let operation = if [then, other] == [a, b] {
                    MachineOperation::Smaller([of[0], of[1]])
                } else if [then, other] == [b, a] {
                    MachineOperation::Larger([of[1], of[0]])
                } else {
                    MachineOperation::Choice(of)
                };
                (out, operation)
            }
            // Sums are lowered together; the host computes functions.
            Instruction::Sum { .. }
            | Instruction::SineCosine { .. }
            | Instruction::Function { .. } => return,
        };
        self.line(operation, out, true);
    }

    /// Adds the lines of sums, product by product, so that all end at the same time: what was computed last comes last.
    fn sums(&mut self, program: &Program, group: &[Instruction]) {
        let mut sums = Vec::with_capacity(group.len());
        for instruction in group {
            if let Instruction::Sum { out, start, products } = *instruction {
                let (products, sum) = (program.products(products), start.map(|cell| self.at(cell)));
                sums.push(Partial { out, products, sum });
            }
        }
        let longest = sums.iter().map(|sum| sum.products.len()).max().unwrap_or(0);
        for left in (0..longest).rev() {
            for Partial { out, products, sum } in &mut sums {
                let Some(place) = products.len().checked_sub(left + 1) else { continue };
                let Product { factors, subtracts } = products[place];
                let factors = factors.map(|cell| self.at(cell));
                let operation = match *sum {
                    None => MachineOperation::Product(factors),
                    Some(sum) => MachineOperation::Fused { factors, sum, subtracts },
                };
                *sum = Some(self.line(operation, *out, left == 0));
            }
        }
        for Partial { out, products, sum, .. } in sums {
            if let (Some(sum), true) = (sum, products.is_empty()) {
                self.line(MachineOperation::Copy(sum), out, true);
            }
        }
    }
}
