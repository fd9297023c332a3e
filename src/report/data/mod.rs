//! What a report is made of, read once from the tables of a results directory, in bounded memory.

mod cycles;
mod names;
mod points;
mod rest;
mod runs;

use std::path::Path;

pub use cycles::{CycleFacts, QUANTITIES};
pub use names::{axis_of, heading, said};
pub use points::{Fraction, PointFacts};
pub use rest::RestCurve;
pub use runs::{LABELS, Notable, RunSample, scattered};

use super::chart::{Axis, AxisKind};
use crate::study::Study;
use crate::table::{Manifest, Table, TableError};

/// The longest name of a curve that has room beside a figure, letters.
const LONGEST_NAME: usize = 56;

/// How much is shown, so that a page stays small; what is left out is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Most runs, each a dot.
    pub runs: u64,
    /// Most dots of start states, all panels together.
    pub starts: usize,
    /// Most points of a curve or a map.
    pub points: usize,
    /// Most points of which details are shown, each in a panel of its own.
    pub details: usize,
}

impl Budget {
    /// What a screen shows fluently.
    pub const SCREEN: Budget =
        Budget { runs: 100_000, starts: 48_000, points: 10_000, details: 24 };

    /// Half of it; at least something.
    pub fn halved(self) -> Budget {
        Budget {
            runs: (self.runs / 2).max(100),
            starts: (self.starts / 2).max(100),
            points: (self.points / 2).max(100),
            details: (self.details / 2).max(2),
        }
    }
}

/// The tables of a results directory that a report reads, all their files checked.
#[derive(Clone, Debug)]
pub struct ResultTables {
    points: Table,
    runs: Table,
    rest: Table,
    cycles: Table,
}

impl ResultTables {
    /// Opens the tables.
    ///
    /// # Errors
    /// Where a table is missing or is not the one that was written.
    pub fn open(directory: &Path, manifest: &Manifest) -> Result<Self, TableError> {
        let open = |name: &str| Table::open(directory, manifest, name);
        let (points, runs) = (open("points")?, open("runs")?);
        Ok(ResultTables { points, runs, rest: open("time_to_rest")?, cycles: open("cycles")? })
    }
}

/// Results as a report needs them.
#[derive(Clone, Debug)]
pub struct ReportData<'a> {
    /// The study.
    pub study: &'a Study,
    /// What the directory says of itself.
    pub manifest: &'a Manifest,
    /// The points of the sweep that have runs.
    pub points: Vec<PointFacts>,
    /// How many points there are, should they be too many to be held.
    pub point_count: u64,
    /// Places in `points` of those that are shown in detail: all of them, or some at even distances.
    pub detailed: Vec<usize>,
    /// Runs of the points shown in detail: all of them, or some.
    pub runs: RunSample,
    /// Runs that failed or whose label an audit doubts, the first ones.
    pub notable: Vec<Notable>,
    /// Time to rest, of the points shown in detail.
    pub rest: Vec<RestCurve>,
    /// Classes of limit cycles.
    pub cycles: Vec<CycleFacts>,
    /// How much figures may show.
    pub budget: Budget,
}

impl<'a> ReportData<'a> {
    /// Reads the tables of a results directory.
    ///
    /// # Errors
    /// Where a table lacks a column or cannot be read.
    pub fn read(
        tables: &ResultTables,
        study: &'a Study,
        manifest: &'a Manifest,
        budget: Budget,
    ) -> Result<Self, TableError> {
        let point_count = tables.points.rows();
        let points = points::read(study, &tables.points)?;
        let detailed = evenly(points.len(), budget.details);
        let of: Vec<&PointFacts> = detailed.iter().filter_map(|&place| points.get(place)).collect();
        let (runs, notable) = runs::read(study, &tables.runs, &of, budget.runs)?;
        let shown: Vec<u64> = of.iter().map(|point| point.point_id).collect();
        let rest = rest::read(&tables.rest, &shown)?;
        let cycles = cycles::read(&tables.cycles)?;
        Ok(ReportData {
            study,
            manifest,
            points,
            point_count,
            detailed,
            runs,
            notable,
            rest,
            cycles,
            budget,
        })
    }

    /// An axis of points by their names: all that differs from point to point.
    pub fn axis_of_points(&self, points: &[&PointFacts]) -> Axis {
        let names = points.iter().map(|point| names::short(point.point_id, &point.swept)).collect();
        let range = Some([-0.5, points.len() as f64 - 0.5]);
        Axis { kind: AxisKind::Names(names), range, ..names::short_axis(self.study) }
    }

    /// The points that are shown in detail.
    pub fn details(&self) -> impl Iterator<Item = &PointFacts> {
        self.detailed.iter().filter_map(|&place| self.points.get(place))
    }

    /// What is to be said of failed runs, which figures cannot show; empty where there are none.
    pub fn failures_left_out(&self) -> String {
        let failed = super::figures::failed_runs;
        let of: Vec<String> = self
            .details()
            .filter(|point| failed(point) > 0)
            .map(|point| format!("{} of {} at {}", failed(point), point.runs, point.title))
            .collect();
        match of.len() {
            0 => String::new(),
            few @ 1..=6 => {
                let other = if few < self.detailed.len() { ", none elsewhere" } else { "" };
                format!(" Failed runs are left out: {}{other}.", of.join("; "))
            }
            many => format!(" Failed runs are left out; {many} points have some."),
        }
    }

    /// What is to be said where parameters are drawn for each run, of what is computed without draws.
    pub fn without_draws(&self, what: &str) -> String {
        if self.study.uncertain().is_empty() {
            return String::new();
        }
        let names: Vec<&str> =
            self.study.uncertain().iter().map(|parameter| parameter.name.as_str()).collect();
        format!(" {what} of the machine without draws; each run has its own {}.", names.join(", "))
    }

    /// What a point's curve is called: what distinguishes it, or only the values where that is long.
    pub fn curve_name(&self, point: &PointFacts) -> String {
        if self.has_short_names() {
            return names::short(point.point_id, &point.swept);
        }
        point.title.clone()
    }

    /// What the values are by which curves are called; empty where their names say it.
    pub fn curve_names(&self) -> String {
        if self.has_short_names() {
            return format!(" Curves are named by {}.", names::short_axis(self.study).name);
        }
        String::new()
    }

    fn has_short_names(&self) -> bool {
        self.details().any(|point| point.title.chars().count() > LONGEST_NAME)
    }

    /// What is to be said where not all points are shown in detail; empty where they are.
    pub fn left_out(&self) -> String {
        let (shown, all) = (self.detailed.len() as u64, self.point_count);
        if shown == all {
            return String::new();
        }
        format!(" Shown are {shown} of {all} points, at even distances in the order of the sweep.")
    }
}

/// At most so many of the places 0, 1, … at nearly even distances, the first and the last among them.
pub fn evenly(count: usize, most: usize) -> Vec<usize> {
    if count <= most || most < 2 {
        return (0..count).collect();
    }
    (0..most).map(|k| k * (count - 1) / (most - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::evenly;

    #[test]
    fn places_at_even_distances() {
        assert_eq!(evenly(3, 24), [0, 1, 2]);
        assert_eq!(evenly(0, 24), [0; 0]);
        let some = evenly(1000, 24);
        assert_eq!((some.len(), some[0], some[23]), (24, 0, 999));
        assert!(some.windows(2).all(|pair| (43..=44).contains(&(pair[1] - pair[0]))));
    }
}
