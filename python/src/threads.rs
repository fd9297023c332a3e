//! The number of worker threads.

use std::num::NonZeroUsize;

use pyo3::prelude::*;

use crate::error::refused;
use crate::values::whole;

/// More threads than any machine has cores would only use memory.
const MOST: i64 = 1024;

/// Returns the number of threads; the default is one per core.
///
/// # Errors
/// Returns a `TypeError` for another type than a whole number, and a `StudyError` if the number is out of range.
pub fn threads(given: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
    let Some(given) = given else {
        return Ok(std::thread::available_parallelism().map_or(1, NonZeroUsize::get));
    };
    let allowed = format!("a whole number from 1 to {MOST}");
    let number = whole("threads", given, &allowed)?;
    let threads = usize::try_from(number).ok().filter(|_| (1..=MOST).contains(&number));
    threads.ok_or_else(|| {
        refused("threads", "not a number of threads", &number.to_string(), &allowed).into()
    })
}
