//! Type tests of Python values. Only a `TypeError` means another type; any other exception, such as
//! `KeyboardInterrupt`, is passed to the user.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;

/// Returns whether the value is text.
pub fn is_text(value: &Bound<'_, PyAny>) -> bool {
    value.is_instance_of::<PyString>()
}

/// Returns the value as a number, if it is one.
///
/// # Errors
/// Returns the exception of the value, such as an `OverflowError`.
pub fn number(value: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    unless_type_error(value, value.extract())
}

/// Returns the items of the value, if it is iterable.
///
/// # Errors
/// Returns the exception of the value.
pub fn items<'py>(value: &Bound<'py, PyAny>) -> PyResult<Option<Vec<Bound<'py, PyAny>>>> {
    let Some(iterator) = unless_type_error(value, value.try_iter())? else { return Ok(None) };
    let mut items = Vec::new();
    // `collect` would ask for the length first, and ignore an exception from it.
    for item in iterator {
        items.push(item?);
    }
    Ok(Some(items))
}

/// Returns the keys of the value, if it is a mapping.
///
/// # Errors
/// Returns a `TypeError` for a key that is not text, and the exception of the value.
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

/// Returns the name of the type.
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
