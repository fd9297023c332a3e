//! Tables as rows of cells, numbers and texts: what a study takes, from CSV, Parquet and Arrow alike.

use arrow_array::{ArrayRef, RecordBatch, RecordBatchReader};
use arrow_schema::{ArrowError, DataType, Schema};

use super::error::{Fault, Refusal};
use super::values::{Kind, Values};
use crate::foreign::shorten;

/// The longest text of a cell, bytes; no parameter has a word as long.
const MAX_TEXT_BYTES: usize = 256;

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// A finite number.
    Number(f64),
    /// A number that is not finite, as it is written.
    NotFinite(String),
    /// Text.
    Text(String),
    /// Nothing.
    Empty,
}

impl Cell {
    /// A number.
    pub fn of_number(number: f64) -> Cell {
        match number.is_finite() {
            true => Cell::Number(number),
            false => Cell::NotFinite(number.to_string()),
        }
    }
}

/// A table with its rows in order, each with one cell per column.
pub(crate) struct Cells {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
    /// In a file of lines, the line of each row.
    pub lines: Option<Vec<usize>>,
}

/// A column of a wrong name, by its place, and what is wrong.
type WrongColumn = (usize, Fault);

/// Which tables are read.
pub(crate) struct Limits<'a> {
    /// Checks the names of the columns.
    pub columns: &'a dyn Fn(&[String]) -> Result<(), WrongColumn>,
    /// The most values.
    pub values: usize,
}

impl Limits<'_> {
    pub(super) fn check_columns(&self, columns: &[String]) -> Result<(), Refusal> {
        (self.columns)(columns).map_err(|(index, fault)| Refusal {
            column: columns.get(index).cloned(),
            ..fault.into()
        })
    }
}

impl Cells {
    /// Reads an Arrow table.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub fn of_arrow(reader: impl RecordBatchReader, limits: &Limits<'_>) -> Result<Cells, Refusal> {
        let mut cells = Self::of_schema(&reader.schema(), limits)?;
        for batch in reader {
            let not_read = |error: ArrowError| {
                Fault::new("not a table", shorten(&error.to_string()), "an Arrow table")
            };
            let batch = batch.map_err(not_read)?;
            let rows = cells.rows.len() + batch.num_rows();
            if rows.saturating_mul(cells.columns.len()) > limits.values {
                let found = format!("{rows} rows of {} values", cells.columns.len());
                return Err(too_many_values(found, limits).into());
            }
            cells.push(&batch)?;
        }
        Ok(cells)
    }

    /// A table of these rows.
    ///
    /// # Errors
    /// A column of a wrong name, a ragged row, too many values.
    pub fn of_rows(
        columns: Vec<String>,
        rows: Vec<Vec<Cell>>,
        limits: &Limits<'_>,
    ) -> Result<Cells, Refusal> {
        limits.check_columns(&columns)?;
        if rows.len().saturating_mul(columns.len()) > limits.values {
            let found = format!("{} rows of {} values", rows.len(), columns.len());
            return Err(too_many_values(found, limits).into());
        }
        match rows.iter().position(|row| row.len() != columns.len()) {
            Some(row) => {
                let fault = ragged(rows[row].len(), columns.len());
                Err(Refusal { row: Some(row), ..fault.into() })
            }
            None => Ok(Cells { columns, rows, lines: None }),
        }
    }

    /// A table without rows.
    ///
    /// # Errors
    /// A column of a wrong name, or neither of numbers nor of text.
    pub(super) fn of_schema(schema: &Schema, limits: &Limits<'_>) -> Result<Cells, Refusal> {
        let columns: Vec<String> =
            schema.fields().iter().map(|field| field.name().clone()).collect();
        limits.check_columns(&columns)?;
        for field in schema.fields() {
            let kind = Kind::of(field.data_type());
            if !matches!(kind, Some(Kind::Number | Kind::Count | Kind::Integer | Kind::Text)) {
                return Err(wrong_type(field.name(), field.data_type()));
            }
        }
        Ok(Cells { columns, rows: Vec::new(), lines: None })
    }

    /// Adds the rows of a batch.
    ///
    /// # Errors
    /// A text that is too long.
    pub(super) fn push(&mut self, batch: &RecordBatch) -> Result<(), Refusal> {
        let columns = self.columns.iter().zip(batch.columns());
        let mut columns = columns
            .map(|(name, column)| {
                Ok(cells(column).ok_or_else(|| wrong_type(name, column.data_type()))?.into_iter())
            })
            .collect::<Result<Vec<_>, Refusal>>()?;
        for _ in 0..batch.num_rows() {
            // Each column of a batch has as many values as the batch has rows.
            let row: Vec<Cell> = columns.iter_mut().filter_map(Iterator::next).collect();
            let length = |cell: &Cell| if let Cell::Text(text) = cell { text.len() } else { 0 };
            if let Some(column) = row.iter().position(|cell| length(cell) > MAX_TEXT_BYTES) {
                let found = row.get(column).map_or(0, length);
                let allowed = format!("at most {MAX_TEXT_BYTES} bytes");
                let fault = Fault::new("too long a text", format!("{found} bytes"), allowed);
                let column = self.columns.get(column).cloned();
                return Err(Refusal { row: Some(self.rows.len()), column, ..fault.into() });
            }
            self.rows.push(row);
        }
        Ok(())
    }
}

/// The values of a column; none where they are neither numbers nor text.
fn cells(column: &ArrayRef) -> Option<Vec<Cell>> {
    fn all<V>(values: Vec<Option<V>>, cell: impl Fn(V) -> Cell) -> Vec<Cell> {
        values.into_iter().map(|value| value.map_or(Cell::Empty, &cell)).collect()
    }
    Some(match Values::of(column)? {
        Values::Number(values) => all(values, Cell::of_number),
        Values::Count(values) => all(values, |count| Cell::Number(count as f64)),
        Values::Integer(values) => all(values, |integer| Cell::Number(integer as f64)),
        Values::Text(values) => {
            all(values, |text| if text.is_empty() { Cell::Empty } else { Cell::Text(text) })
        }
        Values::Truth(_) | Values::Numbers(_) => return None,
    })
}

fn wrong_type(column: &str, kind: &DataType) -> Refusal {
    let found = format!("a column of {kind}");
    let fault = Fault::new("wrong type", found, "a column of numbers or of text");
    Refusal { column: Some(column.to_owned()), ..fault.into() }
}

/// A table with more values than are allowed.
pub(super) fn too_many_values(found: String, limits: &Limits<'_>) -> Fault {
    let allowed = format!("at most {} in all tables of a study", limits.values);
    Fault::new("too many values", found, allowed)
}

/// A row with more or fewer values than there are columns.
pub(crate) fn ragged(found: usize, columns: usize) -> Fault {
    Fault::new("a ragged row", format!("{found} values"), format!("{columns}, one per column"))
}
