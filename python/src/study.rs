//! A study, for Python.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::prelude::*;
use stickslip::engine::{Planned, Progress, Show, WorkerPool};
use stickslip::responses::{check_answerable, respond_to_all, response_columns, run_count};
use stickslip::study::Study;
use stickslip::table::{in_memory, provenance};

use crate::error::{Trouble, no_threads};
use crate::results::{Results, Run};
use crate::table::Table;
use crate::waiting::wait;

/// A study: a machine, what is swept, drawn and sampled, what designs vary and what they are asked for.
///
/// It never changes. Make one with ``Study.from_yaml(path)`` or ``Study.from_text(text)``. It can be pickled,
/// and sent to other processes.
#[pyclass(frozen, name = "Study", module = "stickslip")]
pub struct PyStudy {
    study: Arc<Study>,
    file: PathBuf,
}

#[pymethods]
impl PyStudy {
    /// Reads a study file and the tables that it names, and checks everything.
    ///
    /// path: the study file, YAML.
    /// tables: directories in which tables of the study may lie as well as beside the study file.
    ///
    /// Raises StudyError with the first thing that is wrong, also where the file cannot be read.
    #[staticmethod]
    #[pyo3(signature = (path, *, tables = Vec::new()))]
    fn from_yaml(py: Python<'_>, path: PathBuf, tables: Vec<PathBuf>) -> PyResult<Self> {
        let load = move || {
            let study = Study::load_with_tables(&path, &tables)?;
            Ok::<_, Trouble>(PyStudy { study: Arc::new(study), file: path })
        };
        Ok(wait(py, |_| load())??)
    }

    /// Reads a study from the text of a study file.
    ///
    /// text: YAML.
    /// folder: the directory that paths of the study's tables are relative to; the current one by default.
    /// tables: directories in which tables of the study may lie as well as in that one.
    ///
    /// Raises StudyError with the first thing that is wrong.
    #[staticmethod]
    #[pyo3(signature = (text, *, folder = None, tables = Vec::new()))]
    fn from_text(
        py: Python<'_>,
        text: String,
        folder: Option<PathBuf>,
        tables: Vec<PathBuf>,
    ) -> PyResult<Self> {
        let file = folder.unwrap_or_default().join("<text>");
        let read = move || {
            let study = Study::parse_with_tables(&file, text, &tables)?;
            Ok::<_, Trouble>(PyStudy { study: Arc::new(study), file })
        };
        Ok(wait(py, |_| read())??)
    }

    /// Name of the study.
    #[getter]
    fn name(&self) -> &str {
        self.study.name()
    }

    /// Seed of every random number.
    #[getter]
    fn seed(&self) -> u64 {
        self.study.seed()
    }

    /// Hash of all that decides the runs, hexadecimal.
    #[getter]
    fn hash(&self) -> String {
        self.study.hash()
    }

    /// Number of planned runs; with ``precision``, the most.
    #[getter]
    fn run_count(&self) -> u64 {
        self.study.run_count()
    }

    /// Number of points of the sweep; 1 where nothing is swept.
    #[getter]
    fn point_count(&self) -> u64 {
        self.study.point_count()
    }

    /// Names of what designs vary, in the order of the study file.
    #[getter]
    fn variables(&self) -> Vec<&str> {
        self.study.variables().iter().map(|variable| variable.name()).collect()
    }

    /// Names of the responses that designs are asked for, in the order of the study file.
    #[getter]
    fn responses(&self) -> Vec<&str> {
        self.study.responses().iter().map(|response| response.name.as_str()).collect()
    }

    /// The study file with all defaults filled in and tables written out, YAML.
    #[getter]
    fn yaml(&self) -> String {
        self.study.resolved_yaml()
    }

