//! Figures of `stickslip.figures`: those of the report, which Rust makes and Python draws, and those that Python makes from
//! tables.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::report::chart::PrintedFigure;
use stickslip::report::printed_figures;

use crate::error::Trouble;
use crate::waiting::wait;

/// Returns the figures of a directory of results or of a search, of these points or of all points, as JSON that
/// ``stickslip.figures`` draws.
#[pyfunction]
#[pyo3(signature = (directory, points = None))]
pub fn _figures(py: Python<'_>, directory: PathBuf, points: Option<Vec<u64>>) -> PyResult<String> {
    let read = move |_: &AtomicBool| json_of(&printed_figures(&directory, points.as_deref())?);
    Ok(wait(py, read)??)
}

/// Returns figures as JSON.
///
/// # Errors
/// Returns an error only for a defect.
pub fn json_of(figures: &[PrintedFigure]) -> Result<String, Trouble> {
    serde_json::to_string(figures)
        .map_err(|error| Trouble::Defect(format!("a defect of stickslip: {error}")))
}

/// Draws a figure of the report with its options.
///
/// # Errors
/// Returns a `ModuleNotFoundError` without matplotlib, and the exceptions of the figure.
pub fn draw<'py>(
    results: &Bound<'py, PyAny>,
    figure: &str,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    results.py().import("stickslip.figures")?.getattr("draw")?.call((results, figure), options)
}

/// Draws a figure of `stickslip.figures` from tables, with the options of the figure.
///
/// # Errors
/// Returns a `StudyError` if the figure is not among `allowed`, a `ModuleNotFoundError` without matplotlib, and the
/// exceptions of the figure.
pub fn draw_tables<'py>(
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
