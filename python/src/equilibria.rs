//! The equilibrium set of a machine, for Python.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use stickslip::analysis::{
    EquilibriumSet as Set, FEWEST_GRID_POINTS, MOST_BALL_DAMPING, REPLICATES, Resolution, RestForm,
    SAMPLE_COUNTS, frictionless_equilibria, reference_amplitude,
};
use stickslip::engine::WorkerPool;
use stickslip::study::Study;
use stickslip::table::{
    FrictionlessRow, MemoryTable, PointKey, SetRow, SetSummaryRow, TableWriter,
    frictionless_columns, in_memory, provenance_with, set_columns, set_summary_columns,
};

use crate::error::{Trouble, no_threads, refused};
use crate::machine::Machine;
use crate::plotting::draw_tables;
use crate::table::Table;
use crate::values::whole;
use crate::waiting::wait;

/// The arguments that are keys of the model, not parameters.
const KEYS: [&str; 3] = ["contact", "friction", "normal_force"];
/// The figures of `stickslip.figures` that show an equilibrium set.
const FIGURES: [&str; 2] = ["equilibrium_set", "equilibrium_surface"];

/// The positions at which the balls of a machine can rest.
#[pyclass(frozen, module = "stickslip")]
pub struct EquilibriumSet {
    summary: MemoryTable,
    positions: Option<MemoryTable>,
    frictionless: MemoryTable,
    fraction: f64,
    components: Option<u64>,
}

#[pymethods]
impl EquilibriumSet {
    /// Fraction of all ball positions that belong to the set, 0 to 1.
    #[getter]
    fn fraction(&self) -> f64 {
        self.fraction
    }

    /// Number of connected components of the set on the torus of ball angles; None for three or
    /// more balls, which are sampled.
    #[getter]
    fn components(&self) -> Option<u64> {
        self.components
    }

    /// One row: fraction with confidence interval, components, amplitudes, balance, as in
    /// ``equilibrium_set_summary.parquet``.
    #[getter]
    fn summary(&self) -> Table {
        Table(self.summary.clone())
    }

    /// One row per ball position: amplitude, required friction, margin, and membership in the set,
    /// as in ``equilibrium_positions.parquet``; None without ``positions``.
    #[getter]
    fn positions(&self) -> Option<Table> {
        self.positions.clone().map(Table)
    }

    /// The frictionless equilibria with their stability, as in ``frictionless_equilibria.parquet``.
    #[getter]
    fn frictionless(&self) -> Table {
        Table(self.frictionless.clone())
    }

    /// Draws a figure of ``stickslip.figures`` and returns it, a figure of matplotlib.
    ///
    /// figure: equilibrium_set or equilibrium_surface.
    /// options: options of the figure, such as ``width="single"``.
    ///
    /// Raises StudyError if there is no such figure, FiguresError, a ValueError, if a table is missing, and
    /// ModuleNotFoundError without matplotlib, numpy and pyarrow.
    #[pyo3(signature = (figure = "equilibrium_set", **options))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        figure: &str,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        draw_tables(slf.as_any(), figure, &FIGURES, options)
    }

    /// The tables from which figures are drawn, by name.
    fn _source<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let tables = PyDict::new(py);
        tables.set_item("equilibrium_set_summary", self.summary())?;
        tables.set_item("frictionless_equilibria", self.frictionless())?;
        if let Some(positions) = self.positions() {
            tables.set_item("equilibrium_positions", positions)?;
        }
        Ok(tables)
    }

    fn __repr__(&self) -> String {
        format!("<stickslip.EquilibriumSet: a fraction of {} of all positions>", self.fraction)
    }
}

