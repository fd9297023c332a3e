//! The results of a study: its tables, in memory or in a directory.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, OnceLock};

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::classification::Label;
use stickslip::cli::{MOST_LINES, PointsTable};
use stickslip::engine::{ReadableResults, readable_results, results_study};
use stickslip::report::{Replay, ResultTables, printed_figures_of, write_report};
use stickslip::study::Study;
use stickslip::table::{self, Manifest, MemoryTable, table_names};

use crate::directory::{check_named, check_page};
use crate::error::{Trouble, refused};
use crate::plotting::{draw, json_of};
use crate::simulation::{Simulation, times};
use crate::study::PyStudy;
use crate::table::Table;
use crate::values::whole;
use crate::waiting::wait;

/// Opens a directory of results, finished or not, such as ``stickslip run`` writes.
///
/// directory: the directory. While the study is running, and after it was killed, its finished runs are the results.
///
/// Changes nothing in the directory. Raises StudyError if the directory or its study.yaml holds no results of this
/// version, FileExistsError if it holds something else, and OSError if a file is damaged.
#[pyfunction]
#[pyo3(signature = (directory))]
pub fn open(py: Python<'_>, directory: PathBuf) -> PyResult<Results> {
    check_named("directory", &directory, "a directory, \".\" for the current one")?;
    let open = move |_: &AtomicBool| {
        let found = readable_results(&directory)?;
        Ok::<_, Trouble>(Results::of_directory(directory, found))
    };
    Ok(wait(py, open)??)
}

/// The tables of a study, and the number of runs per label.
///
/// If the study ran into a directory, each table is read on first access. A table that exceeds the
/// memory can be read in part: ``polars.scan_parquet(f"{results.directory}/runs.parquet")``.
#[pyclass(frozen, module = "stickslip")]
pub struct Results {
    study: Arc<Study>,
    file: PathBuf,
    manifest: Manifest,
    place: Option<Place>,
    /// The tables by name.
    tables: Vec<(&'static str, OnceLock<MemoryTable>)>,
    /// The points in Markdown.
    summary: OnceLock<String>,
}

/// Where results are on disk.
#[derive(Clone)]
struct Place {
    directory: PathBuf,
    /// The tables, in the directory or in a temporary one.
    readable: Arc<ReadableResults>,
}

#[pymethods]
impl Results {
    /// One row per run, including failed runs: parameters, start state, label, evidence, final
    /// position.
    #[getter]
    fn runs(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, "runs")
    }

