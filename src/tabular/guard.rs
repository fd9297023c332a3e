//! Calls of the Parquet library, whose assertions damaged files fail.

use std::panic::{self, AssertUnwindSafe};

use super::error::Fault;

/// Calls the Parquet library, which has assertions that damaged files fail, such as a value that refers
/// to a dictionary's entry that is not there. What `call` changes must not be used after a fault.
///
/// # Errors
/// A fault where the library panics.
pub(super) fn guarded<T>(call: impl FnOnce() -> T) -> Result<T, Fault> {
    // Nothing that is used later outlives the unwinding.
    panic::catch_unwind(AssertUnwindSafe(call))
        .map_err(|_| Fault::damaged("contents that the Parquet library stumbles over"))
}
