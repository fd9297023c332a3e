//! A finished study: its tables, in memory or in a directory.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, OnceLock};

use arrow_schema::ArrowError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::analysis::PointDetail;
use stickslip::classification::Label;
use stickslip::engine::{
    EngineOptions, OutputDir, Parts, Planned, Progress, Ready, Show, Sink, run_study,
};
use stickslip::study::Study;
use stickslip::table::{
    self, Circumstances, Manifest, MemoryResults, MemoryTable, MemoryTables, PointRow,
    ResultsError, RunRecord, STAGES_TABLE, TABLES,
};

use crate::error::Trouble;
use crate::table::Table;
use crate::waiting::wait;

/// The tables of a finished study, and the number of runs per label.
///
/// If the study ran into a directory, each table is read on first access. A table that exceeds the
/// memory can be read in part: ``polars.scan_parquet(f"{results.directory}/runs.parquet")``.
#[pyclass(frozen, module = "stickslip")]
pub struct Results {
    labels: Vec<(String, u64)>,
    directory: Option<PathBuf>,
    manifest: Option<Arc<Manifest>>,
    tables: [OnceLock<MemoryTable>; 6],
    /// Of a study whose runs have stages.
    stages: Option<OnceLock<MemoryTable>>,
}

#[pymethods]
impl Results {
    /// One row per run, including failed runs: parameters, start state, label, evidence, final
    /// position.
    #[getter]
    fn runs(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, 0)
    }

    /// One row per point of the sweep: counts, fractions with confidence intervals, times to rest,
    /// amplitudes.
    #[getter]
    fn points(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, 1)
    }

    /// The probability of being at rest over time with confidence intervals, per point.
    #[getter]
    fn time_to_rest(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, 2)
    }

    /// The limit cycles by class, per point.
    #[getter]
    fn cycles(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, 3)
    }

    /// The equilibria of the runs that came to rest.
    #[getter]
    fn equilibria(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, 4)
    }

    /// The number of equilibria in each part of the ring.
    #[getter]
    fn equilibrium_histogram(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, 5)
    }

    /// One row per run and stage of a disc that starts or a table that is kicked: the speeds of disc and balls, and the
    /// largest displacement of the table. None for a study without stages.
    #[getter]
    fn stages(&self, py: Python<'_>) -> PyResult<Option<Table>> {
        self.stages.as_ref().map(|slot| self.in_slot(py, slot, STAGES_TABLE)).transpose()
    }

    /// Number of runs by label: equilibrium, limit_cycle, irregular, undecided, failed.
    #[getter]
    fn labels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let labels = PyDict::new(py);
        for (label, runs) in &self.labels {
            labels.set_item(label, runs)?;
        }
        Ok(labels)
    }

    /// The directory of the tables; None if they are only in memory.
    #[getter]
    fn directory(&self) -> Option<&Path> {
        self.directory.as_deref()
    }

    fn __repr__(&self) -> String {
        let labels = self.labels.iter().filter(|(_, runs)| *runs > 0);
        let labels: Vec<String> = labels.map(|(label, runs)| format!("{runs} {label}")).collect();
        format!("<stickslip.Results: {}>", labels.join(", "))
    }
}

impl Results {
    fn table(&self, py: Python<'_>, index: usize) -> PyResult<Table> {
        self.in_slot(py, &self.tables[index], TABLES[index])
    }

    /// Returns the table in a slot, which is read on the first access.
    fn in_slot(
        &self,
        py: Python<'_>,
        slot: &OnceLock<MemoryTable>,
        name: &'static str,
    ) -> PyResult<Table> {
        if let Some(table) = slot.get() {
            return Ok(Table(table.clone()));
        }
        let (Some(directory), Some(manifest)) = (self.directory.clone(), self.manifest.clone())
        else {
            return Err(Trouble::Defect("a defect of stickslip: no table".to_owned()).into());
        };
        let read = move |_: &AtomicBool| {
            Ok::<_, Trouble>(table::Table::open(&directory, &manifest, name)?.in_memory()?)
        };
        let table = wait(py, read)??;
        Ok(Table(slot.get_or_init(|| table).clone()))
    }
}

