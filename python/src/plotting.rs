//! Figures of `stickslip.figures`, by their names.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::Trouble;

/// Draws a figure of `stickslip.figures` from results, with the options of the figure.
///
/// # Errors
/// Returns a `StudyError` if the figure is not among `allowed`, a `ModuleNotFoundError` without matplotlib, and the
/// exceptions of the figure.
pub fn draw<'py>(
    results: &Bound<'py, PyAny>,
    figure: &str,
    allowed: &[&str],
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    if !allowed.contains(&figure) {
        let allowed = allowed.join(", ");
        let text = format!("figure: no such figure\n  found:   {figure}\n  allowed: {allowed}");
        return Err(Trouble::Usage(text).into());
    }
    results.py().import("stickslip.figures")?.getattr(figure)?.call((results,), options)
}
