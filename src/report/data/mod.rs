//! The data of a report, read from the tables of a directory of results in bounded memory. If the study has stages, this
//! module also computes the motion of a few runs again.
//!
//! Read `points` first: the values of a point. `runs`, `cycles` and `drawn_values` read the other tables,
//! `incomplete` has the points without all runs, and `motion` and `run_up` compute runs again. [`ReportData`] combines them.

mod cycles;
mod drawn_values;
mod incomplete;
mod motion;
mod names;
mod observation;
mod points;
mod run_up;
mod runs;

use std::path::Path;
use std::sync::{Arc, OnceLock};

pub use cycles::{CycleFacts, QUANTITIES, RestCurve};
pub use drawn_values::{DrawnRuns, DrawnValues};
pub use incomplete::IncompletePoints;
pub use motion::SampledMotion;
pub use names::{NamedPoints, axis_of, heading, said};
pub use points::{Fraction, PointFacts};
pub use run_up::{PeakOfRun, SampledRun, SampledRunUps};
pub use runs::{NotableRun, RunSample, scattered};

use super::chart::{Axis, axis_of_names};
use crate::classification::Label;
use crate::study::{Study, Unit};
use crate::table::{Manifest, MemoryTable, Table, TableError};

/// The longest name of a curve in a legend, in characters.
const LONGEST_NAME: usize = 56;

/// Limits of what the page shows, which keep it small; the page states what it omits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// The largest number of runs, one dot each.
    pub runs: u64,
    /// The largest number of dots of start states, over all panels.
    pub starts: usize,
    /// The largest number of dots over drawn parameters, over all panels.
    pub drawn: usize,
    /// The largest number of steps of a curve.
    pub steps: usize,
    /// The largest number of cells of equilibrium sets, over all panels.
    pub cells: usize,
    /// The largest number of points of a curve or a map.
    pub points: usize,
    /// The largest number of points in detail, one panel each.
    pub details: usize,
}

impl Budget {
    /// What a screen shows fluently.
    pub const SCREEN: Budget = Budget {
        runs: 100_000,
        starts: 48_000,
        drawn: 48_000,
        steps: 400,
        cells: 24 * 192 * 192,
        points: 10_000,
        details: 200,
    };
    /// What a printed figure shows legibly: at most 24 points in detail.
    pub const PRINT: Budget = Budget { details: 24, ..Budget::SCREEN };
    /// The number of runs up to which a smaller budget keeps all points in detail.
    const FEW_RUNS: u64 = 5000;

    /// Returns half of the budget, but at least a little of each. The number of points in detail is halved last.
    pub fn halved(self) -> Budget {
        let details = if self.runs > Self::FEW_RUNS { self.details } else { self.details / 2 };
        Budget {
            runs: (self.runs / 2).max(100),
            starts: (self.starts / 2).max(100),
            drawn: (self.drawn / 2).max(100),
            steps: (self.steps / 2).max(50),
            cells: (self.cells / 2).max(24 * 24),
            points: (self.points / 2).max(100),
            details: details.max(2),
        }
    }
}

/// The tables of a directory of results that a report reads, with verified files.
#[derive(Clone, Debug)]
pub struct ResultTables {
    points: Table,
    runs: Table,
    rest: Table,
    cycles: Table,
    /// Runs that have been computed again, once for all budgets.
    run_up: OnceLock<Arc<SampledRunUps>>,
}

impl ResultTables {
    /// Opens the tables.
    ///
    /// # Errors
    /// Returns an error if a table is missing or has been changed.
    pub fn open(directory: &Path, manifest: &Manifest) -> Result<Self, TableError> {
        Self::new(|name| Table::open(directory, manifest, name))
    }

    fn new(open: impl Fn(&str) -> Result<Table, TableError>) -> Result<Self, TableError> {
        let (points, runs) = (open("points")?, open("runs")?);
        let (rest, cycles) = (open("time_to_rest")?, open("cycles")?);
        Ok(ResultTables { points, runs, rest, cycles, run_up: OnceLock::new() })
    }

