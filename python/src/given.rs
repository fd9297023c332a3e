//! Conversion of designs from Python: rows, columns, or an Arrow table of any library.

use arrow_array::ffi_stream::RecordBatchStreamReader;
use pyo3::exceptions::{PyImportError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyCapsule};
use stickslip::study::file::values::Entry;
use stickslip::study::{DesignValue, Study};

use crate::error::Trouble;
use crate::values::{is_text, items, keys, kind, number};

/// The name of the argument in messages.
const NAME: &str = "designs";
/// The accepted types.
const ALLOWED: &str = "a list of dicts, a dict of columns, one design as a dict of values, or an Arrow table or \
                       dataframe";

/// Converts and validates designs.
///
/// # Errors
/// Returns a `TypeError` if the designs are not a table of numbers and text, and a `StudyError` if
/// the study does not have these designs.
pub fn designs(study: &Study, given: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<DesignValue>>> {
    if given.hasattr("__arrow_c_stream__")? {
        match given.call_method0("__arrow_c_stream__") {
            Ok(stream) => {
                let designs = study.designs_in_arrow(NAME, reader(&stream)?);
                return Ok(designs.map_err(Trouble::from)?);
            }
            // A pandas dataframe without pyarrow still has columns.
            Err(error) if error.is_instance_of::<PyImportError>(given.py()) => {}
            Err(error) => return Err(error),
        }
    }
    let (columns, rows) = match keys(given)? {
        Some(names) => of_columns(given, names)?,
        None => of_rows(given)?,
    };
    Ok(study.designs_in_memory(NAME, columns, rows).map_err(Trouble::from)?)
}

/// Returns the record batches behind a capsule.
fn reader(stream: &Bound<'_, PyAny>) -> PyResult<RecordBatchStreamReader> {
    let capsule = stream.cast::<PyCapsule>()?;
    let stream = capsule.pointer_checked(Some(c"arrow_array_stream"))?;
    // SAFETY: the Arrow PyCapsule interface guarantees that a capsule of this name, which the code
    // above has checked, points to an ArrowArrayStream that lives as long as the capsule. The
    // stream is moved out, and a released stream is left in its place, as the interface requires of
    // consumers.
    let reader = unsafe { RecordBatchStreamReader::from_raw(stream.cast().as_ptr()) };
    reader.map_err(|error| {
        Trouble::Usage(format!("{NAME}: not a table\n  found:   {error}\n  allowed: {ALLOWED}"))
            .into()
    })
}

type Rows = Vec<Vec<Option<Entry>>>;

/// Converts a mapping of columns, or of values, which is one design.
fn of_columns(given: &Bound<'_, PyAny>, names: Vec<String>) -> PyResult<(Vec<String>, Rows)> {
    let mut columns = Vec::with_capacity(names.len());
    let mut values = Vec::with_capacity(names.len());
    for name in &names {
        let column = given.get_item(name)?;
        values.push(if is_text(&column) { None } else { items(&column)? });
        columns.push(column);
    }
    if values.iter().all(Option::is_none) {
        let row = names.iter().zip(&columns).map(|(name, value)| entry(0, name, value));
        let row = row.collect::<PyResult<Vec<_>>>()?;
        return Ok((names, vec![row]));
    }
    let mut rows: Rows = Vec::new();
    for (place, ((name, column), values)) in names.iter().zip(&columns).zip(values).enumerate() {
        let values = values.ok_or_else(|| {
            wrong(&format!("column {name}"), column, "a list of numbers or of text")
        })?;
        if rows.len() < values.len() {
            // Earlier columns are shorter.
            rows.resize(values.len(), vec![None; place]);
        }
        for (row, value) in values.iter().enumerate() {
            rows[row].push(entry(row, name, value)?);
        }
        for row in &mut rows {
            row.resize(place + 1, None);
        }
    }
    Ok((names, rows))
}

/// Converts mappings, one per design.
fn of_rows(given: &Bound<'_, PyAny>) -> PyResult<(Vec<String>, Rows)> {
    let designs = if is_text(given) { None } else { items(given)? };
    let designs = designs.ok_or_else(|| wrong("all of it", given, ALLOWED))?;
    let mut columns: Vec<String> = Vec::new();
    let mut rows: Rows = Vec::new();
    for (row, design) in designs.iter().enumerate() {
        let Some(names) = keys(design)? else {
            return Err(wrong(&format!("row {}", row + 1), design, ALLOWED));
        };
        let mut values = vec![None; columns.len()];
        for name in names {
            let value = entry(row, &name, &design.get_item(&name)?)?;
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
fn entry(row: usize, name: &str, value: &Bound<'_, PyAny>) -> PyResult<Option<Entry>> {
    if value.is_none() {
        return Ok(None);
    }
    if is_text(value) {
        return Ok(Some(Entry::Text(value.extract()?)));
    }
    match number(value)? {
        Some(number) if !value.is_instance_of::<PyBool>() => Ok(Some(Entry::Number(number))),
        _ => Err(wrong(&format!("row {}, column {name}", row + 1), value, "a number or text")),
    }
}

fn wrong(place: &str, found: &Bound<'_, PyAny>, allowed: &str) -> PyErr {
    let kind = kind(found);
    PyTypeError::new_err(format!(
        "{NAME}: `{place}`: wrong type\n  found:   a value of type {kind}\n  allowed: {allowed}"
    ))
}