/// Computes the equilibrium set of a ball balancer, and its frictionless equilibria, in closed
/// form.
///
/// grid: grid points per axis, at 2π k/grid, for one or two balls; 512 by default.
/// samples: number of quasi-random samples for three or more balls, a power of two; 65536 by
///     default.
/// ball_damping: viscous drag on the balls for the stability of the frictionless equilibria,
///     divided by ball mass and natural frequency; above 0, at most 1e5.
/// positions: whether to compute the table of positions, which is large.
/// threads: number of worker threads, 1 to 1024; one per core by default. Does not change any
///     result.
/// parameters: parameters of the machine with the names and units of a study file, such as
///     ``speed_rad_s=-216.3772``, ``balls=2``, ``friction_coefficient=2.75e-3``; also ``friction``,
///     ``normal_force`` and ``contact``. The defaults are the machine of the thesis.
///
/// Raises StudyError for invalid parameters and options, and TypeError for values of other types.
#[pyfunction]
#[pyo3(signature = (*, grid = None, samples = None, ball_damping = 1e4, positions = true, threads = None, **parameters))]
pub fn equilibrium_set(
    py: Python<'_>,
    grid: Option<&Bound<'_, PyAny>>,
    samples: Option<&Bound<'_, PyAny>>,
    ball_damping: f64,
    positions: bool,
    threads: Option<&Bound<'_, PyAny>>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<EquilibriumSet> {
    let machine = Machine::new("equilibrium_set", "ball_balancer", &KEYS, parameters)?;
    let study = machine.study(json!({"monte_carlo": {"samples": 1}}))?;
    let (grid, samples) = (checked_grid(grid)?, checked_samples(samples)?);
    if !(ball_damping > 0.0 && ball_damping <= MOST_BALL_DAMPING) {
        let allowed = format!("a number above 0, up to {MOST_BALL_DAMPING}");
        return Err(out_of_range("ball_damping", &ball_damping.to_string(), &allowed).into());
    }
    let resolution =
        Resolution::choose(study.model().balls(), grid, samples).map_err(Trouble::Usage)?;
    let workers = WorkerPool::new(crate::threads::threads(threads)?).map_err(no_threads)?;
    let set = move |_: &_| workers.install(|| compute(&study, resolution, ball_damping, positions));
    Ok(wait(py, set)??)
}

fn out_of_range(what: &str, found: &str, allowed: &str) -> Trouble {
    refused(what, "out of range", found, allowed)
}

fn checked_grid(grid: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    let Some(given) = grid else { return Ok(None) };
    let allowed = format!("a whole number from {FEWEST_GRID_POINTS}");
    let given = whole("grid", given, &allowed)?;
    let points = usize::try_from(given).ok().filter(|points| *points >= FEWEST_GRID_POINTS);
    Ok(Some(points.ok_or_else(|| out_of_range("grid", &given.to_string(), &allowed))?))
}

fn checked_samples(samples: Option<&Bound<'_, PyAny>>) -> PyResult<Option<u32>> {
    let Some(given) = samples else { return Ok(None) };
    let [fewest, most] = SAMPLE_COUNTS;
    let allowed = format!("a power of two from {fewest} to {most}");
    let given = whole("samples", given, &allowed)?;
    let fits = |count: &u32| (fewest..=most).contains(count) && count.is_power_of_two();
    let samples = u32::try_from(given).ok().filter(fits);
    Ok(Some(samples.ok_or_else(|| out_of_range("samples", &given.to_string(), &allowed))?))
}

fn compute(
    study: &Study,
    resolution: Resolution,
    damping: f64,
    positions: bool,
) -> Result<EquilibriumSet, Trouble> {
    let unknown = || Trouble::Usage(format!("no model for {} balls", study.model().balls()));
    let point = study.point(0);
    let machine = point.model().ball_balancer().ok_or_else(unknown)?;
    let key = Arc::new(PointKey::of(&point));
    let set = Set::of(machine, resolution).ok_or_else(unknown)?;
    let (fraction, components) = (set.fraction, set.components);
    let (grid, samples) = match resolution {
        Resolution::Grid(points) => (Some(points), None),
        Resolution::Samples(samples) => (None, Some(u64::from(samples) * u64::from(REPLICATES))),
    };
    let options = json!({
        "grid": grid,
        "samples": samples,
        "scrambles": samples.map(|_| REPLICATES),
        "ball_damping": damping,
        "speeds": null,
    });
    let about = |table| provenance_with(study, table, &options);
    let amplitude_without_balls_m = reference_amplitude(machine);
    let row = SetSummaryRow { point: Arc::clone(&key), set, amplitude_without_balls_m };
    let table = || -> Result<MemoryTable, Trouble> {
        let mut table = TableWriter::in_memory(set_columns(study), &about("equilibrium_positions"));
        let form = RestForm::new(machine).ok_or_else(unknown)?;
        resolution.visit(&form, |beta, rest| table.push(SetRow::new(&key, beta, rest)))?;
        Ok(table.finish()?)
    };
    let frictionless = frictionless_equilibria(machine, damping).ok_or_else(unknown)?;
    let speed_rad_s = machine.speed_rad_s;
    let frictionless = frictionless.into_iter().map(|equilibrium| FrictionlessRow {
        point: Arc::clone(&key),
        speed_rad_s,
        equilibrium,
    });
    Ok(EquilibriumSet {
        summary: in_memory(set_summary_columns(study), &about("equilibrium_set_summary"), [row])?,
        positions: positions.then(table).transpose()?,
        frictionless: in_memory(
            frictionless_columns(study, false),
            &about("frictionless_equilibria"),
            frictionless,
        )?,
        fraction,
        components,
    })
}
