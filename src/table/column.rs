//! A column of a table: its name, unit and meaning, and how its value is computed from a row.
//!
//! A table is a list of columns; its schema and its record batches are derived from the same list.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use arrow_array::builder::{Float64Builder, ListBuilder, StringDictionaryBuilder};
use arrow_array::types::Int32Type;
use arrow_array::{
    ArrayRef, BooleanArray, Float64Array, Int32Array, RecordBatch, StringArray, UInt8Array,
    UInt64Array,
};
use arrow_schema::ArrowError;
use arrow_schema::{DataType, Field, Schema};

type Build<R> = Box<dyn Fn(&[R]) -> ArrayRef + Send + Sync>;

/// One column of a table of rows `R`.
pub struct Column<R> {
    field: Field,
    build: Build<R>,
}

/// Unit of non-dimensional values: lengths over the ring radius, and time multiplied by the natural
/// frequency.
pub const NON_DIMENSIONAL: &str = "1 (non-dimensional)";

impl<R> Column<R> {
    fn new(name: &str, kind: DataType, unit: &str, meaning: &str, build: Build<R>) -> Self {
        let metadata = [("unit", unit), ("meaning", meaning)]
            .into_iter()
            .filter(|(_, text)| !text.is_empty())
            .map(|(key, text)| (key.to_owned(), text.to_owned()))
            .collect::<HashMap<_, _>>();
        Column { field: Field::new(name, kind, true).with_metadata(metadata), build }
    }

    /// Returns the name.
    pub fn name(&self) -> &str {
        self.field.name()
    }

    /// Creates a column of numbers; a value that is not finite counts as missing.
    pub fn number(
        name: &str,
        unit: &str,
        meaning: &str,
        value: impl Fn(&R) -> Option<f64> + Send + Sync + 'static,
    ) -> Self {
        let build = move |rows: &[R]| -> ArrayRef {
            let values = rows.iter().map(|row| value(row).filter(|number| number.is_finite()));
            Arc::new(values.collect::<Float64Array>())
        };
        Self::new(name, DataType::Float64, unit, meaning, Box::new(build))
    }

    /// Creates a column of counts or indices.
    pub fn count(
        name: &str,
        meaning: &str,
        value: impl Fn(&R) -> Option<u64> + Send + Sync + 'static,
    ) -> Self {
        let build = move |rows: &[R]| -> ArrayRef {
            Arc::new(rows.iter().map(&value).collect::<UInt64Array>())
        };
        Self::new(name, DataType::UInt64, "", meaning, Box::new(build))
    }

    /// Creates a column of small counts.
    pub fn small_count(
        name: &str,
        meaning: &str,
        value: impl Fn(&R) -> Option<u8> + Send + Sync + 'static,
    ) -> Self {
        let build = move |rows: &[R]| -> ArrayRef {
            Arc::new(rows.iter().map(&value).collect::<UInt8Array>())
        };
        Self::new(name, DataType::UInt8, "", meaning, Box::new(build))
    }

    /// Creates a column of signed integers.
    pub fn integer(
        name: &str,
        meaning: &str,
        value: impl Fn(&R) -> Option<i32> + Send + Sync + 'static,
    ) -> Self {
        let build = move |rows: &[R]| -> ArrayRef {
            Arc::new(rows.iter().map(&value).collect::<Int32Array>())
        };
        Self::new(name, DataType::Int32, "", meaning, Box::new(build))
    }

    /// Creates a column of lists of numbers.
    pub fn numbers(
        name: &str,
        unit: &str,
        meaning: &str,
        value: impl Fn(&R) -> Option<Vec<f64>> + Send + Sync + 'static,
    ) -> Self {
        let build = move |rows: &[R]| -> ArrayRef {
            let mut lists = ListBuilder::new(Float64Builder::new());
            for row in rows {
                lists.append_option(value(row).map(|numbers| numbers.into_iter().map(Some)));
            }
            Arc::new(lists.finish())
        };
        let kind = DataType::new_list(DataType::Float64, true);
        Self::new(name, kind, unit, meaning, Box::new(build))
    }

    /// Creates a column of booleans.
    pub fn truth(
        name: &str,
        meaning: &str,
        value: impl Fn(&R) -> Option<bool> + Send + Sync + 'static,
    ) -> Self {
        let build = move |rows: &[R]| -> ArrayRef {
            Arc::new(rows.iter().map(&value).collect::<BooleanArray>())
        };
        Self::new(name, DataType::Boolean, "", meaning, Box::new(build))
    }

    /// Creates a dictionary-encoded column of words from a small set.
    pub fn word(
        name: &str,
        meaning: &str,
        value: impl Fn(&R) -> &'static str + Send + Sync + 'static,
    ) -> Self {
        Self::optional_word(name, meaning, move |row| Some(value(row)))
    }

    /// Creates a dictionary-encoded column of words from a small set, in which values may be
    /// missing.
    pub fn optional_word(
        name: &str,
        meaning: &str,
        value: impl Fn(&R) -> Option<&'static str> + Send + Sync + 'static,
    ) -> Self {
        let build = move |rows: &[R]| -> ArrayRef {
            let mut words = StringDictionaryBuilder::<Int32Type>::new();
            for row in rows {
                words.append_option(value(row));
            }
            Arc::new(words.finish())
        };
        let kind = DataType::Dictionary(Box::new(DataType::Int32), Box::new(DataType::Utf8));
        Self::new(name, kind, "", meaning, Box::new(build))
    }

    /// Creates a column of free text.
    pub fn text(
        name: &str,
        meaning: &str,
        value: impl Fn(&R) -> Option<String> + Send + Sync + 'static,
    ) -> Self {
        let build = move |rows: &[R]| -> ArrayRef {
            Arc::new(rows.iter().map(&value).collect::<StringArray>())
        };
        Self::new(name, DataType::Utf8, "", meaning, Box::new(build))
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

/// Converts rows into a record batch.
///
/// # Errors
/// Returns an error if the values of a column do not fit its type, which is a bug.
pub fn batch<R>(columns: &[Column<R>], rows: &[R]) -> Result<RecordBatch, ArrowError> {
    let arrays = columns.iter().map(|column| (column.build)(rows)).collect();
    RecordBatch::try_new(schema(columns), arrays)
}
