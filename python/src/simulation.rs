//! One run of one machine with its motion, for Python.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};
use serde_json::{Value, json};
use stickslip::report::{MOST_INSTANTS, Replay};
use stickslip::study::Study;
use stickslip::table::{
    Difference, MemoryTable, in_memory, provenance, provenance_with, run_columns, switch_columns,
    touch_columns, trajectory_columns,
};

use crate::error::{Trouble, refused, wrong_type};
use crate::machine::{Machine, to_value};
use crate::plotting::draw_tables;
use crate::table::Table;
use crate::values::{is_text, items, number, plain};
use crate::waiting::wait;

/// The arguments that are keys of the model, not parameters.
const KEYS: [&str; 6] =
    ["contact", "disturbances", "friction", "normal_force", "protocol", "speed_profile"];
/// The latest time that may be requested, s.
const LATEST_S: f64 = 1e12;

/// One run and its motion.
#[pyclass(frozen, module = "stickslip")]
pub struct Simulation {
    label: &'static str,
    evidence: &'static str,
    end_time_s: Option<f64>,
    left_out_times_s: Vec<f64>,
    differences: Option<Vec<Difference>>,
    run: MemoryTable,
    trajectory: MemoryTable,
    switches: MemoryTable,
    touches: Option<MemoryTable>,
}

#[pymethods]
impl Simulation {
    /// Label of the run: equilibrium, limit_cycle, periodic, creep, quasi_periodic, irregular, undecided or failed.
    #[getter]
    fn label(&self) -> &str {
        self.label
    }

    /// Evidence for the label, or the kind of failure.
    #[getter]
    fn evidence(&self) -> &str {
        self.evidence
    }

    /// The end of the run, s: the time at which its ending is known, or the end of the simulation. None if it did not
    /// start.
    #[getter]
    fn end_time_s(&self) -> Option<f64> {
        self.end_time_s
    }

    /// The requested times, s, that ``trajectory`` leaves out because they are after the end of the run.
    #[getter]
    fn left_out_times_s(&self) -> Vec<f64> {
        self.left_out_times_s.clone()
    }

    /// The columns in which a replay differs from its stored row, each with the keys ``column``, ``row`` and ``replay``;
    /// empty if the run is the same to the last bit, and None if there is no stored row to compare.
    #[getter]
    fn differences<'py>(&self, py: Python<'py>) -> PyResult<Option<Vec<Bound<'py, PyDict>>>> {
        let dict = |one: &Difference| {
            let dict = PyDict::new(py);
            dict.set_item("column", &one.column)?;
            dict.set_item("row", &one.stored)?;
            dict.set_item("replay", &one.replayed)?;
            Ok(dict)
        };
        self.differences.as_ref().map(|all| all.iter().map(dict).collect()).transpose()
    }

    /// One row with the columns of ``runs.parquet``.
    #[getter]
    fn run(&self) -> Table {
        Table(self.run.clone())
    }

    /// One row per instant: table, angles, speeds, stick or slip, friction force and its limit, gaps between balls with
    /// contact.
    #[getter]
    fn trajectory(&self) -> Table {
        Table(self.trajectory.clone())
    }

    /// One row per change between stick and slip.
    #[getter]
    fn switches(&self) -> Table {
        Table(self.switches.clone())
    }

    /// One row per impact between two balls and per end of lasting contact; None without contact between balls.
    #[getter]
    fn touches(&self) -> Option<Table> {
        self.touches.clone().map(Table)
    }

    /// Draws the figure ``stickslip.figures.motion`` with its options, such as ``width="single"``.
    ///
    /// Raises ModuleNotFoundError without matplotlib, numpy and pyarrow.
    #[pyo3(signature = (**options))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        draw_tables(slf.as_any(), "motion", &["motion"], options)
    }

    /// The tables from which figures are drawn, by name.
    fn _source<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let tables = PyDict::new(py);
        tables.set_item("trajectory", self.trajectory())?;
        tables.set_item("switches", self.switches())?;
        if let Some(touches) = self.touches() {
            tables.set_item("touches", touches)?;
        }
        Ok(tables)
    }

    fn __repr__(&self) -> String {
        let Simulation { label, evidence, .. } = self;
        let (instants, left_out) = (self.trajectory.rows(), self.left_out_times_s.len());
        let end = self.end_time_s.map_or_else(String::new, |end| format!(" at {end:.6} s"));
        let left_out = match left_out {
            0 => String::new(),
            1 => "; 1 time after the end is left out".to_owned(),
            more => format!("; {more} times after the end are left out"),
        };
        format!("<stickslip.Simulation: {label} ({evidence}){end}, {instants} instants{left_out}>")
    }
}

impl Simulation {
    /// Holds a run that has been computed with its motion.
    ///
    /// # Errors
    /// Returns an error only for a defect.
    pub fn new(study: &Study, replay: Replay) -> Result<Self, Trouble> {
        let left_out_times_s = replay.times_after_end_s().to_vec();
        let options = replay.options();
        let Replay { record, recording, differences, .. } = replay;
        // Impossible parameters have no units; the motion is empty then.
        let model = record.planned.case.as_ref().map_or(study.model(), |case| &case.model);
        let gaps = model.gaps(&record.planned.start);
        let touches = gaps.is_some().then_some(recording.touches);
        let about = |table| provenance_with(study, table, &options);
        let trajectory = in_memory(
            trajectory_columns(model, gaps.as_deref().unwrap_or_default()),
            &about("trajectory"),
            recording.samples,
        )?;
        let switches = in_memory(switch_columns(model), &about("switches"), recording.switches)?;
        let in_table = |touches| in_memory(touch_columns(model), &about("touches"), touches);
        let touches = touches.map(in_table).transpose()?;
        Ok(Simulation {
            label: record.outcome.label().name(),
            evidence: record.outcome.evidence.name(),
            end_time_s: record.outcome.end_time_s,
            left_out_times_s,
            differences,
            trajectory,
            switches,
            touches,
            run: in_memory(run_columns(study), &provenance(study, "runs"), [record])?,
        })
    }
}

