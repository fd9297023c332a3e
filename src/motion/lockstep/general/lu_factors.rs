//! The solution of a linear system as instructions: factors once, then any number of right-hand sides.

use crate::graph::{Builder, Cell, Product};
use crate::motion::linear_system::{DEPENDENT_PIVOT, LEAST_SCALE, SMALL_PIVOT};

/// The factors `L U` of a matrix, whose rows with small pivots are exchanged ([`SMALL_PIVOT`]). Entries that are always zero
/// are left out.
pub(super) struct LuFactors {
    /// The unknowns in the order of their elimination; equations have the same order.
    order: Vec<usize>,
    /// The factors, row by row, in this order. Behind the rows follow those that remain where an unknown is not determined.
    entries: Vec<Option<Cell>>,
    /// One over each pivot; `None` for the pivot 1.
    inverses: Vec<Option<Cell>>,
    /// Two rows that are exchanged where the first number is less than the second, in the order of the exchanges.
    exchanges: Vec<([usize; 2], [Cell; 2])>,
    /// The number of first unknowns that the equations determine.
    determined: usize,
    /// For each unknown behind them: it is not determined where the first number is less than the second.
    undetermined: Vec<[Cell; 2]>,
    /// The inverse of the last two rows and columns, row by row, if exactly two unknowns are not eliminated first.
    last: Option<[Option<Cell>; 4]>,
}

/// Returns which unknowns are eliminated first, without exchanges: those of `units`, the diagonal entries that are 1, as long
/// as these are not changed. Of several, the one that changes the fewest entries comes first (H. M. Markowitz, Management
/// Science 3 (1957) 255, doi:10.1287/mnsc.3.3.255).
fn first_unknowns(is_entry: &[bool], units: &[bool]) -> Vec<usize> {
    let size = units.len();
    let (mut is_entry, mut units) = (is_entry.to_vec(), units.to_vec());
    let mut left: Vec<usize> = (0..size).collect();
    let mut order = Vec::new();
    loop {
        let others = |of: usize, by_row: bool| {
            let is_other = |other: &&usize| {
                let place = if by_row { of * size + **other } else { **other * size + of };
                **other != of && is_entry[place]
            };
            left.iter().filter(is_other).copied().collect::<Vec<_>>()
        };
        let fill = |of: &&usize| others(**of, true).len() * others(**of, false).len();
        let Some(&pivot) = left.iter().filter(|of| units[**of]).min_by_key(fill) else {
            break;
        };
        let [rows, columns] = [false, true].map(|by_row| others(pivot, by_row));
        for &row in &rows {
            for &column in &columns {
                is_entry[row * size + column] = true;
                units[row] &= row != column;
            }
        }
        order.push(pivot);
        left.retain(|of| *of != pivot);
    }
    order
}

impl LuFactors {
    /// Factors a matrix with these entries, row by row. The unknowns of `units` may be eliminated first; their diagonal
    /// entries are 1. The equations determine the first `determined` unknowns; of the others, those are 0 whose pivots are negligible.
    pub(super) fn new(
        builder: &mut Builder,
        entries: &[Option<Cell>],
        (units, determined): (&[bool], usize),
    ) -> Self {
        let size = units.len();
        let is_entry: Vec<bool> = entries.iter().map(Option::is_some).collect();
        let mut order = first_unknowns(&is_entry, units);
        let certain = order.len();
        let rest: Vec<usize> = (0..size).filter(|of| !order.contains(of)).collect();
        order.extend(rest);
        let in_order = order.iter().flat_map(|row| order.iter().map(move |column| (row, column)));
        let entries = in_order.map(|(row, column)| entries[row * size + column]).collect();
        let mut all = LuFactors {
            order,
            entries,
            inverses: Vec::new(),
            exchanges: Vec::new(),
            determined,
            undetermined: Vec::new(),
            last: None,
        };
        for column in 0..certain {
            all.inverses.push(None);
            all.eliminate(builder, column);
        }
        if certain + 2 == size && determined == size {
            all.invert_last(builder);
        } else {
            all.eliminate_rest(builder, certain);
        }
        all
    }

