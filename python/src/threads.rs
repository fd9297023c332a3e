//! How many worker threads.

use std::num::NonZeroUsize;

use crate::error::Trouble;

/// More threads than any machine has cores would only take memory.
const MOST: i64 = 1024;

/// So many threads; one per core where none are given.
///
/// # Errors
/// A number of threads that makes no sense.
pub fn threads(given: Option<i64>) -> Result<usize, Trouble> {
    let Some(given) = given else {
        return Ok(std::thread::available_parallelism().map_or(1, NonZeroUsize::get));
    };
    let threads = usize::try_from(given).ok().filter(|_| (1..=MOST).contains(&given));
    threads.ok_or_else(|| {
        let allowed = format!("a whole number from 1 to {MOST}");
        Trouble::Usage(format!(
            "threads: not a number of threads\n  found:   {given}\n  allowed: {allowed}"
        ))
    })
}
