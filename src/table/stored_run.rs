//! Compares a replayed run with its stored row, in `runs.parquet` or among the finished runs of an unfinished study.

use std::path::{Path, PathBuf};

use arrow_array::cast::AsArray;
use arrow_array::types::UInt64Type;
use arrow_array::{Array, RecordBatch};
use arrow_schema::ArrowError;

use super::column::{batch, cell_text};
use super::manifest::Manifest;
use super::read::open;
use super::run_record::RunRecord;
use super::runs::run_columns;
use super::table_error::TableError;
use crate::sanitize::one_line;
use crate::study::Study;
use crate::tabular::Fault;

/// A column in which a replayed run differs from its stored row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Name of the column.
    pub column: String,
    /// Its value in the table.
    pub stored: String,
    /// Its value in the replayed run.
    pub replayed: String,
}

/// The stored row of a run.
pub struct StoredRun {
    path: PathBuf,
    row: RecordBatch,
}

/// The largest number of characters of the found value in a message.
const LONGEST_FOUND: usize = 400;

/// Returns the error of an unusable table.
fn unusable(path: &Path, problem: &str, found: &str) -> TableError {
    let allowed = "the tables written by `stickslip run`; repeat the same command to write them again from \
                   chunks/";
    TableError::new(path, None, Fault::new(problem, one_line(found, LONGEST_FOUND), allowed))
}

impl StoredRun {
    /// Returns the row of a run in a results directory, or `None` if the table does not exist yet or has no row of this run.
    ///
    /// # Errors
    /// Returns an error if a file of the table differs from the one that was written, cannot be read, or has no run numbers.
    pub fn find(
        directory: &Path,
        manifest: &Manifest,
        run_id: u64,
    ) -> Result<Option<Self>, TableError> {
        let listed = manifest.in_directory(directory);
        for (name, entry) in listed.of_table("runs") {
            let path = listed.check(name, entry)?;
            let found = row(&path, run_id).map_err(|error| {
                let problem = "this is not a readable table of runs";
                unusable(&path, problem, &format!("{}: {}", error.problem, error.found))
            })?;
            if let Some(row) = found {
                return Ok(Some(StoredRun { path, row }));
            }
        }
        Ok(None)
    }

    /// Returns the row of a finished run that is not in a table yet.
    ///
    /// # Errors
    /// Returns an error if the values do not form a row.
    pub fn of_record(
        directory: &Path,
        study: &Study,
        record: &RunRecord,
    ) -> Result<Self, TableError> {
        let row = batch(&run_columns(study), std::slice::from_ref(record)).map_err(|error| {
            unusable(directory, "a finished run forms no row", &error.to_string())
        })?;
        Ok(StoredRun { path: directory.to_owned(), row })
    }

    /// Returns the columns in which a replayed run differs from the stored row; none if they are identical to the last bit.
    ///
    /// # Errors
    /// Returns an error if the table lacks a column or has one of another type.
    pub fn differences(
        &self,
        study: &Study,
        record: &RunRecord,
    ) -> Result<Vec<Difference>, TableError> {
        let broken = |error: ArrowError| {
            unusable(&self.path, "this is not a readable table of runs", &error.to_string())
        };
        let columns = run_columns(study);
        let replayed = batch(&columns, std::slice::from_ref(record)).map_err(broken)?;
        let schema = replayed.schema();
        let mut differences = Vec::new();
        for (field, replayed) in schema.fields().iter().zip(replayed.columns()) {
            let stored = self.row.column_by_name(field.name()).ok_or_else(|| {
                let found = format!("no column {}", field.name());
                unusable(&self.path, "this table of runs lacks a column", &found)
            })?;
            if stored.data_type() != replayed.data_type() {
                let found = format!(
                    "column {} of type {}, not {}",
                    field.name(),
                    stored.data_type(),
                    replayed.data_type()
                );
                let problem = "a column of this table has another type";
                return Err(unusable(&self.path, problem, &found));
            }
            if stored != replayed {
                differences.push(Difference {
                    column: field.name().clone(),
                    stored: cell_text(stored, 0, "null"),
                    replayed: cell_text(replayed, 0, "null"),
                });
            }
        }
        Ok(differences)
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> usize {
        self.row.num_columns()
    }
}

/// Returns the row of a run in a file, or `None` if the file does not contain the run.
fn row(path: &Path, run_id: u64) -> Result<Option<RecordBatch>, TableError> {
    let refuse = |fault| TableError::new(path, None, fault);
    let file = open(path)?;
    let types = file.written_schema().map_err(refuse)?;
    let ids = types.index_of("run_id").map_err(|_| {
        refuse(Fault::new("a column is missing", "no column run_id", "a column run_id"))
    })?;
    let mut before = 0;
    for batch in file.batches(&[ids], &types).map_err(refuse)? {
        let batch = batch.map_err(refuse)?;
        let ids = batch.column(0).as_primitive_opt::<UInt64Type>().ok_or_else(|| {
            let found = format!("run_id of type {}", batch.column(0).data_type());
            refuse(Fault::new("wrong type", found, "whole numbers from 0"))
        })?;
        if let Some(index) = ids.iter().position(|id| id == Some(run_id)) {
            return file.row(before + index as u64, &types).map_err(refuse);
        }
        before += batch.num_rows() as u64;
    }
    Ok(None)
}
