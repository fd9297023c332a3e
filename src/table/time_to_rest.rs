//! `time_to_rest.parquet`: the probability of being at rest over time, per point of the sweep.

use super::column::Column;
use super::points::PointRow;
use super::runs::swept_columns;
use crate::analysis::RestStep;
use crate::study::{ParameterValue, Study};

/// One row of a point's curve.
#[derive(Clone, Debug, PartialEq)]
pub struct RestRow {
    /// Number of the point, from 0.
    pub point_id: u64,
    /// Values of the swept parameters, in the order of [`Study::swept`].
    pub swept: Vec<ParameterValue>,
    /// The state of the curve at a time.
    pub step: RestStep,
}

impl RestRow {
    /// Creates the row of a point's curve.
    pub fn new(point: &PointRow, step: RestStep) -> Self {
        RestRow { point_id: point.point_id, swept: point.swept.clone(), step }
    }
}

/// Returns the columns of `time_to_rest.parquet`.
pub fn rest_columns(study: &Study) -> Vec<Column<RestRow>> {
    let mut columns =
        vec![Column::count("point_id", "number of the sweep's point, from 0", |row: &RestRow| {
            Some(row.point_id)
        })];
    columns.extend(swept_columns(study, |row: &RestRow| &row.swept));
    columns.extend([
        Column::number("time_s", "s", "simulated time", |row: &RestRow| Some(row.step.time_s)),
        Column::count(
            "at_risk",
            "runs at risk just before this time, without failed runs; if the curve is thinned to \
             1000 rows, before the first rest after the preceding row",
            |row: &RestRow| Some(row.step.at_risk),
        ),
        Column::count(
            "came_to_rest",
            "runs that came to rest after the preceding row, up to and including this time",
            |row: &RestRow| Some(row.step.came_to_rest),
        ),
        Column::count(
            "censored",
            "censored runs: stopped while moving before the next row; limit cycles count at the \
             last end time",
            |row: &RestRow| Some(row.step.censored),
        ),
        Column::number(
            "probability_at_rest",
            "1",
            "probability of being at rest by this time (Kaplan-Meier)",
            |row: &RestRow| Some(row.step.probability),
        ),
        Column::number(
            "ci_low",
            "1",
            "lower end of its 95 % confidence interval (Greenwood, log(-log); exact binomial at 0 \
             and 1)",
            |row: &RestRow| Some(row.step.interval.0),
        ),
        Column::number(
            "ci_high",
            "1",
            "upper end of its 95 % confidence \
             interval",
            |row: &RestRow| Some(row.step.interval.1),
        ),
    ]);
    columns
}
