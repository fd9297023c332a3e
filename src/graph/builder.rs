//! Writes a program, instruction by instruction.

use std::collections::HashMap;
use std::sync::Arc;

use super::program::{Cell, Instruction, Product, Program};

/// A program that is being written.
#[derive(Default)]
pub(crate) struct Builder {
    instructions: Vec<Instruction>,
    products: Vec<Product>,
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
        self.combine(out, start, products.iter().map(|&factors| Product { factors, subtracts }));
    }

    /// Writes a start plus and minus products to a cell ([`Instruction::Sum`]). Without a start, the sum begins with a product
    /// by 1, if there is one.
    pub(crate) fn combine(
        &mut self,
        out: Cell,
        mut start: Option<Cell>,
        products: impl IntoIterator<Item = Product>,
    ) {
        let first = self.products.len();
        self.products.extend(products);
        let new = &mut self.products[first..];
        if start.is_none() {
            let one = self.known.get(&1_f64.to_bits());
            let by_one = |product: &Product| {
                let place = product.factors.iter().position(|factor| Some(factor) == one)?;
                (!product.subtracts).then_some(product.factors[1 - place])
            };
            if let Some((place, of)) =
                new.iter().enumerate().find_map(|(place, product)| Some((place, by_one(product)?)))
            {
                start = Some(of);
                self.products.remove(first + place);
            } else if let Some(place) = new.iter().position(|product| !product.subtracts) {
                new[..=place].rotate_right(1);
            } else {
                start = Some(self.number(0.0));
            }
        }
        let products = [first as u32, (self.products.len() - first) as u32];
        self.add(Instruction::Sum { out, start, products });
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

    /// Returns the smaller of two numbers.
    pub(crate) fn smaller(&mut self, a: Cell, b: Cell) -> Cell {
        self.choice([a, b], a, b)
    }

    /// Returns the larger of two numbers.
    pub(crate) fn larger(&mut self, a: Cell, b: Cell) -> Cell {
        self.choice([a, b], b, a)
    }

    /// Returns the size of a number.
    pub(crate) fn size(&mut self, of: Cell) -> Cell {
        let out = self.cell();
        self.add(Instruction::Size { out, of });
        out
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
