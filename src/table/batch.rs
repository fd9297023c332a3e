//! A batch of rows of a table.

use arrow_schema::ArrowError;

use super::column::{Column, batch};
use crate::tabular::ColumnValues;

/// A batch of consecutive rows of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// The number of the first row, counted from 0.
    pub first_row: u64,
    /// The number of rows.
    pub rows: usize,
    /// The requested columns, in the order of the request.
    pub columns: Vec<(String, ColumnValues)>,
}

impl Batch {
    /// Returns rows that are not written yet as they will be read.
    pub fn of<R>(columns: &[Column<R>], rows: &[R]) -> Result<Self, ArrowError> {
        let written = batch(columns, rows)?;
        let names = columns.iter().map(|column| column.name().to_owned());
        let values = names.zip(written.columns());
        let columns = values.filter_map(|(name, values)| Some((name, ColumnValues::of(values)?)));
        Ok(Batch { first_row: 0, rows: rows.len(), columns: columns.collect() })
    }
}
