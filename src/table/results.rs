//! The output directory of a study: its tables, written as runs come in.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::cycles::{CycleRow, cycle_columns};
use super::density::{DensityRow, density_columns};
use super::equilibria::{EquilibriumRow, equilibrium_columns};
use super::manifest::{FileEntry, Manifest, write_atomically};
use super::points::{PointRow, point_columns};
use super::provenance::{COMMIT, FORMAT, VERSION, provenance};
use super::record::RunRecord;
use super::rest::{RestRow, rest_columns};
use super::runs::run_columns;
use super::writer::{TableWriter, WriteError};
use crate::analysis::{LabelCounts, PointDetail};
use crate::ending::Label;
use crate::study::Study;

/// Why an output directory cannot be used or written.
#[derive(Debug, Error)]
pub enum ResultsError {
    /// It holds something that must not be overwritten.
    #[error("{}: {reason}\n  found:   {found}\n  allowed: {allowed}", path.display())]
    Occupied {
        /// The directory.
        path: PathBuf,
        /// What is wrong.
        reason: String,
        /// What it holds.
        found: String,
        /// What to do.
        allowed: String,
    },
    /// It cannot be made or written to.
    #[error(
        "{}: cannot be used as output directory\n  found:   {cause}\n  allowed: a directory that can \
         be made, read and written to",
        path.display()
    )]
    Unusable {
        /// The directory or a file in it.
        path: PathBuf,
        /// What the operating system says.
        cause: io::Error,
    },
    /// A table cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// What an output directory holds before a study is run.
#[derive(Debug)]
pub enum Destination {
    /// Nothing: the study can be run.
    Free,
    /// All results of this very study.
    Complete(Box<Manifest>),
}

/// Looks at an output directory and refuses one that holds anything but this study's results.
/// Changes nothing.
///
/// # Errors
/// [`ResultsError::Occupied`] or [`ResultsError::Unusable`].
pub fn inspect(directory: &Path, study: &Study, shard: &str) -> Result<Destination, ResultsError> {
    let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
    let occupied = |reason: &str, found: String, allowed: &str| ResultsError::Occupied {
        path: directory.to_owned(),
        reason: reason.to_owned(),
        found,
        allowed: allowed.to_owned(),
    };
    let another = "another directory, with --out DIR, or this one removed or renamed first";
    let mut entries = match fs::read_dir(directory) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Destination::Free),
        Err(error) => return Err(unusable(error)),
    };
    if entries.next().is_none() {
        return Ok(Destination::Free);
    }
    let Some(manifest) = Manifest::read(directory).map_err(unusable)? else {
        let reason = "this directory is not empty and holds no finished study";
        let found = "files without a manifest.json";
        return Err(occupied(reason, found.to_owned(), another));
    };
    if manifest.study_hash != study.hash() || manifest.shard != shard {
        let found = format!(
            "study {}, hash {}, shard {} (this one: {}, hash {}, shard {shard})",
            manifest.study,
            &manifest.study_hash.chars().take(12).collect::<String>(),
            manifest.shard,
            study.name(),
            &study.hash()[..12],
        );
        return Err(occupied("this directory holds the results of another study", found, another));
    }
    if manifest.version != VERSION || manifest.format != FORMAT {
        let found = format!("stickslip {} (this is {VERSION})", manifest.version);
        return Err(occupied("these results are another version's", found, another));
    }
    if !manifest.complete {
        let found = format!("{} of {} runs", manifest.runs_finished, manifest.runs_planned);
        return Err(occupied("an interrupted run of this study is here", found, another));
    }
    for (name, entry) in &manifest.files {
        let bytes = fs::metadata(directory.join(name)).map(|file| file.len());
        if bytes.as_ref().ok() != Some(&entry.bytes) {
            let found = match bytes {
                Ok(bytes) => format!("{name} of {bytes} bytes, {} in the manifest", entry.bytes),
                Err(error) => format!("{name}: {error}"),
            };
            return Err(occupied("these results have been changed since", found, another));
        }
    }
    Ok(Destination::Complete(Box::new(manifest)))
}

/// Facts about a run of the program that only it knows.
#[derive(Clone, Debug, PartialEq)]
pub struct Circumstances {
    /// Part of the study, as `K/N`.
    pub shard: String,
    /// Runs planned in this part; with a precision, the most.
    pub runs_planned: u64,
    /// Whether all runs that are needed have finished.
    pub complete: bool,
    /// When it started, seconds since 1970-01-01 UTC.
    pub started_unix_s: f64,
    /// How long it took, s.
    pub wall_s: f64,
    /// Worker threads.
    pub threads: usize,
}

