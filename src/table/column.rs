//! A column of a table: its name, unit and meaning, how its value is computed from a row, and its text.
//!
//! A table is a list of columns; its schema and its record batches are derived from the same list.

use std::collections::HashSet;
use std::sync::Arc;

use arrow_array::builder::{Float64Builder, ListBuilder, StringDictionaryBuilder};
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int32Type, UInt8Type, UInt64Type};
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int32Array, RecordBatch, StringArray, UInt8Array,
    UInt64Array,
};
use arrow_schema::{ArrowError, DataType, Field, Schema};

use super::row::{Batch, Row};
use crate::tabular::ColumnValues;

type Build<R> = Box<dyn Fn(&[R]) -> ArrayRef + Send + Sync>;
type Read<R> = Box<dyn Fn(&mut R, &Row<'_>, &str) + Send + Sync>;

/// One column of a table of rows `R`.
pub struct Column<R> {
    field: Field,
    build: Build<R>,
    read: Option<Read<R>>,
}

/// Unit of non-dimensional values: lengths over the ring radius, and time multiplied by the natural
/// frequency.
pub const NON_DIMENSIONAL: &str = "1 (non-dimensional)";

impl<R> Column<R> {
    /// Returns the name.
    pub fn name(&self) -> &str {
        self.field.name()
    }

    /// Says how the value in a row of a table, with the name of the column, gets back into a row `R`.
    pub(super) fn reads(
        &mut self,
        read: impl Fn(&mut R, &Row<'_>, &str) + Send + Sync + 'static,
    ) -> &mut Self {
        self.read = Some(Box::new(read));
        self
    }

    /// Describes the values; the text may be empty.
    pub fn meaning(&mut self, meaning: impl Into<String>) {
        self.describe("meaning", meaning.into());
    }

    fn describe(&mut self, key: &str, text: String) {
        if !text.is_empty() {
            self.field.metadata_mut().insert(key.to_owned(), text);
        }
    }
}

fn optional<V>(value: impl Into<Option<V>>) -> Option<V> {
    value.into()
}

/// A list of columns that is being made.
///
/// Each method adds a column with the value that it has in a row, and returns the column for its
/// description. A value is optional, for example a number `f64` or `Option<f64>`.
///
/// ```
/// use stickslip::table::column::Columns;
///
/// let mut list = Columns::<f64>::new();
/// list.number("time_s", "s", |row| *row).meaning("simulated time");
/// assert_eq!(list.finish()[0].name(), "time_s");
/// ```
pub struct Columns<R> {
    list: Vec<Column<R>>,
}

impl<R> Default for Columns<R> {
    fn default() -> Self {
        Self::new()
    }
}

macro_rules! typed {
    ($name:ident, $value:ty, $kind:ident, $array:ty, $of:literal) => {
        #[doc = concat!("Adds a column of ", $of, ".")]
        pub fn $name<V: Into<Option<$value>>>(
            &mut self,
            name: impl Into<String>,
            value: impl Fn(&R) -> V + Send + Sync + 'static,
        ) -> &mut Column<R> {
            self.add(name, DataType::$kind, move |rows| {
                let values = rows.iter().map(|row| optional::<$value>(value(row)));
                Arc::new(values.collect::<$array>())
            })
        }
    };
}

impl<R> Columns<R> {
    /// Creates an empty list.
    pub fn new() -> Self {
        Columns { list: Vec::new() }
    }

    /// Returns the columns in order.
    pub fn finish(self) -> Vec<Column<R>> {
        self.list
    }

    /// Returns whether there is a column of this name.
    pub fn contains(&self, name: &str) -> bool {
        self.list.iter().any(|column| column.name() == name)
    }

    fn add(
        &mut self,
        name: impl Into<String>,
        kind: DataType,
        build: impl Fn(&[R]) -> ArrayRef + Send + Sync + 'static,
    ) -> &mut Column<R> {
        let field = Field::new(name, kind, true);
        self.list.push(Column { field, build: Box::new(build), read: None });
        let last = self.list.len() - 1;
        &mut self.list[last]
    }

    /// Adds a column of numbers; a value that is not finite counts as missing.
    pub fn number<V: Into<Option<f64>>>(
        &mut self,
        name: impl Into<String>,
        unit: &str,
        value: impl Fn(&R) -> V + Send + Sync + 'static,
    ) -> &mut Column<R> {
        let column = self.add(name, DataType::Float64, move |rows| {
            let finite = |row: &R| optional::<f64>(value(row)).filter(|number| number.is_finite());
            Arc::new(rows.iter().map(finite).collect::<Float64Array>())
        });
        column.describe("unit", unit.to_owned());
        column
    }

    /// Adds a column of lists of numbers.
    pub fn numbers<V: Into<Option<Vec<f64>>>>(
        &mut self,
        name: impl Into<String>,
        unit: &str,
        value: impl Fn(&R) -> V + Send + Sync + 'static,
    ) -> &mut Column<R> {
        let column = self.add(name, DataType::new_list(DataType::Float64, true), move |rows| {
            let mut lists = ListBuilder::new(Float64Builder::new());
            for row in rows {
                let numbers = optional::<Vec<f64>>(value(row));
                lists.append_option(numbers.map(|numbers| numbers.into_iter().map(Some)));
            }
            Arc::new(lists.finish())
        });
        column.describe("unit", unit.to_owned());
        column
    }

    typed!(count, u64, UInt64, UInt64Array, "counts or indices");
    typed!(small_count, u8, UInt8, UInt8Array, "small counts");
    typed!(integer, i32, Int32, Int32Array, "signed integers");
    typed!(boolean, bool, Boolean, BooleanArray, "Boolean values");
    typed!(text, String, Utf8, StringArray, "free text");

    /// Adds the column with the number of the point of the sweep.
    pub(super) fn point_id(&mut self, value: impl Fn(&R) -> u64 + Send + Sync + 'static) {
        self.count("point_id", value).meaning("number of the sweep's point, from 0");
    }

    /// Adds a dictionary-encoded column of words from a small set.
    pub fn word<V: Into<Option<&'static str>>>(
        &mut self,
        name: impl Into<String>,
        value: impl Fn(&R) -> V + Send + Sync + 'static,
    ) -> &mut Column<R> {
        let kind = DataType::Dictionary(Box::new(DataType::Int32), Box::new(DataType::Utf8));
        self.add(name, kind, move |rows| {
            let mut words = StringDictionaryBuilder::<Int32Type>::new();
            rows.iter().for_each(|row| words.append_option(optional::<&str>(value(row))));
            Arc::new(words.finish())
        })
    }
}

impl<R> Extend<Column<R>> for Columns<R> {
    fn extend<T: IntoIterator<Item = Column<R>>>(&mut self, columns: T) {
        self.list.extend(columns);
    }
}

/// Returns the schema of a table.
///
/// Two columns of the same name are a bug, which the assertion detects in tests: readers refuse
/// such a table, or read the wrong column.
pub fn schema<R>(columns: &[Column<R>]) -> Arc<Schema> {
    debug_assert_eq!(twice(columns), None, "two columns of one name");
    Arc::new(Schema::new(columns.iter().map(|column| column.field.clone()).collect::<Vec<_>>()))
}

/// Returns a name that two columns share, if there is one.
fn twice<R>(columns: &[Column<R>]) -> Option<&str> {
    let mut names = HashSet::new();
    columns.iter().map(Column::name).find(|name| !names.insert(*name))
}

/// Reads the values of a row of a table into a row `R`, as far as the columns say how.
pub(super) fn read_into<R>(columns: &[Column<R>], row: &Row<'_>, into: &mut R) {
    for Column { field, read, .. } in columns {
        read.iter().for_each(|read| read(into, row, field.name()));
    }
}

/// Converts rows into a record batch.
///
/// # Errors
/// Returns an error if the values of a column do not fit its type, which is a bug.
pub fn batch<R>(columns: &[Column<R>], rows: &[R]) -> Result<RecordBatch, ArrowError> {
    let arrays = columns.iter().map(|column| (column.build)(rows)).collect();
    RecordBatch::try_new(schema(columns), arrays)
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

/// Returns the text of a cell of any type that the result tables have; `null` for an empty cell.
pub fn cell_text(column: &dyn Array, row: usize, null: &str) -> String {
    if column.is_null(row) {
        return null.to_owned();
    }
    match column.data_type() {
        DataType::Float64 => {
            ryu::Buffer::new().format(column.as_primitive::<Float64Type>().value(row)).to_owned()
        }
        DataType::UInt64 => column.as_primitive::<UInt64Type>().value(row).to_string(),
        DataType::UInt8 => column.as_primitive::<UInt8Type>().value(row).to_string(),
        DataType::Int32 => column.as_primitive::<Int32Type>().value(row).to_string(),
        DataType::Boolean => column.as_boolean().value(row).to_string(),
        DataType::Utf8 => column.as_string::<i32>().value(row).to_owned(),
        DataType::List(_) => {
            let values = column.as_list::<i32>().value(row);
            let texts = (0..values.len()).map(|index| cell_text(&values, index, null));
            format!("[{}]", texts.collect::<Vec<_>>().join(", "))
        }
        other => match column.as_dictionary_opt::<Int32Type>() {
            Some(words) => cell_text(words.values(), words.keys().value(row) as usize, null),
            None => format!("a cell of {other}"),
        },
    }
}
