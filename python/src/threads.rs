//! The number of worker threads.

use std::num::NonZeroUsize;

use crate::error::Trouble;

/// More threads than any machine has cores would only use memory.
const MOST: i64 = 1024;

/// Returns the number of threads; the default is one per core.
///
/// # Errors
/// Returns an error if the number is out of range.
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
