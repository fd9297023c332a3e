//! A study, for Python.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use stickslip::cli::check_json;
use stickslip::engine::{Parts, Planned, Progress, WorkerPool};
use stickslip::responses::{check_answerable, respond_to_all, response_columns, run_count};
use stickslip::study::{Study, TableSource};
use stickslip::table::{in_memory, provenance};

use crate::directory::{check_named, check_path};
use crate::error::{Trouble, no_threads, wrong_type};
use crate::given::{Given, Words};
use crate::identification::{Identification, Options};
use crate::json::to_python;
use crate::machine::to_value;
use crate::optimum::Optimum;
use crate::progress::Bars;
use crate::results::Results;
use crate::run::Run;
use crate::table::Table;
use crate::values::directories;
use crate::waiting::{wait, wait_with};

/// What designs are called in messages.
const DESIGNS: Words = Words {
    name: "designs",
    allowed: "a path, a list of dicts, a dict of columns, one design as a dict of values, or an Arrow table or dataframe",
};

/// A study: a model, a sweep, uncertain parameters, start states, and the variables and responses
/// of designs.
///
/// A study is immutable. Create one with ``Study.from_yaml(path)``, ``Study.from_text(text)`` or
/// ``Study.from_dict(keys)``.
/// Studies can be pickled and sent to other processes.
#[pyclass(frozen, name = "Study", module = "stickslip")]
pub struct PyStudy {
    /// The study.
    pub study: Arc<Study>,
    /// Its file, for messages.
    pub file: PathBuf,
}

#[pymethods]
impl PyStudy {
    /// Refuses to create a study and names the functions that do.
    #[new]
    #[pyo3(signature = (*arguments, **named))]
    fn new(arguments: &Bound<'_, PyTuple>, named: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let found = arguments.len() + named.map_or(0, PyDictMethods::len);
        Err(PyTypeError::new_err(format!(
            "Study: no such constructor\n  found:   Study(...) with {found} arguments\n  allowed: Study.from_yaml(path), \
             Study.from_text(text) or Study.from_dict(keys)"
        )))
    }

    /// Reads and validates a study file and the tables that it names.
    ///
    /// path: the study file, YAML.
    /// tables: further directories in which tables of the study may be.
    ///
    /// Raises StudyError for the first fault, also if the file cannot be read.
    #[staticmethod]
    #[pyo3(signature = (path, *, tables = Vec::new()))]
    fn from_yaml(
        py: Python<'_>,
        path: PathBuf,
        #[pyo3(from_py_with = directories)] tables: Vec<PathBuf>,
    ) -> PyResult<Self> {
        check_named("path", &path, "a study file")?;
        let load = move || {
            let study = Study::load_with_tables(&path, &tables)?;
            Ok::<_, Trouble>(PyStudy { study: Arc::new(study), file: path })
        };
        Ok(wait(py, |_| load())??)
    }

    /// Parses and validates a study from the text of a study file.
    ///
    /// text: YAML.
    /// folder: the directory to which paths of tables are relative; the current directory by
    ///     default.
    /// tables: further directories in which tables of the study may be.
    ///
    /// Raises StudyError for the first fault.
    #[staticmethod]
    #[pyo3(signature = (text, *, folder = None, tables = Vec::new()))]
    fn from_text(
        py: Python<'_>,
        text: String,
        folder: Option<PathBuf>,
        #[pyo3(from_py_with = directories)] tables: Vec<PathBuf>,
    ) -> PyResult<Self> {
        let file = folder.unwrap_or_default().join("<text>");
        let read = move || {
            let study = Study::parse_with_tables(&file, text, &tables)?;
            Ok::<_, Trouble>(PyStudy { study: Arc::new(study), file })
        };
        Ok(wait(py, |_| read())??)
    }

