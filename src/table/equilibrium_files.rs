//! The output directory of `stickslip equilibria`: up to three tables.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::column::Column;
use super::equilibrium_set::{SetRow, SetSummaryRow, set_columns, set_summary_columns};
use super::file_list::FileList;
use super::frictionless_equilibria::{FrictionlessRow, frictionless_columns};
use super::provenance::provenance_with;
use super::table_files::TableFiles;
use super::writer::{TableWriter, WriteError};
use crate::study::Study;

/// The content of the directory.
#[derive(Clone, Debug)]
pub struct EquilibriumFiles {
    /// Whether `equilibrium_positions.parquet` is written, which is large.
    pub positions: bool,
    /// Whether the frictionless equilibria are computed at given speeds instead of the points of
    /// the sweep.
    pub own_speeds: bool,
    /// The options that determine the tables, for their metadata.
    pub options: Value,
}

/// The tables, open for writing.
pub struct EquilibriumTables {
    directory: PathBuf,
    /// `equilibrium_positions.parquet`, if it is written.
    pub positions: Option<TableWriter<SetRow, TableFiles>>,
    /// `equilibrium_set_summary.parquet`.
    pub sets: TableWriter<SetSummaryRow, TableFiles>,
    /// `frictionless_equilibria.parquet`.
    pub frictionless: TableWriter<FrictionlessRow, TableFiles>,
}

impl EquilibriumFiles {
    /// Returns the names of the tables.
    pub fn names(&self) -> Vec<&'static str> {
        let set = self.positions.then_some("equilibrium_positions.parquet");
        set.into_iter()
            .chain(["equilibrium_set_summary.parquet", "frictionless_equilibria.parquet"])
            .collect()
    }

    /// Starts the tables in a directory.
    ///
    /// # Errors
    /// Returns an error if the directory is not writable.
    pub fn create(&self, directory: &Path, study: &Study) -> Result<EquilibriumTables, WriteError> {
        let positions = self.positions.then(|| {
            self.create_table(directory, study, "equilibrium_positions", set_columns(study))
        });
        let (summary, frictionless) = ("equilibrium_set_summary", "frictionless_equilibria");
        let columns = frictionless_columns(study, self.own_speeds);
        Ok(EquilibriumTables {
            directory: directory.to_owned(),
            positions: positions.transpose()?,
            sets: self.create_table(directory, study, summary, set_summary_columns(study))?,
            frictionless: self.create_table(directory, study, frictionless, columns)?,
        })
    }

    fn create_table<R>(
        &self,
        directory: &Path,
        study: &Study,
        name: &str,
        columns: Vec<Column<R>>,
    ) -> Result<TableWriter<R, TableFiles>, WriteError> {
        let path = directory.join(format!("{name}.parquet"));
        TableWriter::create(&path, columns, &provenance_with(study, name, &self.options))
    }
}

impl EquilibriumTables {
    /// Finishes all tables and adds their files to the list of the directory. No existing table is
    /// replaced.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written, or if its name is taken.
    pub fn finish(self, list: &mut FileList) -> Result<(), WriteError> {
        let directory = self.directory.as_path();
        if let Some(positions) = self.positions {
            positions.finish_after(false, |files| list.announce(directory, files))?;
        }
        self.sets.finish_after(false, |files| list.announce(directory, files))?;
        self.frictionless.finish_after(false, |files| list.announce(directory, files))
    }
}
