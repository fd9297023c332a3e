//! The result of an optimisation, for Python.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;
use stickslip::engine::WorkerPool;
use stickslip::optimize::Optimize;
use stickslip::report::{printed_figures, write_report};
use stickslip::study::Study;
use stickslip::table::MemoryTable;

use crate::directory::{Directory, check_page};
use crate::error::{Trouble, no_threads};
use crate::json::to_python;
use crate::plotting::{draw, json_of};
use crate::progress::Bars;
use crate::table::Table;
use crate::waiting::{wait, wait_with};

/// The best design of a study, and the search for it.
#[pyclass(frozen, module = "stickslip")]
pub struct Optimum {
    summary: Value,
    in_words: String,
    unmet: Option<Vec<String>>,
    failed_runs: u64,
    evaluations: MemoryTable,
    finalists: MemoryTable,
    sensitivities: MemoryTable,
    pareto: Option<MemoryTable>,
    directory: Arc<Directory>,
}

#[pymethods]
impl Optimum {
    /// The content of ``optimum.json``: the best design with its responses, the reference, notes and Sobol' indices.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.summary)
    }

    /// The limits that the nearest design does not meet, in words; None if a design meets all limits.
    #[getter]
    fn unmet_limits(&self) -> Option<Vec<String>> {
        self.unmet.clone()
    }

    /// Number of failed runs; amplitudes and times exclude them.
    #[getter]
    fn failed_runs(&self) -> u64 {
        self.failed_runs
    }

    /// One row per evaluated design and point, as in ``evaluations.parquet``.
    #[getter]
    fn evaluations(&self) -> Table {
        Table(self.evaluations.clone())
    }

    /// The best designs, computed again with independent runs, as in ``finalists.parquet``.
    #[getter]
    fn finalists(&self) -> Table {
        Table(self.finalists.clone())
    }

    /// Sobol' indices, as in ``sensitivities.parquet``.
    #[getter]
    fn sensitivities(&self) -> Table {
        Table(self.sensitivities.clone())
    }

    /// The designs of the Pareto front, as in ``pareto.parquet``; None with one objective.
    #[getter]
    fn pareto(&self) -> Option<Table> {
        self.pareto.clone().map(Table)
    }

    /// The directory of the files; None without ``out``.
    #[getter]
    fn directory(&self) -> Option<&Path> {
        self.directory.named()
    }

    /// Writes the HTML page of ``stickslip report`` and returns its path.
    ///
    /// out: the page; by default, the name of the directory with ``-report.html``. Only an unchanged earlier page is
    ///     overwritten.
    ///
    /// Raises StudyError without ``out`` if the search has no directory of the user, FileExistsError if another file has
    /// this name, and OSError if it cannot be written.
    #[pyo3(signature = (out = None))]
    fn report(&self, py: Python<'_>, out: Option<PathBuf>) -> PyResult<PathBuf> {
        if out.is_none() && self.directory.named().is_none() {
            let text = "out: no name for the page\n  found:   None\n  allowed: a path, because this search has no directory of \
                        its own";
            return Err(Trouble::Usage(text.to_owned()).into());
        }
        check_page(out.as_deref())?;
        let directory = Arc::clone(&self.directory);
        let write = move |_: &_| Ok::<_, Trouble>(write_report(directory.path(), out.as_deref())?);
        Ok(wait(py, write)??)
    }

    /// Draws a figure of the search and returns it, a figure of matplotlib.
    ///
    /// figure: a figure of the page of ``stickslip report``, such as convergence, pareto-front or parallel-coordinates;
    ///     ``stickslip.figures.names(optimum)`` lists those of this search.
    /// options: ``width="single"`` or ``"double"``, and ``sheet=2`` of a figure with many panels.
    ///
    /// Raises FiguresError, a ValueError, if the search has no such figure, and ModuleNotFoundError without matplotlib,
    /// numpy and pyarrow.
    #[pyo3(signature = (figure = "convergence", **options))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        figure: &str,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        draw(slf.as_any(), figure, options)
    }

    /// The figures of the search as JSON that ``stickslip.figures`` draws; a search has no points to choose.
    #[pyo3(signature = (points = None))]
    fn _figures(&self, py: Python<'_>, points: Option<Vec<u64>>) -> PyResult<String> {
        let directory = Arc::clone(&self.directory);
        let read = move |_: &_| json_of(&printed_figures(directory.path(), points.as_deref())?);
        Ok(wait(py, read)??)
    }

    fn __repr__(&self) -> String {
        format!(
            "<stickslip.Optimum after {} designs>\n{}",
            self.designs(),
            self.in_words.trim_end()
        )
    }
}

impl Optimum {
    fn designs(&self) -> u64 {
        self.summary["search"]["designs"].as_u64().unwrap_or(0)
    }

    /// Searches for the best design of a study.
    ///
    /// # Errors
    /// Returns the errors of the search, and the exception of a signal handler.
    pub fn search(
        py: Python<'_>,
        (study, file): (Arc<Study>, PathBuf),
        out: Option<PathBuf>,
        threads: Option<&Bound<'_, PyAny>>,
        progress: bool,
    ) -> PyResult<Optimum> {
        let threads = crate::threads::threads(threads)?;
        let directory = Directory::new(out)?;
        let bars = Bars::new(py, progress)?;
        let show = bars.show();
        Ok(wait_with(py, &bars, move |stop| {
            let workers = WorkerPool::new(threads).map_err(no_threads)?;
            let optimize = Optimize {
                study: &study,
                file: &file,
                directory: directory.path(),
                workers: &workers,
                stop,
                show,
                quiet: true,
            };
            let Some(optimized) = optimize.run()? else { return Err(Trouble::Interrupted) };
            let names = ["evaluations", "finalists", "sensitivities"];
            let [evaluations, finalists, sensitivities] = directory.tables(names)?;
            let has_front = study.optimization().is_some_and(|goal| goal.objectives.len() > 1);
            let front = || directory.tables(["pareto"]).map(|[table]| table);
            Ok(Optimum {
                summary: optimized.summary,
                in_words: optimized.in_words,
                unmet: optimized.unmet,
                failed_runs: optimized.failed_runs,
                evaluations,
                finalists,
                sensitivities,
                pareto: has_front.then(front).transpose()?,
                directory: Arc::new(directory),
            })
        })??)
    }
}
