//! Converts panics of the Parquet library into errors.

use std::panic::{self, AssertUnwindSafe};

use super::error::Fault;

/// Calls the Parquet library, which panics on some damaged files, for example if a value refers to a missing dictionary
/// entry. The values that `call` changes must not be used after a fault.
pub(super) fn guarded<T>(call: impl FnOnce() -> T) -> Result<T, Fault> {
    // The caller drops every value that `call` may have left half changed.
    panic::catch_unwind(AssertUnwindSafe(call))
        .map_err(|_| Fault::damaged("contents that the Parquet library cannot decode"))
}