    /// Creates and validates a study from a dict with the keys of a study file.
    ///
    /// keys: the study: dicts, lists, numbers, text, booleans and None, and paths of tables.
    /// folder: the directory to which paths of tables are relative; the current directory by default.
    /// tables: further directories in which tables of the study may be.
    ///
    /// Raises StudyError for the first fault, whose ``key`` is the path of the key, such as
    /// ``model.parameters.speed_rad_s``, and TypeError for a value that a study file cannot contain.
    #[staticmethod]
    #[pyo3(signature = (keys, *, folder = None, tables = Vec::new()))]
    fn from_dict(
        py: Python<'_>,
        keys: &Bound<'_, PyAny>,
        folder: Option<PathBuf>,
        #[pyo3(from_py_with = directories)] tables: Vec<PathBuf>,
    ) -> PyResult<Self> {
        let value = to_value("", keys)?;
        if !value.is_object() {
            return Err(wrong_type("keys", keys, "a dict with the keys of a study file"));
        }
        let file = folder.unwrap_or_default().join("<dict>");
        let read = move || {
            let study = Study::from_value(&file, &value, &tables)?;
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

    /// Hash of everything that determines the runs, in hexadecimal.
    #[getter]
    fn hash(&self) -> String {
        self.study.hash()
    }

    /// Number of planned runs; with ``precision``, the largest number.
    #[getter]
    fn run_count(&self) -> u64 {
        self.study.run_count()
    }

    /// Number of points of the sweep; 1 without a sweep.
    #[getter]
    fn point_count(&self) -> u64 {
        self.study.point_count()
    }

    /// Names of the variables of designs, in the order of the study file.
    #[getter]
    fn variables(&self) -> Vec<&str> {
        self.study.variables().iter().map(|variable| variable.name()).collect()
    }

    /// Names of the responses of designs, in the order of the study file.
    #[getter]
    fn responses(&self) -> Vec<&str> {
        self.study.responses().iter().map(|response| response.name.as_str()).collect()
    }

    /// The study file with all defaults and with inline tables, YAML.
    #[getter]
    fn yaml(&self) -> String {
        self.study.resolved_yaml()
    }

    /// Runs the study.
    ///
    /// out: a directory for the result files of ``stickslip run --out``; without it, the tables are
    ///     only in memory. Existing results of the study are continued, and no results are ever
    ///     lost.
    /// threads: number of worker threads, 1 to 1024; one per core by default. Does not change any
    ///     result.
    /// progress: whether to show a progress bar; needs tqdm.
    /// recompute: with ``out``, also run if the directory contains results without a reusable
    ///     run; these results are moved to ``earlier/``.
    ///
    /// Failed runs raise no exception; they are in the tables. Ctrl-C raises KeyboardInterrupt
    /// within a second; with ``out``, finished runs are saved, and the same call resumes the study.
    /// Raises StudyError for invalid arguments, FileExistsError if a directory contains something
    /// else, and OSError if it cannot be used.
    #[pyo3(signature = (out = None, *, threads = None, progress = false, recompute = false))]
    fn run(
        &self,
        py: Python<'_>,
        out: Option<PathBuf>,
        threads: Option<&Bound<'_, PyAny>>,
        progress: bool,
        recompute: bool,
    ) -> PyResult<Results> {
        out.iter().try_for_each(|out| check_path(out))?;
        let study = Arc::clone(&self.study);
        let threads = crate::threads::threads(threads)?;
        let bars = Bars::new(py, progress)?;
        let run = Run { file: self.file.clone(), threads, show: bars.show(), recompute };
        Ok(wait_with(py, &bars, move |stop| match out {
            None => run.in_memory(&study, stop),
            Some(directory) => run.into_directory(&study, directory, stop),
        })??)
    }

    /// Checks the study without computing a run, as ``stickslip check --json`` does.
    ///
    /// existence: whether to add at which points of the sweep stick and slip always have exactly one solution.
    ///
    /// Returns a dict: size, cost, machine with all defaults, closed forms at each point, and ``warnings`` about values
    /// that are probably slips.
    #[pyo3(signature = (*, existence = false))]
    fn check<'py>(&self, py: Python<'py>, existence: bool) -> PyResult<Bound<'py, PyAny>> {
        let study = Arc::clone(&self.study);
        let checked = wait(py, move |_| check_json(&study, existence))?;
        to_python(py, &checked)
    }

    /// Searches for the best design of the study's ``design`` with its ``optimize``, as ``stickslip optimize`` does.
    ///
    /// out: a directory for the files of ``stickslip optimize --out``; without it, the tables are only in memory. The
    ///     same call with the same directory continues a search, also with a larger number of designs.
    /// threads: number of worker threads, 1 to 1024; one per core by default. Does not change any
    ///     result.
    /// progress: whether to show progress bars; needs tqdm.
    ///
    /// Raises StudyError for a study without ``optimize`` and for an objective that does not depend on the design,
    /// FileExistsError if the directory contains something else, OSError if it cannot be used, and KeyboardInterrupt
    /// within a second of Ctrl-C.
    #[pyo3(signature = (out = None, *, threads = None, progress = false))]
    fn optimize(
        &self,
        py: Python<'_>,
        out: Option<PathBuf>,
        threads: Option<&Bound<'_, PyAny>>,
        progress: bool,
    ) -> PyResult<Optimum> {
        let study = (Arc::clone(&self.study), self.file.clone());
        Optimum::search(py, study, out, threads, progress)
    }

