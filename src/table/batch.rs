//! A batch of rows of a table, as columns of values with known types.

use std::path::PathBuf;

use arrow_schema::ArrowError;

use super::column::{Column, batch};
use super::table_error::TableError;
use crate::tabular::{Fault, Kind, Values};

/// A batch of consecutive rows of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    pub(super) file: PathBuf,
    /// The number of the first row, counted from 0.
    pub first_row: u64,
    /// The number of rows.
    pub rows: usize,
    /// The requested columns, in the order of the request.
    pub columns: Vec<(String, Values)>,
}

macro_rules! typed {
    ($name:ident, $kind:ident, $value:ty, $of:literal) => {
        #[doc = concat!("Returns a column of ", $of, ".")]
        ///
        /// # Errors
        /// Returns an error if the column was not requested or has another type.
        pub fn $name(&self, column: &str) -> Result<&[Option<$value>], TableError> {
            match self.column(column)? {
                Values::$kind(values) => Ok(values),
                other => Err(self.wrong(column, other.kind().name(), Kind::$kind)),
            }
        }
    };
}

impl Batch {
    /// Returns rows that are not written yet as they will be read.
    ///
    /// # Errors
    /// Returns an error if values do not fit their column, which is a bug.
    pub fn of<R>(columns: &[Column<R>], rows: &[R]) -> Result<Self, ArrowError> {
        let written = batch(columns, rows)?;
        let names = columns.iter().map(|column| column.name().to_owned());
        let values = names.zip(written.columns());
        let columns = values.filter_map(|(name, values)| Some((name, Values::of(values)?)));
        let (file, rows) = (PathBuf::new(), rows.len());
        Ok(Batch { file, first_row: 0, rows, columns: columns.collect() })
    }

    typed!(numbers, Number, f64, "numbers");
    typed!(counts, Count, u64, "whole numbers from 0");
    typed!(integers, Integer, i64, "signed whole numbers");
    typed!(truths, Boolean, bool, "Boolean values");
    typed!(texts, Text, String, "text");
    typed!(lists, Numbers, Vec<f64>, "lists of numbers");

    fn column(&self, name: &str) -> Result<&Values, TableError> {
        let found = self.columns.iter().find(|(column, _)| column == name);
        found.map(|(_, values)| values).ok_or_else(|| {
            let names: Vec<&str> = self.columns.iter().map(|(name, _)| name.as_str()).collect();
            let fault =
                Fault::new("the column was not read", names.join(", "), "a column that was read");
            TableError::new(&self.file, Some(name), fault)
        })
    }

    fn wrong(&self, column: &str, found: &str, allowed: Kind) -> TableError {
        let fault = Fault::new("wrong type", format!("a column of {found}"), allowed.name());
        TableError::new(&self.file, Some(column), fault)
    }
}
