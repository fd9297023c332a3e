//! What a value of Python is. Only a `TypeError` says that it is something else: whatever else is raised on the
//! way, such as `KeyboardInterrupt`, goes on to the user.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;

/// Whether it is text.
pub fn is_text(value: &Bound<'_, PyAny>) -> bool {
    value.is_instance_of::<PyString>()
}

/// The number that it is, if it is one.
///
/// # Errors
/// What the value raises, such as an `OverflowError`.
pub fn number(value: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    unless_type_error(value, value.extract())
}

/// Its items, if it has such.
///
/// # Errors
/// What the value raises.
pub fn items<'py>(value: &Bound<'py, PyAny>) -> PyResult<Option<Vec<Bound<'py, PyAny>>>> {
    let Some(iterator) = unless_type_error(value, value.try_iter())? else { return Ok(None) };
    let mut items = Vec::new();
    // A collection would ask for their number first, and lose what is raised then.
    for item in iterator {
        items.push(item?);
    }
    Ok(Some(items))
}

/// The names of its columns or parts, if it is a mapping.
///
/// # Errors
/// A `TypeError` for a name that is no text; what the value raises.
pub fn keys(value: &Bound<'_, PyAny>) -> PyResult<Option<Vec<String>>> {
    if !value.hasattr("keys")? {
        return Ok(None);
    }
    let names = items(&value.call_method0("keys")?)?.unwrap_or_default();
    let mut keys = Vec::with_capacity(names.len());
    for name in names {
        if !is_text(&name) {
            let kind = kind(&name);
            return Err(PyTypeError::new_err(format!(
                "names: wrong type\n  found:   a name of type {kind}\n  allowed: text"
            )));
        }
        keys.push(name.extract()?);
    }
    Ok(Some(keys))
}

/// The name of its type.
pub fn kind(value: &Bound<'_, PyAny>) -> String {
    value.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string())
}

fn unless_type_error<T>(value: &Bound<'_, PyAny>, result: PyResult<T>) -> PyResult<Option<T>> {
    match result {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.is_instance_of::<PyTypeError>(value.py()) => Ok(None),
        Err(error) => Err(error),
    }
}
