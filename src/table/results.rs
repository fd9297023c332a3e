//! The output directory of a study: its tables, written row by row.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::durable_files::{clear_temporaries, make_directory, write_once};
use super::file_entry::FileEntry;
use super::manifest::{MANIFEST, Manifest};
use super::study_tables::{DATA_FILES, STUDY, StudyTables};
use super::table_files::TableFiles;
use super::writer::WriteError;
use crate::study::Study;

/// Why an output directory cannot be used or written.
#[derive(Debug, Error)]
pub enum ResultsError {
    /// It contains something that must not be overwritten.
    #[error("{}: {reason}\n  found:   {found}\n  allowed: {allowed}", path.display())]
    Occupied {
        /// The directory.
        path: PathBuf,
        /// The problem.
        reason: String,
        /// What the directory contains.
        found: String,
        /// What to do.
        allowed: String,
    },
    /// It cannot be created or written to.
    #[error(
        "{}: cannot be used as output directory\n  found:   {cause}\n  allowed: a directory that \
         can be created, read and written to",
        path.display()
    )]
    Unusable {
        /// The directory or a file in it.
        path: PathBuf,
        /// The error of the operating system.
        cause: io::Error,
    },
    /// A table cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl ResultsError {
    /// Returns the errors of a directory or a file that the operating system refuses.
    pub(crate) fn unusable(path: &Path) -> impl Fn(io::Error) -> Self + '_ {
        |cause| ResultsError::Unusable { path: path.to_owned(), cause }
    }

    /// Returns the error of a directory or a file that must not be overwritten.
    pub(crate) fn occupied(
        path: &Path,
        reason: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        let (reason, found, allowed) = (reason.into(), found.into(), allowed.into());
        ResultsError::Occupied { path: path.to_owned(), reason, found, allowed }
    }
}

/// The tables of a study in an output directory, open for writing.
pub struct Results {
    directory: PathBuf,
    /// The tables.
    pub tables: StudyTables<TableFiles>,
}

impl Results {
    /// Creates the directory if necessary, and starts the tables. Existing tables are replaced when
    /// the new ones are finished; the study file is never replaced. The caller holds the lock of
    /// the directory, so that temporary files of killed processes are removed.
    ///
    /// # Errors
    /// Returns an error if the directory cannot be created or written to, or contains the file of
    /// another study.
    pub fn create(directory: &Path, study: &Study) -> Result<Self, ResultsError> {
        make_directory(directory).map_err(ResultsError::unusable(directory))?;
        let is_own = |name: &str| DATA_FILES.contains(&name) || name == MANIFEST;
        clear_temporaries(directory, is_own).map_err(ResultsError::unusable(directory))?;
        let study_file = directory.join(STUDY);
        write_once(&study_file, study.resolved_yaml().as_bytes())
            .map_err(ResultsError::unusable(&study_file))?;
        let tables = StudyTables::new(study, |name, provenance, schema| {
            TableFiles::create(&directory.join(format!("{name}.parquet")), schema, provenance)
        })?;
        Ok(Results { directory: directory.to_owned(), tables })
    }

    /// Writes a manifest that names the study before there are any results.
    ///
    /// # Errors
    /// Returns an error if the manifest cannot be written.
    pub fn announce(&self, manifest: &Manifest) -> Result<(), ResultsError> {
        manifest.write(&self.directory).map_err(ResultsError::unusable(&self.directory))
    }

    /// Finishes the tables, and writes the manifest with their files last.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written.
    pub fn finish(self, mut manifest: Manifest) -> Result<Manifest, ResultsError> {
        let unusable = ResultsError::unusable(&self.directory);
        for table in self.tables.close()? {
            manifest.files.extend(table.finish(true, |_| Ok(()))?);
        }
        let study_file = FileEntry::of(&self.directory.join(STUDY), None).map_err(&unusable)?;
        manifest.files.insert(STUDY.to_owned(), study_file);
        if manifest.complete {
            // A merged directory is like any other.
            manifest.merging.clear();
        }
        manifest.write(&self.directory).map_err(unusable)?;
        Ok(manifest)
    }
}