/// Simulates one run of one machine and returns its motion.
///
/// start: start state with the names of ``initial_conditions`` in a study file: for a ball balancer
///     ``x``, ``y``, ``beta_1``, ..., ``x_dot``, ``y_dot``, ``beta_dot_1``, ..., non-dimensional;
///     for a block ``position_m`` and ``velocity_m_s``. The defaults are 0.
/// times_s: times of the motion, s, in ascending order; by default, the end of every integration
///     step, and the instants just before and after each switch. A run ends when its ending is known; there is no motion
///     after it, and ``left_out_times_s`` of the result has these times. Switches and impacts are complete in any case.
/// model: ball_balancer, block_on_spring or block_on_belt.
/// simulation: settings of the simulation with the keys of a study file, such as ``{"end_time_s":
///     33}``.
/// parameters: parameters of the machine with the names and units of a study file, such as
///     ``speed_rad_s=-216.3772``, ``balls=2``, ``friction_coefficient=2.75e-3``; also ``friction``,
///     ``normal_force``, ``contact``, ``speed_profile``, ``disturbances`` and ``protocol``. The defaults are the machine
///     of the thesis.
///
/// A failed run raises no exception; its label is ``failed``. Raises StudyError for invalid
/// arguments and for a motion of more than 1,000,000 instants, and TypeError for values of other
/// types.
#[pyfunction]
#[pyo3(signature = (start, *, times_s = None, model = "ball_balancer", simulation = None, **parameters))]
pub fn simulate(
    py: Python<'_>,
    start: &Bound<'_, PyAny>,
    times_s: Option<&Bound<'_, PyAny>>,
    model: &str,
    simulation: Option<&Bound<'_, PyAny>>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Simulation> {
    let mut machine = Machine::new("simulate", model, &KEYS, parameters)?;
    if let Some(simulation) = simulation {
        machine.parts.push(("simulation", to_value("simulation", simulation)?));
    }
    let times_s = times_s.map(times).transpose()?;
    let named = machine.study(json!({"monte_carlo": {"samples": 1}}))?;
    let names = named.model().coordinates().into_iter().map(|coordinate| coordinate.name);
    let mut columns: Vec<String> = names.collect();
    let mut row = vec![json!(0); columns.len()];
    let Value::Object(given) = to_value("start", start)? else {
        return Err(wrong_type("start", start, "a dict of coordinates, such as {\"beta_1\": 1.0}"));
    };
    for (name, value) in given {
        match columns.iter().position(|column| *column == name) {
            Some(place) => row[place] = value,
            None => {
                columns.push(name);
                row.push(value);
            }
        }
    }
    let study = machine.study(json!({"table": {"columns": columns, "rows": [row]}}));
    let study = study.map_err(|trouble| of_start(&columns, trouble))?;
    Ok(wait(py, move |_| Simulation::new(&study, Replay::of_study(&study, 0, times_s)?))??)
}

/// Names the coordinate instead of the column of the table of start states.
fn of_start(columns: &[String], trouble: Trouble) -> Trouble {
    let Trouble::Study(error) = &trouble else { return trouble };
    let Some(place) = error.key().strip_prefix("initial_conditions.design.table.") else {
        return trouble;
    };
    let place = place.strip_suffix(']').and_then(|place| place.rsplit_once('['));
    let column = place.and_then(|(_, column)| columns.get(column.parse::<usize>().ok()?));
    let Some(column) = column else { return trouble };
    let problem = match error.problem() {
        "unknown column" => "unknown coordinate",
        other => other,
    };
    let [found, allowed] = [error.found(), error.allowed()].map(Option::unwrap_or_default);
    refused(&format!("start.{column}"), problem, found, allowed)
}

/// Converts times, which must ascend.
///
/// # Errors
/// Returns a `TypeError` for values that are no numbers, and a `StudyError` for numbers that are not ascending times.
pub fn times(given: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let refused = |found: String, allowed: &str| refused("times_s", "not times", &found, allowed);
    let mut times: Vec<f64> = Vec::new();
    let all = if is_text(given) { None } else { items(given)? };
    for value in all.ok_or_else(|| wrong_type("times_s", given, "a list of numbers"))? {
        let place = || format!("times_s[{}]", times.len());
        let value = plain(&value)?;
        let time = match number(&value)? {
            Some(time) if !value.is_instance_of::<PyBool>() => time,
            _ => return Err(wrong_type(&place(), &value, "a number")),
        };
        if !(0.0..=LATEST_S).contains(&time) {
            return Err(refused(time.to_string(), "numbers from 0 to 1e12").into());
        }
        if let Some(last) = times.last().filter(|last| **last >= time) {
            return Err(refused(format!("{time} after {last}"), "times that ascend").into());
        }
        if times.len() == MOST_INSTANTS {
            return Err(refused("more".to_owned(), "at most 1000000 times").into());
        }
        times.push(time);
    }
    Ok(times)
}
