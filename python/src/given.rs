//! Tables from Python: a file, rows, columns, or an Arrow table of any library.

use std::path::PathBuf;

use arrow_array::ffi_stream::RecordBatchStreamReader;
use pyo3::exceptions::{PyImportError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyCapsule};
use stickslip::study::file::values::Entry;

use crate::error::{Trouble, wrong_type};
use crate::values::{is_text, items, keys, number, plain, text};

/// A table that the user has given.
pub enum Given {
    /// A CSV or Parquet file.
    File(PathBuf),
    /// Of a library with Arrow's interface.
    Arrow(RecordBatchStreamReader),
    /// The names of the columns, and rows with one value per column.
    Rows(Vec<String>, Rows),
}

/// The rows of a table; a missing value is `None`.
type Rows = Vec<Vec<Option<Entry>>>;

/// What a table is called in messages.
#[derive(Clone, Copy)]
pub struct Words {
    /// The name of the argument.
    pub name: &'static str,
    /// The accepted types.
    pub allowed: &'static str,
}

impl Words {
    /// Converts a table.
    ///
    /// # Errors
    /// Returns a `TypeError` if the value is neither a path nor a table of numbers and text.
    pub fn given(self, given: &Bound<'_, PyAny>) -> PyResult<Given> {
        if is_text(given) || given.hasattr("__fspath__")? {
            return Ok(Given::File(given.extract()?));
        }
        if given.hasattr("__arrow_c_stream__")? {
            match given.call_method0("__arrow_c_stream__") {
                Ok(stream) => return Ok(Given::Arrow(self.reader(&stream)?)),
                // A pandas dataframe without pyarrow still has columns.
                // A series or a dataframe of mixed values, which has no Arrow type, still has values.
                Err(error)
                    if error.is_instance_of::<PyImportError>(given.py())
                        || error.is_instance_of::<PyTypeError>(given.py())
                        || error.is_instance_of::<PyValueError>(given.py()) => {}
                Err(error) => return Err(error),
            }
        }
        let (columns, rows) = match keys(self.name, given)? {
            Some(names) => self.of_columns(given, names)?,
            None => self.of_rows(given)?,
        };
        Ok(Given::Rows(columns, rows))
    }

    /// Returns the record batches behind a capsule.
    fn reader(self, stream: &Bound<'_, PyAny>) -> PyResult<RecordBatchStreamReader> {
        let capsule = stream.cast::<PyCapsule>()?;
        let stream = capsule.pointer_checked(Some(c"arrow_array_stream"))?;
        // SAFETY: the Arrow PyCapsule interface guarantees that a capsule of this name, which the code
        // above has checked, points to an ArrowArrayStream that lives as long as the capsule. The
        // stream is moved out, and a released stream is left in its place, as the interface requires of
        // consumers.
        let reader = unsafe { RecordBatchStreamReader::from_raw(stream.cast().as_ptr()) };
        let Words { name, allowed } = self;
        reader.map_err(|error| {
            Trouble::Usage(format!("{name}: not a table\n  found:   {error}\n  allowed: {allowed}"))
                .into()
        })
    }

    /// Converts a mapping of columns, or of values, which is one design.
    fn of_columns(
        self,
        given: &Bound<'_, PyAny>,
        names: Vec<String>,
    ) -> PyResult<(Vec<String>, Rows)> {
        let mut columns = Vec::with_capacity(names.len());
        let mut values = Vec::with_capacity(names.len());
        for name in &names {
            let column = given.get_item(name)?;
            values.push(if is_text(&column) { None } else { items(&column)? });
            columns.push(column);
        }
        if values.iter().all(Option::is_none) {
            let row = names.iter().zip(&columns).map(|(name, value)| self.entry(0, name, value));
            let row = row.collect::<PyResult<Vec<_>>>()?;
            return Ok((names, vec![row]));
        }
        let mut rows: Rows = Vec::new();
        for (place, ((name, column), values)) in names.iter().zip(&columns).zip(values).enumerate()
        {
            let values = values.ok_or_else(|| {
                self.wrong(&format!("column {name}"), column, "a list of numbers or of text")
            })?;
            if rows.len() < values.len() {
                // Earlier columns are shorter.
                rows.resize(values.len(), vec![None; place]);
            }
            for (row, value) in values.iter().enumerate() {
                rows[row].push(self.entry(row, name, value)?);
            }
            for row in &mut rows {
                row.resize(place + 1, None);
            }
        }
        Ok((names, rows))
    }

    /// Converts mappings, one per design.
    fn of_rows(self, given: &Bound<'_, PyAny>) -> PyResult<(Vec<String>, Rows)> {
        let designs = items(given)?.ok_or_else(|| wrong_type(self.name, given, self.allowed))?;
        let mut columns: Vec<String> = Vec::new();
        let mut rows: Rows = Vec::new();
        for (row, design) in designs.iter().enumerate() {
            let place = format!("row {}", row + 1);
            let Some(names) = keys(&format!("{}: `{place}`", self.name), design)? else {
                return Err(self.wrong(&place, design, self.allowed));
            };
            let mut values = vec![None; columns.len()];
            for name in names {
                let value = self.entry(row, &name, &design.get_item(&name)?)?;
                match columns.iter().position(|column| *column == name) {
                    Some(place) => values[place] = value,
                    None => {
                        columns.push(name);
                        values.push(value);
                    }
                }
            }
            rows.push(values);
        }
        // Columns that first appear in a later row are missing in the earlier rows.
        for row in &mut rows {
            row.resize(columns.len(), None);
        }
        Ok((columns, rows))
    }

    /// Converts a number, text, or nothing.
    fn entry(self, row: usize, name: &str, value: &Bound<'_, PyAny>) -> PyResult<Option<Entry>> {
        if value.is_none() {
            return Ok(None);
        }
        if is_text(value) {
            let place = || format!("{}: `row {}, column {name}`", self.name, row + 1);
            return Ok(Some(Entry::Text(text(place, value)?)));
        }
        let plain = plain(value)?;
        match number(&plain)? {
            Some(number) if !plain.is_instance_of::<PyBool>() => Ok(Some(Entry::Number(number))),
            _ => Err(self.wrong(
                &format!("row {}, column {name}", row + 1),
                value,
                "a number or text",
            )),
        }
    }

    fn wrong(self, place: &str, found: &Bound<'_, PyAny>, allowed: &str) -> PyErr {
        wrong_type(&format!("{}: `{place}`", self.name), found, allowed)
    }
}