    /// Refers to tables in memory, which `named` finds by their names in a directory. Only their references are copied.
    ///
    /// # Errors
    /// Returns an error if there is no such table.
    pub fn in_memory(named: impl Fn(&str) -> Option<MemoryTable>) -> Result<Self, TableError> {
        Self::new(|name| Table::of_memory(name, named(name)))
    }

    /// Returns what happened in the runs of a study with stages; computes a few of them again on the first call.
    fn run_up(
        &self,
        study: &Study,
        points: &[PointFacts],
    ) -> Result<Arc<SampledRunUps>, TableError> {
        if let Some(run_up) = self.run_up.get() {
            return Ok(Arc::clone(run_up));
        }
        let run_up = Arc::new(run_up::read(study, &self.runs, points)?);
        Ok(Arc::clone(self.run_up.get_or_init(|| run_up)))
    }
}

/// The results as a report needs them.
#[derive(Clone, Debug)]
pub struct ReportData<'a> {
    /// The study.
    pub study: &'a Study,
    /// The manifest of the directory.
    pub manifest: &'a Manifest,
    /// The points of the sweep that have runs.
    pub points: Vec<PointFacts>,
    /// The points whose runs are not all finished.
    pub incomplete: IncompletePoints,
    /// Number of points, including those that `points` omits.
    pub point_count: u64,
    /// Indices in `points` of the points in detail: all of them, or evenly spaced ones.
    pub detailed: Vec<usize>,
    /// Runs of the points in detail: all of them, or a subsample.
    pub runs: RunSample,
    /// Drawn values of the runs of the points in detail.
    pub drawn: DrawnValues,
    /// The first runs that failed or whose label changed in the audit.
    pub notable: Vec<NotableRun>,
    /// Time to rest of the points in detail.
    pub rest: Vec<RestCurve>,
    /// What happened in the stages of the runs.
    pub run_up: Arc<SampledRunUps>,
    /// Classes of limit cycles.
    pub cycles: Vec<CycleFacts>,
    /// Limits of what figures show.
    pub budget: Budget,
}

impl<'a> ReportData<'a> {
    /// Returns the unit of amplitudes: that of vibration, or m for a model without vibration unless the study chooses another one.
    pub fn amplitude_unit(&self) -> Unit {
        let units = self.study.units();
        match self.study.model().kind().offers.vibration || units.chooses_vibration() {
            true => units.vibration(),
            false => Unit { symbol: "m".to_owned(), si: 1.0 },
        }
    }

    /// Reads the tables of a results directory, for all points or only for the chosen ones.
    ///
    /// # Errors
    /// Returns an error if a table lacks a column or cannot be read.
    pub fn read(
        tables: &ResultTables,
        study: &'a Study,
        manifest: &'a Manifest,
        budget: Budget,
        chosen: Option<&[u64]>,
    ) -> Result<Self, TableError> {
        let point_count = tables.points.rows();
        let mut points = points::read(study, &tables.points)?;
        points.retain(|point| chosen.is_none_or(|chosen| chosen.contains(&point.point_id)));
        let incomplete = IncompletePoints::read(study, manifest, &tables.points)?;
        let detailed = evenly(points.len(), budget.details);
        let of: Vec<&PointFacts> = detailed.iter().filter_map(|&place| points.get(place)).collect();
        let (runs, notable) = runs::read(study, &tables.runs, &points, &of, budget.runs)?;
        let shown: Vec<u64> = of.iter().map(|point| point.point_id).collect();
        let drawn = drawn_values::read(study, &tables.runs, &of)?;
        let rest = cycles::read_rest(&tables.rest, &shown, budget.steps)?;
        let run_up = tables.run_up(study, &points)?;
        let cycles = cycles::read_cycles(&tables.cycles)?;
        Ok(ReportData {
            study,
            manifest,
            points,
            incomplete,
            point_count,
            detailed,
            runs,
            drawn,
            notable,
            rest,
            run_up,
            cycles,
            budget,
        })
    }