/// The tables of a study, open for writing.
pub struct Results {
    directory: PathBuf,
    runs: TableWriter<RunRecord>,
    points: TableWriter<PointRow>,
    rest: TableWriter<RestRow>,
    cycles: TableWriter<CycleRow>,
    equilibria: TableWriter<EquilibriumRow>,
    density: TableWriter<DensityRow>,
    counts: LabelCounts,
}

const RUNS: &str = "runs.parquet";
const POINTS: &str = "points.parquet";
const REST: &str = "rest.parquet";
const CYCLES: &str = "cycles.parquet";
const EQUILIBRIA: &str = "equilibria.parquet";
const DENSITY: &str = "density.parquet";
const STUDY: &str = "study.yaml";

impl Results {
    /// Makes the directory, if need be, and starts the tables.
    ///
    /// # Errors
    /// Where it cannot be made or written to.
    pub fn create(directory: &Path, study: &Study) -> Result<Self, ResultsError> {
        let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
        fs::create_dir_all(directory).map_err(unusable)?;
        write_atomically(&directory.join(STUDY), study.resolved_yaml().as_bytes())
            .map_err(unusable)?;
        Ok(Results {
            runs: TableWriter::create(
                &directory.join(RUNS),
                run_columns(study),
                &provenance(study, "runs"),
            )?,
            points: TableWriter::create(
                &directory.join(POINTS),
                point_columns(study),
                &provenance(study, "points"),
            )?,
            rest: TableWriter::create(
                &directory.join(REST),
                rest_columns(study),
                &provenance(study, "rest"),
            )?,
            cycles: TableWriter::create(
                &directory.join(CYCLES),
                cycle_columns(study),
                &provenance(study, "cycles"),
            )?,
            equilibria: TableWriter::create(
                &directory.join(EQUILIBRIA),
                equilibrium_columns(study),
                &provenance(study, "equilibria"),
            )?,
            density: TableWriter::create(
                &directory.join(DENSITY),
                density_columns(study),
                &provenance(study, "density"),
            )?,
            directory: directory.to_owned(),
            counts: LabelCounts::default(),
        })
    }

    /// Adds a run.
    ///
    /// # Errors
    /// Where a table cannot be written.
    pub fn push_run(&mut self, record: RunRecord) -> Result<(), ResultsError> {
        self.counts.add(record.outcome.label());
        if let Some(equilibrium) = EquilibriumRow::of(&record) {
            self.equilibria.push(equilibrium)?;
        }
        Ok(self.runs.push(record)?)
    }

    /// Adds a point and what goes into tables of its own.
    ///
    /// # Errors
    /// Where a table cannot be written.
    pub fn push_point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), ResultsError> {
        for step in detail.rest {
            self.rest.push(RestRow::new(&point, step))?;
        }
        for group in detail.cycles {
            self.cycles.push(CycleRow::new(&point, group))?;
        }
        for bin in detail.density {
            self.density.push(DensityRow::new(&point, bin))?;
        }
        Ok(self.points.push(point)?)
    }

    /// Finishes the tables and writes the manifest, last of all.
    ///
    /// # Errors
    /// Where a file cannot be written.
    pub fn finish(
        self,
        study: &Study,
        circumstances: Circumstances,
    ) -> Result<Manifest, ResultsError> {
        let tables = [
            self.runs.finish()?,
            self.points.finish()?,
            self.rest.finish()?,
            self.cycles.finish()?,
            self.equilibria.finish()?,
            self.density.finish()?,
        ];
        let mut files: BTreeMap<String, FileEntry> = tables.into_iter().flatten().collect();
        let directory = self.directory;
        let unusable = |cause| ResultsError::Unusable { path: directory.clone(), cause };
        let study_file = FileEntry::of(&directory.join(STUDY), None).map_err(unusable)?;
        files.insert(STUDY.to_owned(), study_file);
        let Circumstances { shard, runs_planned, complete, started_unix_s, wall_s, threads } =
            circumstances;
        let counts = self.counts;
        let manifest = Manifest {
            format: FORMAT,
            study: study.name().to_owned(),
            study_hash: study.hash(),
            version: VERSION.to_owned(),
            commit: COMMIT.to_owned(),
            shard,
            runs_planned,
            runs_finished: counts.total(),
            labels: Label::ALL
                .into_iter()
                .map(|label| (label.name().to_owned(), counts.of(label)))
                .collect(),
            complete,
            started_unix_s,
            wall_s,
            threads,
            host: gethostname::gethostname().to_string_lossy().into_owned(),
            files,
        };
        manifest.write(&directory).map_err(unusable)?;
        Ok(manifest)
    }
}
