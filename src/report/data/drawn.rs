//! The values that were drawn for uncertain parameters, run by run, with amplitude and time to rest.

use std::collections::BTreeMap;

use super::{PointFacts, scattered};
use crate::analysis::{RankCorrelation, rank_correlation};
use crate::classification::Label;
use crate::study::Study;
use crate::table::{Kind, Table, TableError};

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
    /// Indices of their labels in [`Label::ALL`].
    pub label: Vec<u8>,
    /// Amplitude at the end, m.
    pub amplitude_m: Vec<f64>,
    /// Time to rest, s; infinite for runs that did not come to rest.
    pub time_to_rest_s: Vec<f64>,
    /// The drawn values, parameter by parameter in the order of [`Study::uncertain`], in the units that the study chooses.
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
    let mut wanted =
        vec![("run_id", Kind::Count), ("point_id", Kind::Count), ("label", Kind::Text)];
    wanted.extend(["amplitude_m", "time_to_rest_s"].map(|name| (name, Kind::Number)));
    wanted.extend(parameters.iter().map(|parameter| (parameter.name.as_str(), Kind::Number)));
    for batch in table.read(&wanted)? {
        let batch = batch?;
        for row in 0..batch.rows {
            let numbers = batch.count("run_id", row)?.zip(batch.count("point_id", row)?);
            let Some((run_id, point_id)) = numbers.filter(|(run, _)| scattered(*run, one_in))
            else {
                continue;
            };
            let label = batch.text("label", row)?.unwrap_or_default();
            let label = Label::ALL.iter().position(|known| known.name() == label);
            let Some(runs) = drawn.points.get_mut(&point_id) else { continue };
            let values: Option<Vec<f64>> = parameters
                .iter()
                .map(|parameter| batch.number(&parameter.name, row))
                .collect::<Result<_, _>>()?;
            let amplitude = batch.number("amplitude_m", row)?.filter(|value| value.is_finite());
            let Some(((label, amplitude), values)) = label.zip(amplitude).zip(values) else {
                continue;
            };
            runs.run_id.push(run_id);
            runs.label.push(label as u8);
            runs.amplitude_m.push(amplitude);
            let time = batch.number("time_to_rest_s", row)?;
            runs.time_to_rest_s.push(time.unwrap_or(f64::INFINITY));
            for ((column, value), parameter) in runs.values.iter_mut().zip(values).zip(parameters) {
                column.push(parameter.shown_number(value));
            }
        }
    }
    Ok(drawn)
}
