//! The output directory of `stickslip equilibria`: up to three tables.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

use super::file_list::FileList;
use super::frictionless::{FrictionlessRow, frictionless_columns};
use super::provenance::provenance_with;
use super::results::ResultsError;
use super::set::{SetRow, SetSummaryRow, set_columns, set_summary_columns};
use super::temporary;
use super::writer::{TableWriter, WriteError};
use crate::foreign::shorten;
use crate::study::Study;

/// What a directory is claimed by, under a temporary name.
const CLAIM: &str = "claim";

/// What the directory is to hold.
#[derive(Clone, Debug)]
pub struct EquilibriumFiles {
    /// Whether `set.parquet`, the large one, is written.
    pub positions: bool,
    /// Whether the frictionless equilibria are at speeds of their own instead of the sweep's points.
    pub own_speeds: bool,
    /// The options that decide the tables, for their metadata.
    pub options: Value,
}

/// The tables, open for writing.
pub struct EquilibriumTables {
    directory: PathBuf,
    set: Option<TableWriter<SetRow>>,
    sets: TableWriter<SetSummaryRow>,
    frictionless: TableWriter<FrictionlessRow>,
}

impl EquilibriumFiles {
    /// Refuses a directory that holds anything. Changes nothing.
    ///
    /// # Errors
    /// [`ResultsError::Occupied`] or [`ResultsError::Unusable`].
    pub fn inspect(directory: &Path) -> Result<(), ResultsError> {
        let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
        let first = match fs::read_dir(directory) {
            Ok(mut entries) => entries.next().transpose().map_err(unusable)?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(unusable(error)),
        };
        first.map_or(Ok(()), |entry| {
            Err(ResultsError::Occupied {
                path: directory.to_owned(),
                reason: "this directory is not empty".to_owned(),
                found: format!(
                    "{} and perhaps more",
                    shorten(&entry.file_name().to_string_lossy())
                ),
                allowed: "another directory, with --out DIR, or this one removed or renamed first"
                    .to_owned(),
            })
        })
    }

    /// Makes the directory, if need be, for this process alone as long as the value lives: refuses one that holds
    /// anything, also what another process has begun in the same moment, be it that both are refused then.
    ///
    /// # Errors
    /// [`ResultsError::Occupied`] or [`ResultsError::Unusable`].
    pub fn claim(directory: &Path) -> Result<TempDir, ResultsError> {
        let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
        fs::create_dir_all(directory).map_err(unusable)?;
        let claim = temporary::directory(&directory.join(CLAIM)).map_err(unusable)?;
        for entry in fs::read_dir(directory).map_err(unusable)? {
            let name = entry.map_err(unusable)?.file_name();
            if Some(name.as_os_str()) != claim.path().file_name() {
                return Err(ResultsError::Occupied {
                    path: directory.to_owned(),
                    reason: "another process writes into this directory".to_owned(),
                    found: shorten(&name.to_string_lossy()),
                    allowed: "another directory, with --out DIR".to_owned(),
                });
            }
        }
        Ok(claim)
    }

    /// Makes the directory, if need be, and starts the tables.
    ///
    /// # Errors
    /// Where it is not empty or cannot be made or written to.
    pub fn create(
        &self,
        directory: &Path,
        study: &Study,
    ) -> Result<EquilibriumTables, ResultsError> {
        Self::inspect(directory)?;
        let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
        fs::create_dir_all(directory).map_err(unusable)?;
        let provenance = |table| provenance_with(study, table, &self.options);
        let path = |table| directory.join(format!("{table}.parquet"));
        let set = || TableWriter::create(&path("set"), set_columns(study), &provenance("set"));
        Ok(EquilibriumTables {
            directory: directory.to_owned(),
            set: self.positions.then(set).transpose()?,
            sets: TableWriter::create(
                &path("sets"),
                set_summary_columns(study),
                &provenance("sets"),
            )?,
            frictionless: TableWriter::create(
                &path("frictionless"),
                frictionless_columns(study, self.own_speeds),
                &provenance("frictionless"),
            )?,
        })
    }
}

impl EquilibriumTables {
    /// Whether there is a table for positions.
    pub fn takes_positions(&self) -> bool {
        self.set.is_some()
    }

    /// Adds a position.
    ///
    /// # Errors
    /// Where the table cannot be written.
    pub fn push_position(&mut self, row: SetRow) -> Result<(), WriteError> {
        self.set.as_mut().map_or(Ok(()), |set| set.push(row))
    }

    /// Adds a point of the sweep.
    ///
    /// # Errors
    /// Where the table cannot be written.
    pub fn push_set(&mut self, row: SetSummaryRow) -> Result<(), WriteError> {
        self.sets.push(row)
    }

    /// Adds an equilibrium without friction.
    ///
    /// # Errors
    /// Where the table cannot be written.
    pub fn push_frictionless(&mut self, row: FrictionlessRow) -> Result<(), WriteError> {
        self.frictionless.push(row)
    }

    /// Finishes all tables and lists their files.
    ///
    /// # Errors
    /// Where a file cannot be written.
    pub fn finish(self) -> Result<(), WriteError> {
        let directory = self.directory.as_path();
        let mut list = FileList::default();
        if let Some(set) = self.set {
            set.finish_after(|files| list.announce(directory, files))?;
        }
        self.sets.finish_after(|files| list.announce(directory, files))?;
        self.frictionless.finish_after(|files| list.announce(directory, files))?;
        Ok(())
    }
}