/// How a study is to be run.
pub struct Run {
    /// Number of worker threads.
    pub threads: usize,
    /// How progress is shown.
    pub show: Show,
    /// Whether a study may replace results without a reusable run.
    pub recompute: bool,
}

impl Run {
    /// Runs a study and keeps its tables in memory.
    ///
    /// # Errors
    /// Returns an error if the threads cannot be started.
    pub fn in_memory(self, study: &Study, stop: &AtomicBool) -> Result<Results, Trouble> {
        let mut tables = MemoryResults::new(study);
        let progress = Progress::begin(self.planned(study), self.show);
        let mut sink = InMemory(&mut tables);
        let ended = run_study(study, self.options(), stop, &progress, None, &mut sink);
        progress.close();
        let totals = ended?;
        let labels = Label::ALL.map(|label| (label.name().to_owned(), totals.counts.of(label)));
        let MemoryTables { tables, stages } = tables.finish()?;
        Ok(Results {
            labels: labels.to_vec(),
            directory: None,
            manifest: None,
            tables: tables.map(OnceLock::from),
            stages: stages.map(OnceLock::from),
        })
    }

    /// Runs a study into a directory, like the command line.
    ///
    /// # Errors
    /// Returns an error if the directory contains something else, or cannot be used.
    pub fn into_directory(
        self,
        study: &Study,
        directory: PathBuf,
        stop: &AtomicBool,
    ) -> Result<Results, Trouble> {
        let options = self.options();
        let output_dir = OutputDir {
            directory: &directory,
            shard: options.shard,
            retry_failed: options.retry_failed,
            recompute: self.recompute,
            shards: &[],
            quiet: self.show == Show::Nothing,
        };
        let manifest = match output_dir.prepare(study)? {
            Ready::Complete(manifest) => *manifest,
            Ready::Open(mut store, mut results) => {
                let begun =
                    Circumstances::begin(options.shard.to_string(), options.shard.most_runs(study));
                let progress = Progress::begin(self.planned(study), self.show);
                let mut sink = InFiles(&mut results);
                let ended =
                    run_study(study, options, stop, &progress, Some(&mut *store), &mut sink);
                let wall_s = progress.close().as_secs_f64();
                let totals = ended?;
                store.check()?;
                let (runs_kept, threads) = (totals.reused, options.threads);
                let complete = !totals.interrupted();
                results.finish(
                    study,
                    Circumstances { runs_kept, complete, wall_s, threads, ..begun },
                )?
            }
        };
        let of = |label: &Label| manifest.labels.get(label.name()).copied().unwrap_or(0);
        let labels = Label::ALL.iter().map(|label| (label.name().to_owned(), of(label))).collect();
        Ok(Results {
            labels,
            directory: Some(directory),
            manifest: Some(Arc::new(manifest)),
            tables: Default::default(),
            stages: study.has_stages().then(OnceLock::new),
        })
    }

    fn options(&self) -> EngineOptions {
        EngineOptions { threads: self.threads, ..EngineOptions::default() }
    }

    fn planned<'a>(&self, study: &'a Study) -> Planned<'a> {
        Planned {
            study: study.name(),
            runs: self.options().shard.most_runs(study),
            at_most: study.precision().is_some(),
            parts: Parts::Points(study.point_count()),
        }
    }
}

/// Collects runs and points in memory.
struct InMemory<'a>(&'a mut MemoryResults);

impl Sink for InMemory<'_> {
    type Error = ArrowError;

    fn run(&mut self, record: RunRecord) -> Result<(), ArrowError> {
        self.0.push_run(record)
    }

    fn point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), ArrowError> {
        self.0.push_point(point, detail)
    }
}

/// Writes runs and points to files.
struct InFiles<'a>(&'a mut table::Results);

impl Sink for InFiles<'_> {
    type Error = ResultsError;

    fn run(&mut self, record: RunRecord) -> Result<(), ResultsError> {
        self.0.push_run(record)
    }

    fn point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), ResultsError> {
        self.0.push_point(point, detail)
    }
}
