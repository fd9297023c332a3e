//! Reads a table as CSV or Parquet according to the extension of its file name.

use std::path::Path;

use super::cells::{Cells, Limits, too_many_values};
use super::csv;
use super::error::{Fault, Refusal};
use super::parquet::ParquetFile;
use crate::sanitize::shorten;

/// The file formats.
#[derive(Clone, Copy)]
enum Format {
    Csv,
    Parquet,
}

/// Returns the format by the extension of a file name, or `None` if it is not supported.
fn format(path: &Path) -> Option<Format> {
    let extension = path.extension()?.to_str()?;
    let is = |name: &str| extension.eq_ignore_ascii_case(name);
    if is("csv") { Some(Format::Csv) } else { is("parquet").then_some(Format::Parquet) }
}

/// Checks that a file name has a supported extension.
///
/// # Errors
/// Returns a fault if the extension is neither `.csv` nor `.parquet`.
pub(crate) fn check_name(path: &Path, allowed: &str) -> Result<(), Fault> {
    let found = shorten(&path.to_string_lossy());
    let problem = "the file name ends in neither .csv nor .parquet";
    format(path).map(drop).ok_or_else(|| Fault::new(problem, found, allowed))
}

impl Cells {
    /// Reads a table from the bytes of its file, in the format of the file name.
    ///
    /// # Errors
    /// Returns the first fault with its location.
    pub fn read(path: &Path, bytes: Vec<u8>, limits: &Limits<'_>) -> Result<Cells, Refusal> {
        match format(path) {
            Some(Format::Parquet) => Self::of_parquet(bytes, limits),
            _ => csv::read(bytes, limits),
        }
    }

    fn of_parquet(bytes: Vec<u8>, limits: &Limits<'_>) -> Result<Cells, Refusal> {
        let file = ParquetFile::in_memory(bytes)?;
        let mut cells = Self::of_schema(file.schema(), limits)?;
        let (rows, columns) = (file.rows(), cells.columns.len());
        if rows.saturating_mul(columns.max(1) as u64) > limits.values as u64 {
            return Err(too_many_values(format!("{rows} rows of {columns} columns"), limits).into());
        }
        let all: Vec<usize> = (0..columns).collect();
        for batch in file.batches(&all, file.schema())? {
            cells.push(&batch?)?;
        }
        Ok(cells)
    }
}