    /// Returns an axis of points by their names, made of all values that differ between points.
    pub fn axis_of_points(&self, points: &[&PointFacts]) -> Axis {
        let names = points
            .iter()
            .map(|point| names::short(self.study, point.point_id, &point.swept))
            .collect();
        axis_of_names(names, names::short_axis(self.study))
    }

    /// Returns the points in detail.
    pub fn details(&self) -> impl Iterator<Item = &PointFacts> {
        self.detailed.iter().filter_map(|&place| self.points.get(place))
    }

    /// Returns the number of balls of a point; zero for a model without balls.
    pub fn balls_of(&self, point: &PointFacts) -> usize {
        self.study.point(point.point_id).model().balls()
    }

    /// Returns the number of rests of a point at which balls touch; `None` without contact between balls.
    pub fn touching_rests(&self, point: &PointFacts) -> Option<u64> {
        self.runs.touching_rests.get(&point.point_id).copied()
    }

    /// Returns a sentence on the failed runs that a figure cannot show; empty if there are none.
    pub fn failures_left_out(&self) -> String {
        let failed = |point: &PointFacts| match point.label(Label::Failed).runs {
            0 => None,
            failed => Some(format!("{failed} of {} at {}", point.runs, point.title)),
        };
        let of: Vec<String> = self.details().filter_map(failed).collect();
        match of.len() {
            0 => String::new(),
            few @ 1..=6 => {
                let other = if few < self.detailed.len() { ", none elsewhere" } else { "" };
                format!(" Failed runs are not shown: {}{other}.", of.join("; "))
            }
            many => format!(" Failed runs of {many} points are not shown."),
        }
    }

    /// Returns a sentence on quantities that ignore the draws of uncertain parameters; empty if there are none.
    pub fn without_draws(&self, what: &str) -> String {
        self.with_draws(&format!(
            "{what} of the machine with uncertain parameters at their medians"
        ))
    }

    /// Returns a statement about runs with uncertain parameters as a sentence that names these parameters; empty if there
    /// are none.
    pub fn with_draws(&self, statement: &str) -> String {
        if self.study.uncertain().is_empty() {
            return String::new();
        }
        let names: Vec<String> = self.study.uncertain().iter().map(names::words).collect();
        format!(" {statement}; each run has its own {}.", names.join(", "))
    }

    /// Returns the name of a point's curve: its title, or only the values if titles are long.
    pub fn curve_name(&self, point: &PointFacts) -> String {
        if self.has_short_names() {
            return names::short(self.study, point.point_id, &point.swept);
        }
        point.title.clone()
    }

    /// Returns a sentence on the values that name the curves; empty if the names include the parameters.
    pub fn curve_names(&self) -> String {
        if self.has_short_names() {
            return format!(" The names of the curves are {}.", names::short_axis(self.study).name);
        }
        String::new()
    }

    fn has_short_names(&self) -> bool {
        self.details().any(|point| point.title.chars().count() > LONGEST_NAME)
    }

    /// Returns a sentence on the number of points in detail; empty if all points are.
    pub fn left_out(&self) -> String {
        let (shown, all) = (self.detailed.len() as u64, self.point_count);
        if shown == all {
            return String::new();
        }
        format!(" {shown} of {all} points are shown, evenly spaced in the order of the sweep.")
    }
}

/// Returns at most `most` of the indices 0, 1, …, nearly evenly spaced, including the first and the last.
pub fn evenly(count: usize, most: usize) -> Vec<usize> {
    if count <= most || most < 2 {
        return (0..count).collect();
    }
    (0..most).map(|k| k * (count - 1) / (most - 1)).collect()
}
