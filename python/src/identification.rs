//! The result of an inference, for Python.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;
use stickslip::engine::WorkerPool;
use stickslip::identify::Identify;
use stickslip::study::{MeasuredRun, Study, StudyError, TableSource, implausible_angle};
use stickslip::table::MemoryTable;

use crate::directory::{Directory, check_named};
use crate::error::{Trouble, no_threads, warn};
use crate::given::{Given, Words};
use crate::json::to_python;
use crate::plotting::draw_tables;
use crate::progress::Bars;
use crate::table::Table;
use crate::waiting::wait_with;

/// Parameters inferred from measured positions of rest.
#[pyclass(frozen, module = "stickslip")]
pub struct Identification {
    summary: Value,
    in_words: String,
    failed_runs: u64,
    tables: [MemoryTable; 4],
    directory: Directory,
}

#[pymethods]
impl Identification {
    /// The content of ``identification.json``: medians, intervals, correlations, and the tests of the model.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.summary)
    }

    /// Number of failed runs; the densities exclude them.
    #[getter]
    fn failed_runs(&self) -> u64 {
        self.failed_runs
    }

    /// Samples of the posterior, as in ``posterior.parquet``.
    #[getter]
    fn posterior(&self) -> Table {
        Table(self.tables[0].clone())
    }

    /// The log-likelihood of each parameter set, as in ``parameter_sets.parquet``.
    #[getter]
    fn parameter_sets(&self) -> Table {
        Table(self.tables[1].clone())
    }

    /// Whether the model explains the measurements, at each point, as in ``fit.parquet``.
    #[getter]
    fn fit(&self) -> Table {
        Table(self.tables[2].clone())
    }

    /// Measured and predicted positions of rest, as in ``positions.parquet``.
    #[getter]
    fn positions(&self) -> Table {
        Table(self.tables[3].clone())
    }

    /// The directory of the files; None without ``out``.
    #[getter]
    fn directory(&self) -> Option<&Path> {
        self.directory.named()
    }

    /// Draws the figure ``stickslip.figures.identification`` with its options, such as ``width="single"``.
    ///
    /// Raises ModuleNotFoundError without matplotlib, numpy and pyarrow.
    #[pyo3(signature = (**options))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        draw_tables(slf.as_any(), "identification", &["identification"], options)
    }

    /// The directory from which figures read.
    fn _source(&self) -> &Path {
        self.directory.path()
    }

    fn __repr__(&self) -> String {
        format!("<stickslip.Identification>\n{}", self.in_words.trim_end())
    }
}

/// What measured runs are called in messages.
const MEASURED: Words = Words {
    name: "measured",
    allowed: "a path, a list of dicts, a dict of columns, or an Arrow table or dataframe",
};

/// Reads measured runs.
fn measured_runs(study: &Study, given: Given) -> Result<Vec<MeasuredRun>, StudyError> {
    match given {
        Given::File(file) => study.measured(&file),
        Given::Arrow(reader) => study.measured(TableSource::Arrow(MEASURED.name, Box::new(reader))),
        Given::Rows(columns, rows) => {
            study.measured(TableSource::Rows(MEASURED.name, columns, rows))
        }
    }
}

/// How an inference is computed.
pub struct Options {
    /// The directory of the results.
    pub out: Option<PathBuf>,
    /// The directory of simulated runs.
    pub simulations: Option<PathBuf>,
    /// Number of worker threads.
    pub threads: usize,
    /// Whether to show progress.
    pub progress: bool,
}

impl Identification {
    /// Infers the parameters of a study from measured runs.
    ///
    /// # Errors
    /// Returns the errors of the inference, and the exception of a signal handler.
    pub fn infer(
        py: Python<'_>,
        (study, file): (Arc<Study>, PathBuf),
        measured: &Bound<'_, PyAny>,
        options: Options,
    ) -> PyResult<Identification> {
        let Options { out, simulations, threads, progress } = options;
        if let Some(simulations) = &simulations {
            check_named("simulations", simulations, "a directory, or None")?;
        }
        let (inferred, _) = Identify::study_of(&study, &file).map_err(Trouble::from)?;
        let measured = MEASURED.given(measured)?;
        let measured_file = match &measured {
            Given::File(file) => file.clone(),
            Given::Arrow(_) | Given::Rows(..) => MEASURED.name.into(),
        };
        let runs = measured_runs(&inferred, measured).map_err(Trouble::from)?;
        if let Some(warning) = implausible_angle(&runs) {
            warn(py, &format!("{}: {warning}", measured_file.display()))?;
        }
        let directory = Directory::new(out)?;
        let bars = Bars::new(py, progress)?;
        let show = bars.show();
        let study_file = file.clone();
        let (identification, warnings) = wait_with(py, &bars, move |stop| {
            let workers = WorkerPool::new(threads).map_err(no_threads)?;
            let identify = Identify {
                study: &study,
                file: &file,
                measured: &measured_file,
                directory: directory.path(),
                simulations,
                workers: &workers,
                stop,
                show,
            };
            let Some(identified) = identify.run(|_| Ok(runs))? else {
                return Err(Trouble::Interrupted);
            };
            let tables = directory.tables(["posterior", "parameter_sets", "fit", "positions"])?;
            let identification = Identification {
                summary: identified.summary,
                in_words: identified.in_words,
                failed_runs: identified.failed_runs,
                tables,
                directory,
            };
            Ok((identification, identified.warnings))
        })??;
        for warning in warnings {
            warn(py, &format!("{}: {warning}", study_file.display()))?;
        }
        Ok(identification)
    }
}