    /// One row per point of the sweep: counts, fractions with confidence intervals, times to rest,
    /// amplitudes.
    #[getter]
    fn points(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, "points")
    }

    /// The probability of being at rest over time with confidence intervals, per point.
    #[getter]
    fn time_to_rest(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, "time_to_rest")
    }

    /// The limit cycles by class, per point.
    #[getter]
    fn cycles(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, "cycles")
    }

    /// The equilibria of the runs that came to rest.
    #[getter]
    fn equilibria(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, "equilibria")
    }

    /// The number of equilibria in each part of the ring.
    #[getter]
    fn equilibrium_histogram(&self, py: Python<'_>) -> PyResult<Table> {
        self.table(py, "equilibrium_histogram")
    }

    /// One row per run and stage of a disc that starts or a table that is kicked: the speeds of disc and balls, and the
    /// largest displacement of the table. None for a study without stages.
    #[getter]
    fn stages(&self, py: Python<'_>) -> PyResult<Option<Table>> {
        self.study.has_stages().then(|| self.table(py, "stages")).transpose()
    }

    /// The points in Markdown, as ``stickslip summary --markdown`` prints them: the most important columns in the units of
    /// the study, the responses, and the conclusion in words. A notebook shows it for results.
    fn summary(&self, py: Python<'_>) -> PyResult<String> {
        if let (None, Some(place)) = (self.summary.get(), &self.place) {
            let readable = Arc::clone(&place.readable);
            let read = move |_: &AtomicBool| {
                let ReadableResults { tables, manifest, study, .. } = &*readable;
                let points = table::Table::open(tables, manifest, "points")?;
                Ok::<_, Trouble>(PointsTable::read(study, &points, MOST_LINES)?.markdown())
            };
            let text = wait(py, read)??;
            return Ok(self.summary.get_or_init(|| text).clone());
        }
        Ok(self.summary.get().cloned().unwrap_or_default())
    }

    fn _repr_markdown_(&self, py: Python<'_>) -> PyResult<String> {
        self.summary(py)
    }

    /// Number of runs by label: equilibrium, limit_cycle, periodic, creep, quasi_periodic, irregular, undecided, failed.
    #[getter]
    fn labels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let labels = PyDict::new(py);
        for (label, runs) in self.runs_by_label() {
            labels.set_item(label, runs)?;
        }
        Ok(labels)
    }

    /// The directory of the results; None if they are only in memory.
    #[getter]
    fn directory(&self) -> Option<&Path> {
        self.place.as_ref().map(|place| place.directory.as_path())
    }

    /// Whether all planned runs are finished.
    #[getter]
    fn complete(&self) -> bool {
        self.manifest.complete
    }

    /// The study.
    #[getter]
    fn study(&self) -> PyStudy {
        PyStudy { study: Arc::clone(&self.study), file: self.file.clone() }
    }

    /// Computes one run again with its motion, as ``stickslip replay`` does, and compares it with its stored row.
    ///
    /// run_id: the number of the run, column ``run_id`` of ``runs``.
    /// times_s: times of the motion, s, in ascending order; by default, the end of every integration step, and the
    ///     instants just before and after each switch. ``left_out_times_s`` of the result names the times without motion.
    /// out: a new directory for the tables of the motion and its animation; without it, they are only in memory.
    ///
    /// The attribute ``differences`` of the result lists the columns in which the run differs from its stored row. It is
    /// None for results that are only in memory, and for a run that is not finished yet. Raises StudyError if there is no
    /// such run.
    #[pyo3(signature = (run_id, *, times_s = None, out = None))]
    fn replay(
        &self,
        py: Python<'_>,
        run_id: &Bound<'_, PyAny>,
        times_s: Option<&Bound<'_, PyAny>>,
        out: Option<PathBuf>,
    ) -> PyResult<Simulation> {
        let run_id = number_of_run(&self.study, run_id)?;
        let times_s = times_s.map(times).transpose()?;
        if let Some(out) = &out {
            check_named("out", out, "a new directory, or None for tables in memory")?;
        }
        let (study, place) = (Arc::clone(&self.study), self.place.clone());
        Ok(wait(py, move |_| {
            out.iter().try_for_each(|out| Replay::inspect(out))?;
            let replay = match &place {
                Some(Place { directory, .. }) => {
                    let (study, manifest) = results_study(directory)?;
                    Replay::of_directory(directory, (&study, &manifest), run_id, times_s)?
                }
                None => Replay::of_study(&study, run_id, times_s)?,
            };
            if let Some(out) = out {
                replay.write(&study, &out)?;
            }
            Simulation::new(&study, replay)
        })??)
    }

    /// Writes the HTML page of ``stickslip report`` and returns its path.
    ///
    /// out: the page; by default, the name of the directory with ``-report.html``. Only an unchanged earlier page is
    ///     overwritten.
    ///
    /// Raises StudyError for results that are only in memory, FileExistsError if another file has this name, and
    /// OSError if it cannot be written.
    #[pyo3(signature = (out = None))]
    fn report(&self, py: Python<'_>, out: Option<PathBuf>) -> PyResult<PathBuf> {
        let Some(Place { directory, .. }) = self.place.clone() else {
            let text = "report: these results have no directory\n  found:   results in memory\n  allowed: results of \
                        study.run(directory) or stickslip.open(directory)";
            return Err(Trouble::Usage(text.to_owned()).into());
        };
        check_page(out.as_deref())?;
        let write = move |_: &_| Ok::<_, Trouble>(write_report(&directory, out.as_deref())?);
        Ok(wait(py, write)??)
    }

    /// Draws a figure of ``stickslip.figures`` and returns it, a figure of matplotlib.
    ///
    /// figure: a figure of the page of ``stickslip report``, such as time-to-rest, vibration, preferred-equilibria or
    ///     basins; ``stickslip.figures.names(results)`` lists those that these results have.
    /// options: ``width="single"`` or ``"double"``, ``points=[0, 3]``, and ``sheet=2`` of a figure with many panels.
    ///
    /// Raises FiguresError, a ValueError, if these results have no such figure, StudyError if they have no such point, and
    /// ModuleNotFoundError without matplotlib, numpy and pyarrow.
    #[pyo3(signature = (figure = "time-to-rest", **options))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        figure: &str,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        draw(slf.as_any(), figure, options)
    }

    /// The figures of these points, or of all points, as JSON that ``stickslip.figures`` draws.
    #[pyo3(signature = (points = None))]
    fn _figures(&self, py: Python<'_>, points: Option<Vec<u64>>) -> PyResult<String> {
        let (study, manifest) = (Arc::clone(&self.study), self.manifest.clone());
        let held = |name: &str| self.slot(name)?.get().cloned();
        let tables = match &self.place {
            Some(Place { readable, .. }) => ResultTables::open(&readable.tables, &manifest),
            None => ResultTables::in_memory(held),
        };
        let tables = tables.map_err(Trouble::from)?;
        let read = move |_: &AtomicBool| {
            let figures = printed_figures_of(&tables, (&study, &manifest), points.as_deref())?;
            json_of(&figures)
        };
        Ok(wait(py, read)??)
    }

    /// Pickles results as their directory, which the other process opens.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (PathBuf,))> {
        let Some(Place { directory, .. }) = &self.place else {
            let text = "these results cannot be pickled\n  found:   results in memory\n  allowed: results of \
                        study.run(directory) or stickslip.open(directory), or a table as a dict or dataframe";
            return Err(PyTypeError::new_err(text));
        };
        let open = py.import("stickslip")?.getattr("open")?;
        Ok((open, (std::path::absolute(directory)?,)))
    }

    fn __repr__(&self) -> String {
        let labels = self.runs_by_label().filter(|(_, runs)| *runs > 0);
        let labels: Vec<String> = labels.map(|(label, runs)| format!("{runs} {label}")).collect();
        let finished: u64 = self.runs_by_label().map(|(_, runs)| runs).sum();
        let (name, points) = (self.study.name(), self.study.point_count());
        let missing = match self.manifest.complete {
            true => String::new(),
            false => format!(" of at most {}, not complete", self.study.run_count()),
        };
        let place = match &self.place {
            Some(place) => format!("in {}", place.directory.display()),
            None => "in memory".to_owned(),
        };
        let labels = labels.join(", ");
        format!(
            "<stickslip.Results of {name}, {place}: {finished} runs{missing}, {points} points; {labels}>"
        )
    }
}

