//! Type tests of Python values. Only a `TypeError` means another type; any other exception, such as
//! `KeyboardInterrupt`, is passed to the user.

use std::path::PathBuf;

use pyo3::exceptions::{PyOverflowError, PyTypeError, PyUnicodeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyByteArray, PyBytes, PyString};

use crate::error::{refused, wrong_type};

/// The largest number of items of a value.
const MOST_ITEMS: usize = 10_000_000;
/// The number of items after which signals are checked: an iterator may be endless.
const LOOK: usize = 1 << 16;

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

/// Returns the items of the value, if it is iterable and not a string of bytes.
///
/// # Errors
/// Returns the exception of the value or of a signal handler, and a `StudyError` for too many items.
pub fn items<'py>(value: &Bound<'py, PyAny>) -> PyResult<Option<Vec<Bound<'py, PyAny>>>> {
    if value.is_instance_of::<PyBytes>() || value.is_instance_of::<PyByteArray>() {
        return Ok(None);
    }
    let Some(iterator) = unless_type_error(value, value.try_iter())? else { return Ok(None) };
    let mut items = Vec::new();
    // `collect` would ask for the length first, and ignore an exception from it.
    for item in iterator {
        items.push(item?);
        if items.len() % LOOK == 0 {
            value.py().check_signals()?;
        }
        if items.len() > MOST_ITEMS {
            let (found, allowed) =
                (format!("more, from a {}", kind(value)), "at most 10000000 values");
            return Err(refused("values", "too many", &found, allowed).into());
        }
    }
    Ok(Some(items))
}

/// Returns text; `place` says where it is.
///
/// # Errors
/// Returns a `TypeError` for another type, and a `StudyError` for text with surrogates, which is not Unicode.
pub fn text(place: impl FnOnce() -> String, value: &Bound<'_, PyAny>) -> PyResult<String> {
    value.extract().map_err(|error: PyErr| {
        if !error.is_instance_of::<PyUnicodeError>(value.py()) {
            return wrong_type(&place(), value, "text");
        }
        let shown = value.repr().map_or_else(|_| "?".to_owned(), |text| text.to_string());
        refused(&place(), "text that is not Unicode", &shown, "text without surrogates").into()
    })
}

/// Returns a number or an array of numpy, or a series, as the values of Python that it holds; any other value is returned
/// as it is.
///
/// # Errors
/// Returns the exception of the value.
pub fn plain<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if !value.hasattr("dtype")? || !value.hasattr("tolist")? {
        return Ok(value.clone());
    }
    value.call_method0("tolist")
}

/// Returns a whole number.
///
/// # Errors
/// Returns a `TypeError` for another type, and a `StudyError` for a number that is out of range.
pub fn whole(key: &str, value: &Bound<'_, PyAny>, allowed: &str) -> PyResult<i64> {
    let is_boolean = value.is_instance_of::<PyBool>();
    match value.extract::<i64>() {
        Ok(number) if !is_boolean => Ok(number),
        Err(error) if error.is_instance_of::<PyOverflowError>(value.py()) => {
            Err(refused(key, "out of range", &value.str()?.to_string(), allowed).into())
        }
        Err(error) if !error.is_instance_of::<PyTypeError>(value.py()) => Err(error),
        _ => Err(wrong_type(key, value, allowed)),
    }
}

/// Returns the directories in the argument `tables`.
///
/// # Errors
/// Returns a `TypeError` for another type, such as a single path.
pub fn directories(value: &Bound<'_, PyAny>) -> PyResult<Vec<PathBuf>> {
    let allowed = "a list of directories, such as [\"tables\"]";
    let given = if is_text(value) { None } else { items(value)? };
    let given = given.ok_or_else(|| wrong_type("tables", value, allowed))?;
    let path =
        |one: &Bound<'_, PyAny>| one.extract().map_err(|_| wrong_type("tables", one, allowed));
    given.iter().map(path).collect()
}

/// Returns the keys of the value, if it is a mapping. A series without names is none.
///
/// # Errors
/// Returns a `TypeError` for a key that is not text, with the place of the value, and the exception of the value.
pub fn keys(place: &str, value: &Bound<'_, PyAny>) -> PyResult<Option<Vec<String>>> {
    if !value.hasattr("keys")? {
        return Ok(None);
    }
    let names = items(&value.call_method0("keys")?)?.unwrap_or_default();
    let mut keys = Vec::with_capacity(names.len());
    for name in names {
        if !is_text(&name) {
            if value.hasattr("tolist")? {
                return Ok(None);
            }
            let kind = kind(&name);
            let shown = name.str()?;
            return Err(PyTypeError::new_err(format!(
                "{place}: wrong type of a name\n  found:   {shown}, a name of type {kind}\n  allowed: names that are text"
            )));
        }
        keys.push(text(|| place.to_owned(), &name)?);
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
