//! Reads a table as CSV or Parquet according to the extension of its file name.

use std::path::Path;

use super::cells::{Cells, Limits, too_many_values};
use super::csv;
use super::error::{Fault, Refusal};
use super::parquet::ParquetFile;
use crate::sanitize::shorten;

fn has_extension(path: &Path, name: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(name))
}

/// Checks that a file name has a supported extension.
pub(crate) fn check_name(path: &Path, allowed: &str) -> Result<(), Fault> {
    let found = shorten(&path.to_string_lossy());
    let problem = "the file name ends in neither .csv nor .parquet";
    match has_extension(path, "csv") || has_extension(path, "parquet") {
        true => Ok(()),
        false => Err(Fault::new(problem, found, allowed)),
    }
}

impl Cells {
    /// Reads a table from the bytes of its file, in the format of the file name.
    pub fn read(path: &Path, bytes: Vec<u8>, limits: &Limits<'_>) -> Result<Cells, Refusal> {
        match has_extension(path, "parquet") {
            true => Self::of_parquet(bytes, limits),
            false => csv::read(bytes, limits),
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