/// Returns the number of a run if the study has it.
fn number_of_run(study: &Study, run_id: &Bound<'_, PyAny>) -> PyResult<u64> {
    let runs = study.run_count();
    let allowed = format!(
        "a whole number from 0 to {}, a value of the column run_id",
        runs.saturating_sub(1)
    );
    let given = whole("run_id", run_id, &allowed)?;
    let known = u64::try_from(given).ok().filter(|run| *run < runs);
    known.ok_or_else(|| {
        let found = format!("run {given} of a study with {runs} runs");
        refused("run_id", "there is no such run", &found, &allowed).into()
    })
}

impl Results {
    /// Holds tables in memory.
    pub fn in_memory(
        (study, file): (Arc<Study>, PathBuf),
        manifest: Manifest,
        tables: Vec<MemoryTable>,
        summary: String,
    ) -> Self {
        let tables = tables.into_iter().map(OnceLock::from);
        Results {
            tables: table_names(&study).zip(tables).collect(),
            study,
            file,
            manifest,
            place: None,
            summary: OnceLock::from(summary),
        }
    }

    /// Refers to the tables of a directory.
    pub fn of_directory(directory: PathBuf, readable: ReadableResults) -> Self {
        let study = Arc::new(readable.study.clone());
        Results {
            file: directory.join("study.yaml"),
            manifest: readable.manifest.clone(),
            tables: table_names(&study).map(|name| (name, OnceLock::new())).collect(),
            summary: OnceLock::new(),
            study,
            place: Some(Place { directory, readable: Arc::new(readable) }),
        }
    }

    fn slot(&self, name: &str) -> Option<&OnceLock<MemoryTable>> {
        self.tables.iter().find(|(other, _)| *other == name).map(|(_, slot)| slot)
    }

    /// Returns the number of runs of each label, in the order of the labels.
    fn runs_by_label(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let runs = |label: &Label| self.manifest.labels.get(label.name()).copied().unwrap_or(0);
        Label::ALL.iter().map(move |label| (label.name(), runs(label)))
    }

    /// Returns a table, which is read on the first access.
    fn table(&self, py: Python<'_>, name: &'static str) -> PyResult<Table> {
        let defect = || Trouble::Defect("a defect of stickslip: no table".to_owned());
        let slot = self.slot(name).ok_or_else(defect)?;
        if let Some(table) = slot.get() {
            return Ok(Table(table.clone()));
        }
        let Place { readable, .. } = self.place.clone().ok_or_else(defect)?;
        let read = move |_: &AtomicBool| {
            let ReadableResults { tables, manifest, .. } = &*readable;
            Ok::<_, Trouble>(table::Table::open(tables, manifest, name)?.in_memory()?)
        };
        let table = wait(py, read)??;
        Ok(Table(slot.get_or_init(|| table).clone()))
    }
}
