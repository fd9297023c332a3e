//! The tables that studies read from CSV, Parquet or Arrow, as rows of numbers and texts.

use arrow_array::{ArrayRef, RecordBatch, RecordBatchReader};
use arrow_schema::{ArrowError, DataType, Schema};

use super::error::{Fault, Refusal};
use super::values::{ColumnValues, Kind};
use crate::sanitize::shorten;

/// The longest text of a cell, bytes: more than any word in a study needs.
const MAX_TEXT_BYTES: usize = 256;

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// A finite number.
    Number(f64),
    /// An infinity or NaN, as it is written in the table.
    NotFinite(String),
    /// A text.
    Text(String),
    /// A missing value.
    Empty,
}

impl Cell {
    /// Returns the cell with a number, which may be infinite or NaN.
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
    /// The line number of each row if the table comes from a text file.
    pub lines: Option<Vec<usize>>,
}

/// The index of a column with an invalid name, and the fault.
type WrongColumn = (usize, Fault);

/// The limits that a table must meet to be read.
pub(crate) struct Limits<'a> {
    /// Checks the names of the columns.
    pub columns: &'a dyn Fn(&[String]) -> Result<(), WrongColumn>,
    /// The largest number of values.
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

    /// Creates a table from its columns and rows.
    ///
    /// # Errors
    /// Returns an error if a column has an invalid name, if a row has more or fewer values than there are columns, or
    /// if there are too many values.
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

    /// Creates a table without rows.
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

    /// Appends the rows of a batch.
    pub(super) fn push(&mut self, batch: &RecordBatch) -> Result<(), Refusal> {
        let columns = self.columns.iter().zip(batch.columns());
        let mut columns = columns
            .map(|(name, column)| {
                Ok(cells(column).ok_or_else(|| wrong_type(name, column.data_type()))?.into_iter())
            })
            .collect::<Result<Vec<_>, Refusal>>()?;
        for _ in 0..batch.num_rows() {
            // Every column of a batch has one value per row.
            let row: Vec<Cell> = columns.iter_mut().filter_map(Iterator::next).collect();
            let length = |cell: &Cell| if let Cell::Text(text) = cell { text.len() } else { 0 };
            if let Some(column) = row.iter().position(|cell| length(cell) > MAX_TEXT_BYTES) {
                let found = row.get(column).map_or(0, length);
                let allowed = format!("at most {MAX_TEXT_BYTES} bytes");
                let fault = Fault::new("the text is too long", format!("{found} bytes"), allowed);
                let column = self.columns.get(column).cloned();
                return Err(Refusal { row: Some(self.rows.len()), column, ..fault.into() });
            }
            self.rows.push(row);
        }
        Ok(())
    }
}

/// Returns the values of a column, or `None` if they are neither numbers nor text.
fn cells(column: &ArrayRef) -> Option<Vec<Cell>> {
    fn all<V>(values: Vec<Option<V>>, cell: impl Fn(V) -> Cell) -> Vec<Cell> {
        values.into_iter().map(|value| value.map_or(Cell::Empty, &cell)).collect()
    }
    Some(match ColumnValues::of(column)? {
        ColumnValues::Number(values) => all(values, Cell::of_number),
        ColumnValues::Count(values) => all(values, |count| Cell::Number(count as f64)),
        ColumnValues::Integer(values) => all(values, |integer| Cell::Number(integer as f64)),
        ColumnValues::Text(values) => {
            all(values, |text| if text.is_empty() { Cell::Empty } else { Cell::Text(text) })
        }
        ColumnValues::Boolean(_) | ColumnValues::Numbers(_) => return None,
    })
}

fn wrong_type(column: &str, kind: &DataType) -> Refusal {
    let found = format!("a column of {kind}");
    let fault = Fault::new("wrong type", found, "a column of numbers or text");
    Refusal { column: Some(column.to_owned()), ..fault.into() }
}

/// Returns the fault of a table with too many values.
pub(super) fn too_many_values(found: String, limits: &Limits<'_>) -> Fault {
    let allowed = format!("at most {} in all tables of a study", limits.values);
    Fault::new("too many values", found, allowed)
}

/// Returns the fault of a row with more or fewer values than there are columns.
pub(crate) fn ragged(found: usize, columns: usize) -> Fault {
    Fault::new(
        "wrong number of values in a row",
        format!("{found} values"),
        format!("{columns}, one per column"),
    )
}