    /// Subtracts a row from those below.
    fn eliminate(&mut self, builder: &mut Builder, column: usize) {
        let size = self.order.len();
        for row in self.later_rows(column) {
            let Some(entry) = self.entries[row * size + column] else { continue };
            let inverse = self.inverses[column];
            let factor = inverse.map_or(entry, |inverse| builder.product(entry, inverse));
            self.entries[row * size + column] = Some(factor);
            for j in column + 1..size {
                if let Some(above) = self.entries[column * size + j] {
                    let entry = self.entries[row * size + j];
                    let entry = builder.difference(entry, &[[factor, above]]);
                    self.entries[row * size + j] = Some(entry);
                }
            }
        }
    }

    /// Inverts the last two rows and columns (Cramer's rule, whose error is as small as that of an elimination with exchanges:
    /// N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed., SIAM 2002, section 1.10).
    fn invert_last(&mut self, builder: &mut Builder) {
        let size = self.order.len();
        let at =
            |row: usize, column: usize| self.entries[(size - 2 + row) * size + size - 2 + column];
        let [a, b, c, d] = [at(0, 0), at(0, 1), at(1, 0), at(1, 1)];
        let diagonal = a.zip(d).map(|(a, d)| Product::plus([a, d]));
        let other = b.zip(c).map(|(b, c)| Product::minus([b, c]));
        let determinant = builder.cell();
        builder.combine(determinant, None, diagonal.into_iter().chain(other));
        let one = builder.number(1.0);
        let inverse = builder.quotient(one, determinant);
        let minus = builder.difference(None, &[[one, inverse]]);
        let scaled = [(d, inverse), (b, minus), (c, minus), (a, inverse)];
        self.last = Some(scaled.map(|(entry, by)| entry.map(|entry| builder.product(entry, by))));
    }

    /// Eliminates the unknowns from `first` on, with exchanges.
    fn eliminate_rest(&mut self, builder: &mut Builder, first: usize) {
        let size = self.order.len();
        let [zero, one, small] = [0.0, 1.0, SMALL_PIVOT].map(|number| builder.number(number));
        let mut scales = vec![zero; size];
        for (row, scale) in scales.iter_mut().enumerate().skip(first) {
            for entry in self.entries[row * size + first..(row + 1) * size].iter().flatten() {
                let of = builder.size(*entry);
                *scale = if *scale == zero { of } else { builder.larger(*scale, of) };
            }
        }
        if self.determined < size {
            // A row of zeros must not be compared with others by 0.
            let least = builder.number(LEAST_SCALE);
            for scale in scales.iter_mut().skip(first) {
                *scale = builder.larger(*scale, least);
            }
        }
        for column in first..size {
            for row in self.later_rows(column) {
                let Some(other) = self.entries[row * size + column] else { continue };
                let pivot = self.entries[column * size + column].unwrap_or(zero);
                let [pivot, other] = [pivot, other].map(|cell| builder.size(cell));
                let least = builder.product(small, other);
                let less =
                    [builder.product(pivot, scales[row]), builder.product(least, scales[column])];
                self.exchanges.push(([column, row], less));
                // The factors of earlier columns keep their places: right-hand sides are exchanged in between.
                for j in column..size {
                    let places = [column, row].map(|row| row * size + j);
                    exchange(builder, &mut self.entries, places, less);
                }
                let [above, below] = [scales[column], scales[row]];
                scales[column] = builder.choice(less, below, above);
                scales[row] = builder.choice(less, above, below);
            }
            let pivot = self.entries[column * size + column].unwrap_or(zero);
            let mut inverse = builder.quotient(one, pivot);
            if column >= self.determined {
                let negligible = builder.number(DEPENDENT_PIVOT);
                let less = [builder.size(pivot), builder.product(negligible, scales[column])];
                inverse = builder.choice(less, zero, inverse);
                self.undetermined.push(less);
            }
            self.inverses.push(Some(inverse));
            self.eliminate(builder, column);
            if let Some(less) = self.undetermined.last().filter(|_| column >= self.determined) {
                // Where the unknown is not determined, its row remains for later unknowns.
                let remaining = (0..size).map(|j| {
                    let entry = self.entries[column * size + j].filter(|_| j > column)?;
                    Some(builder.choice(*less, entry, zero))
                });
                let remaining: Vec<_> = remaining.collect();
                self.entries.extend(remaining);
                scales.push(scales[column]);
            }
        }
    }

