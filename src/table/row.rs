//! The rows of a table as a reader sees them: it asks for values by the names of their columns, and only these columns are
//! read.

use std::cell::{Cell, RefCell};

use serde_json::Value;

use crate::classification::Label;
use crate::tabular::{ColumnValues, Kind};

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
    /// Returns a row.
    pub fn row(&self, row: usize) -> Row<'_> {
        Row(RowSource::Read(self, row, Cell::new(0)))
    }
}

/// A row of a table. Each method returns the value in a column, `None` if it is missing.
///
/// A reader is first called without a row, when all values are missing, to learn the columns. It must ask for the same
/// columns whatever the values are.
pub struct Row<'a>(RowSource<'a>);

enum RowSource<'a> {
    /// The columns that a reader of a table with these columns asks for.
    Asked(&'a [(String, Option<Kind>)], &'a RefCell<Vec<(String, Kind)>>),
    /// A row of a batch, and the number of values that the reader has asked for in it.
    Read(&'a Batch, usize, Cell<usize>),
}

/// Returns the kind of a column; `None` if there is no such column.
fn kind(columns: &[(String, Option<Kind>)], column: &str) -> Option<Kind> {
    columns.iter().find(|(name, _)| name == column)?.1
}

macro_rules! value {
    ($name:ident, $kind:ident, $value:ty, $of:literal) => {
        #[doc = concat!("Returns ", $of, ".")]
        pub fn $name(&self, column: &str) -> Option<$value> {
            match self.values(column, Kind::$kind)? {
                (ColumnValues::$kind(values), row) => values.get(row).cloned().flatten(),
                _ => None,
            }
        }
    };
}

impl<'a> Row<'a> {
    value!(number, Number, f64, "a number");
    value!(count, Count, u64, "a whole number from 0");
    value!(truth, Boolean, bool, "a Boolean value");
    value!(text, Text, String, "a text");

    /// Returns a row without values, which notes in `asked` what a reader of a table with these `columns` asks for.
    pub(super) fn asked(
        columns: &'a [(String, Option<Kind>)],
        asked: &'a RefCell<Vec<(String, Kind)>>,
    ) -> Self {
        Row(RowSource::Asked(columns, asked))
    }

    /// Returns the number of the row in the table, from 0.
    pub fn place(&self) -> u64 {
        match &self.0 {
            RowSource::Asked(..) => 0,
            RowSource::Read(batch, row, _) => batch.first_row + *row as u64,
        }
    }

    /// Returns whether the table has a column.
    pub fn has(&self, column: &str) -> bool {
        match &self.0 {
            RowSource::Asked(columns, _) => kind(columns, column).is_some(),
            RowSource::Read(batch, ..) => batch.columns.iter().any(|(name, _)| name == column),
        }
    }

    /// Returns a number, or `None` if the table has no such column.
    pub fn number_if_there(&self, column: &str) -> Option<f64> {
        if self.has(column) { self.number(column) } else { None }
    }

    /// Returns the label in the column `label`.
    pub fn label(&self) -> Option<Label> {
        let name = self.text("label")?;
        Label::ALL.into_iter().find(|label| label.name() == name)
    }

    /// Returns the value in a column of any kind as JSON: null if it is missing, or if the table has no such column.
    pub fn json(&self, column: &str) -> Value {
        let kind = match &self.0 {
            RowSource::Asked(columns, _) => kind(columns, column),
            RowSource::Read(..) => Some(Kind::Number),
        };
        let found = kind.and_then(|kind| self.values(column, kind));
        found.map_or(Value::Null, |(values, row)| values.json(row))
    }

    /// Returns the values of a column and the place of this row in them.
    fn values(&self, column: &str, kind: Kind) -> Option<(&'a ColumnValues, usize)> {
        match &self.0 {
            RowSource::Asked(_, asked) => {
                let mut asked = asked.borrow_mut();
                if asked.iter().all(|(name, _)| name != column) {
                    asked.push((column.to_owned(), kind));
                }
                None
            }
            RowSource::Read(batch, row, next) => {
                // Readers ask for the columns in the order of the batch.
                let place = next.replace(next.get() + 1);
                let has_name = |(name, _): &&(String, ColumnValues)| name == column;
                let found = batch.columns.get(place).filter(has_name);
                let found = found.or_else(|| batch.columns.iter().find(has_name));
                found.map(|(_, values)| (values, *row))
            }
        }
    }
}