    /// Infers the parameters under the study's ``identify`` from measured positions of rest, as ``stickslip identify``
    /// does.
    ///
    /// measured: the measured runs: a CSV or Parquet file, a list of dicts, a dict of columns, or any Arrow table or
    ///     dataframe, with the columns of ``stickslip identify --measured``.
    /// out: a directory for the files of ``stickslip identify --out``; without it, the tables are only in memory. The
    ///     same call with the same directory continues an inference.
    /// simulations: a directory for the ends of simulated runs, which all measurements of one study can share.
    /// threads: number of worker threads, 1 to 1024; one per core by default. Does not change any
    ///     result.
    /// progress: whether to show a progress bar; needs tqdm.
    ///
    /// Raises StudyError for a study without ``identify`` and for invalid measurements, FileExistsError if a directory
    /// contains something else, OSError if it cannot be used, and KeyboardInterrupt within a second of Ctrl-C.
    #[pyo3(signature = (measured, out = None, *, simulations = None, threads = None, progress = false))]
    fn identify(
        &self,
        py: Python<'_>,
        measured: &Bound<'_, PyAny>,
        out: Option<PathBuf>,
        simulations: Option<PathBuf>,
        threads: Option<&Bound<'_, PyAny>>,
        progress: bool,
    ) -> PyResult<Identification> {
        let study = (Arc::clone(&self.study), self.file.clone());
        let threads = crate::threads::threads(threads)?;
        Identification::infer(py, study, measured, Options { out, simulations, threads, progress })
    }

    /// Estimates the study's ``responses`` for designs, each with standard error, confidence
    /// interval and reason.
    ///
    /// designs: a CSV or Parquet file, a list of dicts, a dict of columns, a dict of values (one design), or any Arrow
    ///     table or dataframe (``__arrow_c_stream__``), with a value for each variable of the
    ///     study's ``design``: numbers in the units of the parameters, or names of choices.
    /// threads: number of worker threads, 1 to 1024; one per core by default. Does not change any
    ///     result.
    /// progress: whether to show a progress bar; needs tqdm.
    ///
    /// Returns the table of ``stickslip evaluate``: one row per design and point of the sweep, in
    /// order. Raises StudyError for a study without variables or responses and for invalid designs,
    /// TypeError for values that are neither numbers nor text, and KeyboardInterrupt within a
    /// second of Ctrl-C.
    #[pyo3(signature = (designs, *, threads = None, progress = false))]
    fn evaluate(
        &self,
        py: Python<'_>,
        designs: &Bound<'_, PyAny>,
        threads: Option<&Bound<'_, PyAny>>,
        progress: bool,
    ) -> PyResult<Table> {
        check_answerable(&self.study, &self.file).map_err(Trouble::Usage)?;
        let threads = crate::threads::threads(threads)?;
        let designs = match DESIGNS.given(designs)? {
            Given::File(file) => self.study.designs(&file),
            Given::Arrow(reader) => {
                self.study.designs(TableSource::Arrow(DESIGNS.name, Box::new(reader)))
            }
            Given::Rows(columns, rows) => {
                self.study.designs(TableSource::Rows(DESIGNS.name, columns, rows))
            }
        };
        let designs = designs.map_err(Trouble::from)?;
        let study = Arc::clone(&self.study);
        let bars = Bars::new(py, progress)?;
        let show = bars.show();
        let table = wait_with(py, &bars, move |stop| {
            let workers = WorkerPool::new(threads).map_err(no_threads)?;
            let runs = run_count(&study, &designs).map_err(Trouble::Usage)?;
            let parts = Parts::Designs(designs.len() as u64);
            let planned = Planned { study: study.name(), runs, at_most: false, parts };
            let progress = Progress::begin(planned, show);
            let finished = |label| progress.finished(label);
            let answers = respond_to_all(&workers, &study, &designs, stop, &finished);
            progress.close();
            // After an interruption there are no answers, and the empty table is discarded.
            let answers = answers.map_err(Trouble::Usage)?.unwrap_or_default();
            let about = provenance(&study, "responses");
            Ok::<_, Trouble>(in_memory(response_columns(&study), &about, answers)?)
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

/// Returns the equations of a system file in a folder in LaTeX; nothing for a file with a fault.
#[pyfunction]
pub fn _latex(text: &str, folder: PathBuf) -> Option<String> {
    stickslip::study::system_in_latex(text, &folder)
}

/// Creates a study from its resolved study file.
#[pyfunction]
pub fn _unpickle(text: String) -> PyResult<PyStudy> {
    let file = PathBuf::from("<pickled>");
    let study = Study::parse(Path::new(&file), text).map_err(Trouble::from)?;
    Ok(PyStudy { study: Arc::new(study), file })
}
