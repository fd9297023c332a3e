//! Tables for Python: Arrow's C data interface without a copy, and Python lists.

use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{Float64Type, Int32Type, UInt8Type, UInt64Type};
use arrow_array::{Array, ArrayRef, RecordBatchIterator, StringArray};
use arrow_schema::DataType;
use arrow_schema::ffi::FFI_ArrowSchema;
use pyo3::exceptions::{PyKeyError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList};
use stickslip::table::MemoryTable;

use crate::error::{Trouble, wrong_type};
use crate::values::is_text;

/// A table with named columns, in memory: the content of a Parquet file of stickslip.
///
/// Any library with Arrow's PyCapsule interface reads it without a copy: ``pyarrow.table(table)``,
/// ``polars.DataFrame(table)``, ``duckdb.sql("FROM table")``,
/// ``pandas.DataFrame.from_arrow(table)``. ``table["speed_rad_s"]`` and ``table.to_dict()`` need no
/// library. The metadata of the schema contain the program and the study as JSON under
/// ``stickslip``; the metadata of a column contain its unit and meaning.
#[pyclass(frozen, module = "stickslip")]
pub struct Table(pub MemoryTable);

#[pymethods]
impl Table {
    /// Returns a capsule ``arrow_schema``, for Arrow libraries.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.0.schema.as_ref()).map_err(Trouble::from)?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }

    /// Returns a capsule ``arrow_array_stream``, for Arrow libraries, always with the schema of the
    /// table.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface permits a producer to ignore the requested schema.
        drop(requested_schema);
        let batches = self.0.batches.clone().into_iter().map(Ok);
        let reader = RecordBatchIterator::new(batches, self.0.schema.clone());
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    /// Number of rows.
    #[getter]
    fn num_rows(&self) -> usize {
        self.0.rows()
    }

    /// Number of columns.
    #[getter]
    fn num_columns(&self) -> usize {
        self.0.schema.fields().len()
    }

    /// Names of the columns, in order.
    #[getter]
    fn column_names(&self) -> Vec<&str> {
        self.0.schema.fields().iter().map(|field| field.name().as_str()).collect()
    }

    /// Unit of each column, by name; None for a column without a unit.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.metadata(py, "unit")
    }

    /// Meaning of each column, by name.
    #[getter]
    fn meanings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.metadata(py, "meaning")
    }

    /// Whether there is a column with this name.
    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        name.extract::<String>().is_ok_and(|name| self.0.schema.index_of(&name).is_ok())
    }

    /// Number of rows.
    fn __len__(&self) -> usize {
        self.0.rows()
    }

    /// Returns the values of a column as a list, with None for missing values.
    ///
    /// Raises KeyError if there is no such column, and TypeError for a row: rows are those of a dataframe, such as
    /// ``table.to_pandas()``.
    fn __getitem__<'py>(&self, name: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyList>> {
        let py = name.py();
        if !is_text(name) {
            let allowed = "the name of a column; `to_pandas()` and `to_polars()` have rows";
            return Err(wrong_type("column", name, allowed));
        }
        let name: &str = &name.extract::<String>()?;
        let index = self.0.schema.index_of(name);
        let index = index.map_err(|_| {
            let names = self.column_names().join(", ");
            PyKeyError::new_err(format!("{name}: no such column; there are {names}"))
        })?;
        self.column(py, index)
    }

    /// Returns all columns as lists, by name and in order, with None for missing values.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        for (index, name) in self.column_names().into_iter().enumerate() {
            columns.set_item(name, self.column(py, index)?)?;
        }
        Ok(columns)
    }

    /// Returns the table as a ``pyarrow.Table``, without a copy.
    ///
    /// Raises ImportError without pyarrow.
    fn to_pyarrow(slf: Bound<'_, Self>) -> PyResult<Bound<'_, PyAny>> {
        slf.py().import("pyarrow")?.call_method1("table", (slf,))
    }

    /// Returns the table as a ``polars.DataFrame``; numbers are not copied.
    ///
    /// Raises ImportError without polars.
    fn to_polars(slf: Bound<'_, Self>) -> PyResult<Bound<'_, PyAny>> {
        slf.py().import("polars")?.call_method1("DataFrame", (slf,))
    }

    /// Returns the table as a ``pandas.DataFrame``.
    ///
    /// Raises ImportError without pyarrow and pandas.
    fn to_pandas(slf: Bound<'_, Self>) -> PyResult<Bound<'_, PyAny>> {
        Table::to_pyarrow(slf)?.call_method0("to_pandas")
    }

    /// Returns the values of some rows, by column, for the display.
    fn _rows<'py>(
        &self,
        py: Python<'py>,
        first: usize,
        count: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        for (index, name) in self.column_names().into_iter().enumerate() {
            let list = PyList::empty(py);
            let mut before = 0;
            for batch in &self.0.batches {
                let rows = batch.num_rows();
                let from = first.saturating_sub(before).min(rows);
                let to = first.saturating_add(count).saturating_sub(before).min(rows);
                if from < to {
                    append(&list, &batch.column(index).slice(from, to - from))?;
                }
                before += rows;
            }
            columns.set_item(name, list)?;
        }
        Ok(columns)
    }

    fn __repr__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("stickslip._display")?.call_method1("text", (slf,))
    }

    /// Shows the first and the last rows as an HTML table, for notebooks.
    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("stickslip._display")?.call_method1("html", (slf,))
    }
}

impl Table {
    fn metadata<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyDict>> {
        let values = PyDict::new(py);
        for field in self.0.schema.fields() {
            values.set_item(field.name(), field.metadata().get(key))?;
        }
        Ok(values)
    }

    fn column<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for batch in &self.0.batches {
            append(&list, batch.column(index))?;
        }
        Ok(list)
    }
}

/// Appends the values of a column to a list.
fn append(list: &Bound<'_, PyList>, column: &ArrayRef) -> PyResult<()> {
    match column.data_type() {
        DataType::Float64 => append_all(list, column.as_primitive::<Float64Type>()),
        DataType::UInt64 => append_all(list, column.as_primitive::<UInt64Type>()),
        DataType::UInt8 => append_all(list, column.as_primitive::<UInt8Type>()),
        DataType::Int32 => append_all(list, column.as_primitive::<Int32Type>()),
        DataType::Boolean => append_all(list, column.as_boolean()),
        DataType::List(_) => {
            for values in column.as_list::<i32>().iter() {
                match values {
                    None => list.append(list.py().None())?,
                    Some(values) => {
                        let inner = PyList::empty(list.py());
                        append(&inner, &values)?;
                        list.append(inner)?;
                    }
                }
            }
            Ok(())
        }
        DataType::Dictionary(..) => {
            let words = column.as_dictionary::<Int32Type>();
            match words.downcast_dict::<StringArray>() {
                Some(words) => append_all(list, words),
                None => Err(unknown(column)),
            }
        }
        DataType::Utf8 => append_all(list, column.as_string::<i32>()),
        _ => Err(unknown(column)),
    }
}

/// Returns the error for a column type that no result table has.
fn unknown(column: &ArrayRef) -> PyErr {
    PyTypeError::new_err(format!("a column of {}", column.data_type()))
}

fn append_all<'py, V: IntoPyObject<'py>>(
    list: &Bound<'py, PyList>,
    values: impl IntoIterator<Item = Option<V>>,
) -> PyResult<()> {
    values.into_iter().try_for_each(|value| list.append(value))
}
