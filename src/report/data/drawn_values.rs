//! The values that were drawn for uncertain parameters, run by run, with amplitude and time to rest.

use std::collections::BTreeMap;

use super::{PointFacts, scattered};
use crate::analysis::{RankCorrelation, rank_correlation};
use crate::classification::Label;
use crate::study::Study;
use crate::table::{Table, TableError};

/// The largest number of values in memory.
const MOST_VALUES: u64 = 4_000_000;

/// The drawn values of the runs of the points in detail, except failed runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnValues {
    /// About one in this many runs is included.
    pub one_in: u64,
    /// The runs by point.
    pub points: BTreeMap<u64, DrawnRuns>,
}

/// The drawn values of the runs of a point, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnRuns {
    /// Numbers of the runs.
    pub run_id: Vec<u64>,
    /// Their labels.
    pub label: Vec<Label>,
    /// Amplitude at the end, m.
    pub amplitude_m: Vec<f64>,
    /// Time to rest, s; infinite for runs that did not come to rest.
    pub time_to_rest_s: Vec<f64>,
    /// The drawn values, parameter by parameter in the order of [`crate::study::Plan::uncertain`], in the units that the study chooses.
    pub values: Vec<Vec<f64>>,
}

impl DrawnRuns {
    /// Returns the rank correlation of a parameter with the amplitude.
    pub fn with_amplitude(&self, parameter: usize) -> Option<RankCorrelation> {
        rank_correlation(self.values.get(parameter)?, &self.amplitude_m)
    }

    /// Returns the rank correlation of a parameter with the time to rest. Runs that did not come to rest rank last.
    pub fn with_time_to_rest(&self, parameter: usize) -> Option<RankCorrelation> {
        rank_correlation(self.values.get(parameter)?, &self.time_to_rest_s)
    }
}

/// Reads the runs of these points; empty if the study has no uncertain parameters.
pub fn read(
    study: &Study,
    table: &Table,
    shown: &[&PointFacts],
) -> Result<DrawnValues, TableError> {
    let parameters = study.uncertain();
    let of = shown.iter().map(|point| point.runs).fold(0, u64::saturating_add);
    let values = of.saturating_mul(parameters.len() as u64 + 3);
    let one_in = values.div_ceil(MOST_VALUES).max(1);
    let mut drawn = DrawnValues { one_in, points: BTreeMap::new() };
    if parameters.is_empty() {
        return Ok(drawn);
    }
    let empty = || DrawnRuns { values: vec![Vec::new(); parameters.len()], ..DrawnRuns::default() };
    drawn.points = shown.iter().map(|point| (point.point_id, empty())).collect();
    table.for_each(|row| {
        let ids = row.count("run_id").zip(row.count("point_id"));
        let (label, amplitude_m) = (row.label(), row.number("amplitude_m"));
        let time_to_rest_s = row.number("time_to_rest_s");
        // All columns are asked for before the first missing value ends the list.
        let values: Vec<Option<f64>> =
            parameters.iter().map(|parameter| row.number(&parameter.name)).collect();
        let values: Option<Vec<f64>> = values.into_iter().collect();
        let known = ids.zip(label).zip(amplitude_m).zip(values);
        let Some(((((run_id, point_id), label), amplitude_m), values)) = known else { return };
        let Some(runs) = drawn.points.get_mut(&point_id) else { return };
        if !scattered(run_id, one_in) || !amplitude_m.is_finite() {
            return;
        }
        runs.run_id.push(run_id);
        runs.label.push(label);
        runs.amplitude_m.push(amplitude_m);
        runs.time_to_rest_s.push(time_to_rest_s.unwrap_or(f64::INFINITY));
        for ((column, value), parameter) in runs.values.iter_mut().zip(values).zip(parameters) {
            column.push(parameter.shown_number(value));
        }
    })?;
    Ok(drawn)
}
