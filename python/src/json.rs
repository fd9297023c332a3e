//! JSON of the library as Python values.

use pyo3::prelude::*;
use serde_json::Value;

/// Converts JSON to dicts, lists, numbers, text, booleans and None.
///
/// # Errors
/// Returns the exception of Python's reader.
pub fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (value.to_string(),))
}