    /// Returns the rows that remain after that of an unknown.
    fn later_rows(&self, column: usize) -> impl Iterator<Item = usize> + use<> {
        let size = self.order.len();
        let left_over = column.saturating_sub(self.determined);
        (column + 1..size).chain(size..size + left_over)
    }

    /// Writes the unknowns for a right-hand side to `out`. Returns which may differ from zero; the others are not written.
    pub(super) fn substitute(
        &self,
        builder: &mut Builder,
        right: &[Option<Cell>],
        out: &[Cell],
    ) -> Vec<bool> {
        let size = self.order.len();
        let mut values: Vec<Option<Cell>> = self.order.iter().map(|of| right[*of]).collect();
        let mut exchanges = self.exchanges.iter();
        let eliminated = if self.last.is_some() { size - 2 } else { size };
        for column in 0..eliminated {
            for (rows, less) in exchanges.as_slice().iter().take_while(|pair| pair.0[0] == column) {
                exchange(builder, &mut values, *rows, *less);
                exchanges.next();
            }
            for row in self.later_rows(column) {
                let factor = self.entries[row * size + column];
                if let Some((factor, value)) = factor.zip(values[column]) {
                    values[row] = Some(builder.difference(values[row], &[[factor, value]]));
                }
            }
            if column >= self.determined {
                let less = self.undetermined[column - self.determined];
                let zero = builder.number(0.0);
                values.push(values[column].map(|value| builder.choice(less, value, zero)));
            }
        }
        let mut not_zero = vec![false; size];
        if let Some(inverse) = &self.last {
            let right = [values[size - 2], values[size - 1]];
            for (row, entries) in (size - 2..).zip(inverse.chunks(2)) {
                let products = entries.iter().zip(right).filter_map(|(a, b)| Some([(*a)?, b?]));
                let products: Vec<_> = products.collect();
                not_zero[self.order[row]] = !products.is_empty();
                values[row] = (!products.is_empty()).then(|| {
                    builder.set(out[self.order[row]], None, false, &products);
                    out[self.order[row]]
                });
            }
        }
        for row in (0..eliminated).rev() {
            let later = self.entries[row * size..][..size].iter().zip(&values).skip(row + 1);
            let product =
                |(entry, value): (&Option<Cell>, &Option<Cell>)| Some([(*entry)?, (*value)?]);
            let products: Vec<[Cell; 2]> = later.filter_map(product).collect();
            if values[row].is_none() && products.is_empty() {
                continue;
            }
            let out = out[self.order[row]];
            match self.inverses[row] {
                None => builder.set(out, values[row], true, &products),
                Some(inverse) => {
                    let value = match values[row] {
                        Some(value) if products.is_empty() => value,
                        value => builder.difference(value, &products),
                    };
                    builder.set(out, None, false, &[[value, inverse]]);
                }
            }
            values[row] = Some(out);
            not_zero[self.order[row]] = true;
        }
        not_zero
    }
}

/// Exchanges two cells where the first number is less than the second.
fn exchange(
    builder: &mut Builder,
    cells: &mut [Option<Cell>],
    places: [usize; 2],
    less: [Cell; 2],
) {
    let pair = places.map(|place| cells[place]);
    if pair == [None; 2] {
        return;
    }
    let zero = builder.number(0.0);
    let [first, second] = pair.map(|cell| cell.unwrap_or(zero));
    cells[places[0]] = Some(builder.choice(less, second, first));
    cells[places[1]] = Some(builder.choice(less, first, second));
}
