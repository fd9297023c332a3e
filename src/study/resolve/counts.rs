//! Validation of whole numbers within a range.

use std::ops::RangeInclusive;

use crate::study::error::StudyError;
use crate::study::file::source_path::SourcePath;
use crate::study::file::values::Count;

/// Returns the number under a key, if it is written.
pub(crate) fn count_within(
    path: &SourcePath<'_>,
    key: &str,
    written: Option<Count>,
    range: RangeInclusive<u64>,
) -> Result<Option<u64>, StudyError> {
    let Some(Count(number)) = written else { return Ok(None) };
    if range.contains(&number) {
        return Ok(Some(number));
    }
    let allowed = format!("a whole number from {} to {}", range.start(), range.end());
    Err(path.key(key).wrong_value("out of range", number.to_string(), allowed))
}
