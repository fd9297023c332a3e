//! Writes a program, instruction by instruction.

use std::collections::HashMap;
use std::sync::Arc;

use super::program::{Cell, Instruction, Program};

/// A program that is being written.
#[derive(Default)]
pub(crate) struct Builder {
    instructions: Vec<Instruction>,
    products: Vec<[Cell; 2]>,
    cells: usize,
    numbers: Vec<(Cell, f64)>,
    /// The cell of each number.
    known: HashMap<u64, Cell>,
}

impl Builder {
    /// Returns an empty program. Its first `cells` cells have meanings that the caller gives them.
    pub(crate) fn with_cells(cells: usize) -> Self {
        Builder { cells, ..Builder::default() }
    }

    /// Returns a new cell.
    pub(crate) fn cell(&mut self) -> Cell {
        self.cells += 1;
        (self.cells - 1) as Cell
    }

    /// Returns the cell of a number.
    pub(crate) fn number(&mut self, number: f64) -> Cell {
        if let Some(cell) = self.known.get(&number.to_bits()) {
            return *cell;
        }
        let cell = self.cell();
        self.define(cell, number);
        cell
    }

    /// Gives a cell of the caller this number, which the program does not change.
    pub(crate) fn define(&mut self, cell: Cell, number: f64) {
        self.known.entry(number.to_bits()).or_insert(cell);
        self.numbers.push((cell, number));
    }

    /// Adds an instruction.
    pub(crate) fn add(&mut self, instruction: Instruction) {
        self.instructions.push(instruction);
    }

    /// Writes a sum of products to a cell, or subtracts them from the start ([`Instruction::Sum`]).
    pub(crate) fn set(
        &mut self,
        out: Cell,
        start: Option<Cell>,
        subtracts: bool,
        products: &[[Cell; 2]],
    ) {
        let start = match start {
            None if subtracts || products.is_empty() => Some(self.number(0.0)),
            other => other,
        };
        let place = [self.products.len() as u32, products.len() as u32];
        self.products.extend_from_slice(products);
        self.add(Instruction::Sum { out, start, subtracts, products: place });
    }

    /// Returns a start plus products.
    pub(crate) fn sum(&mut self, start: Option<Cell>, products: &[[Cell; 2]]) -> Cell {
        let out = self.cell();
        self.set(out, start, false, products);
        out
    }

    /// Returns a start minus products.
    pub(crate) fn difference(&mut self, start: Option<Cell>, products: &[[Cell; 2]]) -> Cell {
        let out = self.cell();
        self.set(out, start, true, products);
        out
    }

    /// Returns a product.
    pub(crate) fn product(&mut self, a: Cell, b: Cell) -> Cell {
        self.sum(None, &[[a, b]])
    }

    /// Returns a quotient.
    pub(crate) fn quotient(&mut self, of: Cell, by: Cell) -> Cell {
        let out = self.cell();
        self.add(Instruction::Quotient { out, of, by });
        out
    }

    /// Returns `then` where `less[0] < less[1]`, and `other` elsewhere.
    pub(crate) fn choice(&mut self, less: [Cell; 2], then: Cell, other: Cell) -> Cell {
        let out = self.cell();
        self.add(Instruction::Choice { out, less, then, other });
        out
    }

    /// Returns the larger of two numbers.
    pub(crate) fn larger(&mut self, a: Cell, b: Cell) -> Cell {
        self.choice([a, b], b, a)
    }

    /// Returns the size of a number.
    pub(crate) fn size(&mut self, of: Cell) -> Cell {
        let one = self.number(1.0);
        let negative = self.difference(None, &[[one, of]]);
        self.larger(of, negative)
    }

    /// Returns the program, without instructions whose results nobody reads; `kept` are the cells that are read after its
    /// end.
    pub(crate) fn finish(self, kept: impl IntoIterator<Item = Cell>) -> Program {
        let Builder { instructions, products, cells, numbers, .. } = self;
        let mut kept_cells = vec![false; cells];
        kept.into_iter().for_each(|cell| kept_cells[cell as usize] = true);
        Program {
            instructions,
            products: Arc::new(products),
            cells,
            numbers: Arc::new(numbers),
            kept: kept_cells,
        }
        .without_unused()
    }
}