    /// Runs the study.
    ///
    /// out: a directory, in which the program's files are made as ``stickslip run --out`` makes them; without it
    ///     the tables are in memory only. Results that are there are gone on with, and nothing is ever lost.
    /// threads: worker threads, from 1 to 1024; one per core by default. They change no result.
    /// progress: whether progress is shown on standard error.
    /// recompute: with ``out``, run into a directory with the results of another study of which no run can be
    ///     used; what is there is moved to ``earlier/``.
    ///
    /// Failed runs are in the tables, and no exception. Raises KeyboardInterrupt within a second of Ctrl-C;
    /// with ``out``, finished runs are kept, and the same call goes on. Raises StudyError for arguments that
    /// make no sense, FileExistsError where a directory holds something else, OSError where it cannot be used.
    #[pyo3(signature = (out = None, *, threads = None, progress = false, recompute = false))]
    fn run(
        &self,
        py: Python<'_>,
        out: Option<PathBuf>,
        threads: Option<i64>,
        progress: bool,
        recompute: bool,
    ) -> PyResult<Results> {
        if out.as_ref().is_some_and(|out| out.as_os_str().is_empty()) {
            let problem = "out: an empty path\n  found:   \"\"\n  allowed: a directory, \".\" for the current one; None \
                           for tables in memory";
            return Err(Trouble::Usage(problem.to_owned()).into());
        }
        let study = Arc::clone(&self.study);
        let run =
            Run { threads: crate::threads::threads(threads)?, show: show(progress), recompute };
        Ok(wait(py, move |stop| match out {
            None => run.in_memory(&study, stop),
            Some(directory) => run.into_directory(&study, directory, stop),
        })??)
    }

    /// Answers the study's ``responses`` at designs, each with standard error, interval and reason.
    ///
    /// designs: a list of dicts, a dict of columns, a dict of values (one design), or any Arrow table or
    ///     dataframe (``__arrow_c_stream__``), with a value for each of the study's ``design``: numbers in the
    ///     units of the parameters, names of choices.
    /// threads: worker threads, from 1 to 1024; one per core by default. They change no result.
    /// progress: whether progress is shown on standard error.
    ///
    /// Returns the table that ``stickslip evaluate`` writes: one row per design and point of the sweep, in
    /// order. Raises StudyError for a study that asks for nothing or varies nothing, and for designs that it
    /// does not have; TypeError for what is neither number nor text; KeyboardInterrupt within a second of
    /// Ctrl-C.
    #[pyo3(signature = (designs, *, threads = None, progress = false))]
    fn evaluate(
        &self,
        py: Python<'_>,
        designs: &Bound<'_, PyAny>,
        threads: Option<i64>,
        progress: bool,
    ) -> PyResult<Table> {
        check_answerable(&self.study, &self.file).map_err(Trouble::Usage)?;
        let threads = crate::threads::threads(threads)?;
        let designs = crate::designs::designs(&self.study, designs)?;
        let study = Arc::clone(&self.study);
        let table = wait(py, move |stop| {
            let workers = WorkerPool::new(threads).map_err(no_threads)?;
            let runs = run_count(&study, &designs).map_err(Trouble::Usage)?;
            let points = designs.len() as u64 * study.point_count();
            let planned = Planned { study: study.name(), runs, at_most: false, points };
            let progress = Progress::begin(planned, show(progress));
            let finished = |label| progress.finished(label);
            let answers = respond_to_all(&workers, &study, &designs, stop, &finished);
            progress.close();
            // None where it was interrupted, and then nobody takes the table.
            let answers = answers.map_err(Trouble::Usage)?.unwrap_or_default();
            let about = provenance(&study, "responses");
            Ok::<_, Trouble>(in_memory(response_columns(&study), about, answers)?)
        })??;
        Ok(Table(table))
    }

    fn __repr__(&self) -> String {
        let (name, runs) = (self.study.name(), self.study.run_count());
        format!("<stickslip.Study {name}: {runs} runs, {} points>", self.study.point_count())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let unpickle = py.import("stickslip._stickslip")?.getattr("_unpickle")?;
        Ok((unpickle, (self.study.resolved_yaml(),)))
    }
}

/// A study from its file with all defaults filled in.
#[pyfunction]
pub fn _unpickle(text: String) -> PyResult<PyStudy> {
    let file = PathBuf::from("<pickled>");
    let study = Study::parse(Path::new(&file), text).map_err(Trouble::from)?;
    Ok(PyStudy { study: Arc::new(study), file })
}

/// How progress is shown, if it is.
fn show(progress: bool) -> Show {
    if progress { Show::auto() } else { Show::Nothing }
}
