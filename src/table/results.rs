//! The output directory of a study: its tables, written row by row.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::atomic_files::{clear_temporaries, write_once};
use super::column::Column;
use super::cycles::{CycleRow, cycle_columns};
use super::durable_directories::make_directory;
use super::equilibria::{EquilibriumRow, equilibrium_columns};
use super::equilibrium_histogram::{HistogramRow, histogram_columns};
use super::file_entry::FileEntry;
use super::manifest::{Circumstances, MANIFEST, Manifest, RUNS};
use super::points::{PointRow, point_columns};
use super::provenance::provenance;
use super::run_record::RunRecord;
use super::runs::run_columns;
use super::stages::{StageRow, stage_columns};
use super::time_to_rest::{RestRow, rest_columns};
use super::writer::{TableWriter, WriteError};
use crate::analysis::{FailureCounts, LabelCounts, PointDetail};
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

/// The tables of a study, open for writing.
pub struct Results {
    directory: PathBuf,
    runs: TableWriter<RunRecord>,
    points: TableWriter<PointRow>,
    rest: TableWriter<RestRow>,
    cycles: TableWriter<CycleRow>,
    equilibria: TableWriter<EquilibriumRow>,
    histogram: TableWriter<HistogramRow>,
    /// Of a study whose runs have stages.
    stages: Option<TableWriter<StageRow>>,
    counts: LabelCounts,
    failures: FailureCounts,
}

/// The data files of an output directory.
pub(super) const DATA_FILES: [&str; 8] = [
    RUNS,
    "points.parquet",
    "time_to_rest.parquet",
    "cycles.parquet",
    "equilibria.parquet",
    "equilibrium_histogram.parquet",
    STAGES,
    STUDY,
];

/// The table that only a study whose runs have stages has.
pub(super) const STAGES: &str = "stages.parquet";

/// The name of the study file in an output directory.
pub(super) const STUDY: &str = "study.yaml";

impl Results {
    /// Creates the directory if necessary, and starts the tables. Existing tables are replaced when
    /// the new ones are finished; the study file is never replaced. The caller holds the lock of
    /// the directory, so that temporary files of killed processes are removed.
    ///
    /// # Errors
    /// Returns an error if the directory cannot be created or written to, or contains the file of
    /// another study.
    pub fn create(directory: &Path, study: &Study) -> Result<Self, ResultsError> {
        let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
        make_directory(directory).map_err(unusable)?;
        let names: Vec<&str> = DATA_FILES.into_iter().chain([MANIFEST]).collect();
        clear_temporaries(directory, |name| names.contains(&name)).map_err(unusable)?;
        let study_file = directory.join(STUDY);
        write_once(&study_file, study.resolved_yaml().as_bytes())
            .map_err(|cause| ResultsError::Unusable { path: study_file, cause })?;
        let stages = || create(directory, study, "stages", stage_columns(study));
        Ok(Results {
            stages: study.has_stages().then(stages).transpose()?,
            runs: create(directory, study, "runs", run_columns(study))?,
            points: create(directory, study, "points", point_columns(study))?,
            rest: create(directory, study, "time_to_rest", rest_columns(study))?,
            cycles: create(directory, study, "cycles", cycle_columns(study))?,
            equilibria: create(directory, study, "equilibria", equilibrium_columns(study))?,
            histogram: create(directory, study, "equilibrium_histogram", histogram_columns(study))?,
            directory: directory.to_owned(),
            counts: LabelCounts::default(),
            failures: FailureCounts::default(),
        })
    }

    /// Writes a manifest that names the study before there are any results.
    ///
    /// # Errors
    /// Returns an error if the manifest cannot be written.
    pub fn announce(
        &self,
        study: &Study,
        circumstances: Circumstances,
    ) -> Result<(), ResultsError> {
        let manifest =
            Manifest::new(study, circumstances, self.counts, &self.failures, BTreeMap::new());
        let path = &self.directory;
        manifest.write(path).map_err(|cause| ResultsError::Unusable { path: path.clone(), cause })
    }

    /// Adds a run.
    ///
    /// # Errors
    /// Returns an error if a table cannot be written.
    pub fn push_run(&mut self, record: RunRecord) -> Result<(), ResultsError> {
        self.counts.add(record.outcome.label());
        self.failures.add(record.outcome.evidence);
        if let Some(equilibrium) = EquilibriumRow::of(&record) {
            self.equilibria.push(equilibrium)?;
        }
        if let Some(stages) = &mut self.stages {
            StageRow::of(&record).try_for_each(|stage| stages.push(stage))?;
        }
        Ok(self.runs.push(record)?)
    }

    /// Adds a point and its rows in the other tables.
    ///
    /// # Errors
    /// Returns an error if a table cannot be written.
    pub fn push_point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), ResultsError> {
        for step in detail.rest {
            self.rest.push(RestRow::new(&point, step))?;
        }
        for group in detail.cycles {
            self.cycles.push(CycleRow::new(&point, group))?;
        }
        for bin in detail.histogram {
            self.histogram.push(HistogramRow::new(&point, bin))?;
        }
        Ok(self.points.push(point)?)
    }

    /// Finishes the tables, and writes the manifest last.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written.
    pub fn finish(
        self,
        study: &Study,
        circumstances: Circumstances,
    ) -> Result<Manifest, ResultsError> {
        let stages = self.stages.map(TableWriter::finish).transpose()?;
        let tables = [
            self.runs.finish()?,
            self.points.finish()?,
            self.rest.finish()?,
            self.cycles.finish()?,
            self.equilibria.finish()?,
            self.histogram.finish()?,
        ];
        let mut files: BTreeMap<String, FileEntry> =
            tables.into_iter().chain(stages).flatten().collect();
        let directory = self.directory;
        let unusable = |cause| ResultsError::Unusable { path: directory.clone(), cause };
        let study_file = FileEntry::of(&directory.join(STUDY), None).map_err(unusable)?;
        files.insert(STUDY.to_owned(), study_file);
        let manifest = Manifest::new(study, circumstances, self.counts, &self.failures, files);
        manifest.write(&directory).map_err(unusable)?;
        Ok(manifest)
    }
}

/// Starts a table, called by its name without `.parquet`.
fn create<R>(
    directory: &Path,
    study: &Study,
    name: &str,
    columns: Vec<Column<R>>,
) -> Result<TableWriter<R>, WriteError> {
    let path = directory.join(format!("{name}.parquet"));
    TableWriter::create(&path, columns, &provenance(study, name))
}
