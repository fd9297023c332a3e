//! The tables of a study, written row by row into memory or into the files of an output directory.

use std::convert::Infallible;
use std::io;
use std::path::{Path, PathBuf};

use arrow_schema::SchemaRef;
use thiserror::Error;

use super::column::{Column, schema};
use super::durable_files::{clear_temporaries, make_directory, write_once};
use super::file_entry::FileEntry;
use super::manifest::{MANIFEST, Manifest};
use super::of_point::{
    CycleRow, HistogramRow, PointKey, RestRow, cycle_columns, histogram_columns, rest_columns,
};
use super::points::{PointRow, point_columns};
use super::provenance::provenance;
use super::run_record::RunRecord;
use super::run_rows::{EquilibriumRow, StageRow, equilibrium_columns, stage_columns};
use super::runs::run_columns;
use super::table_files::TableFiles;
use super::writer::{Destination, MemoryRows, MemoryTable, TableWriter, WriteError};
use crate::analysis::PointDetail;
use crate::study::Study;

/// Receives runs and points in the order of the study.
pub trait Sink: Send {
    /// Receives a finished run. Runs arrive in ascending order of their numbers.
    fn run(&mut self, record: RunRecord) -> Result<(), WriteError>;

    /// Receives a point whose runs have finished, all of them or those before an interruption; `detail` holds the
    /// rows of other tables.
    fn point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), WriteError>;
}

/// The name of the study file in an output directory.
pub(super) const STUDY: &str = "study.yaml";

/// Declares the tables: name, rows and columns of each.
macro_rules! tables {
    ($($name:ident: $row:ty = $columns:ident,)*) => {
        /// The names of the tables: the file names without `.parquet`.
        const TABLES: &[&str] = &[$(stringify!($name)),*];

        /// The data files of an output directory.
        pub(super) const DATA_FILES: &[&str] = &[$(concat!(stringify!($name), ".parquet"),)* STUDY];

        /// The tables of a study, open for writing; `None` is a table that the study does not have.
        pub struct StudyTables<D> {
            $($name: Option<TableWriter<$row, D>>,)*
        }

        impl<D: Destination> StudyTables<D> {
            /// Starts the tables: `start` gets the name of a table, its provenance and its schema.
            pub(super) fn new<E>(
                study: &Study,
                start: impl Fn(&str, &str, SchemaRef) -> Result<D, E>,
            ) -> Result<Self, E> {
                Ok(StudyTables { $($name: begin(study, stringify!($name), $columns, &start)?,)* })
            }

            /// Writes the remaining rows. Returns the destinations in the order of [`table_names`].
            pub(super) fn close(self) -> Result<Vec<D>, WriteError> {
                let tables = [$(self.$name.map(TableWriter::close)),*];
                tables.into_iter().flatten().collect()
            }
        }
    };
}

tables! {
    runs: RunRecord = run_columns,
    points: PointRow = point_columns,
    time_to_rest: RestRow = rest_columns,
    cycles: CycleRow = cycle_columns,
    equilibria: EquilibriumRow = equilibrium_columns,
    equilibrium_histogram: HistogramRow = histogram_columns,
    stages: StageRow = stage_columns,
}

/// Returns the names of a study's tables: the file names without `.parquet`. Only a study whose runs have stages has the
/// table `stages`, the last one.
pub fn table_names(study: &Study) -> impl Iterator<Item = &'static str> {
    TABLES.iter().copied().filter(|name| *name != "stages" || study.has_stages())
}

fn begin<R, D: Destination, E>(
    study: &Study,
    name: &str,
    columns: fn(&Study) -> Vec<Column<R>>,
    start: impl Fn(&str, &str, SchemaRef) -> Result<D, E>,
) -> Result<Option<TableWriter<R, D>>, E> {
    if table_names(study).all(|other| other != name) {
        return Ok(None);
    }
    let columns = columns(study);
    let destination = start(name, &provenance(study, name), schema(&columns))?;
    Ok(Some(TableWriter::new(columns, destination)))
}

/// Adds rows to a table if there is one.
fn push<R, D: Destination>(
    table: &mut Option<TableWriter<R, D>>,
    rows: impl IntoIterator<Item = R>,
) -> Result<(), WriteError> {
    table.as_mut().map_or(Ok(()), |table| table.extend(rows))
}

impl<D: Destination> Sink for StudyTables<D> {
    fn run(&mut self, record: RunRecord) -> Result<(), WriteError> {
        push(&mut self.equilibria, EquilibriumRow::of(&record))?;
        push(&mut self.stages, StageRow::of(&record))?;
        push(&mut self.runs, [record])
    }

    fn point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), WriteError> {
        let PointDetail { rest, cycles, histogram } = detail;
        let key = PointKey { point_id: point.point_id, swept: point.swept.clone() };
        push(&mut self.time_to_rest, rest.into_iter().map(|step| RestRow::new(&key, step)))?;
        push(&mut self.cycles, cycles.into_iter().map(|group| CycleRow::new(&key, group)))?;
        let bins = histogram.into_iter().map(|bin| HistogramRow::new(&key, bin));
        push(&mut self.equilibrium_histogram, bins)?;
        push(&mut self.points, [point])
    }
}

impl StudyTables<MemoryRows> {
    /// Starts the tables in memory.
    pub fn in_memory(study: &Study) -> Self {
        let Ok(tables) = Self::new(study, |_, provenance, schema| {
            Ok::<_, Infallible>(MemoryRows::new(&schema, provenance))
        });
        tables
    }

    /// Returns the tables in the order of [`table_names`].
    ///
    /// # Errors
    /// Returns an error if values do not fit their column, which is a bug.
    pub fn finish(self) -> Result<Vec<MemoryTable>, WriteError> {
        self.close()?.into_iter().map(MemoryRows::finish).collect()
    }
}

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
