//! `time_to_rest.parquet`: the probability of being at rest over time, per point of the sweep.

use super::column::{Column, Columns};
use super::point_key::{OfPoint, add_point};
use crate::analysis::RestStep;
use crate::study::Study;

/// The state of a point's curve at a time.
pub type RestRow = OfPoint<RestStep>;

/// Returns the columns of `time_to_rest.parquet`.
pub fn rest_columns(study: &Study) -> Vec<Column<RestRow>> {
    let mut list = Columns::new();
    add_point(&mut list, study, |row: &RestRow| &row.point);
    list.number("time_s", "s", |row| row.value.time_s).meaning("simulated time");
    list.count("at_risk", |row| row.value.at_risk).meaning(
        "runs at risk just before this time, without failed runs; if the curve is thinned to 1000 \
         rows, before the first rest after the preceding row",
    );
    list.count("came_to_rest", |row| row.value.came_to_rest)
        .meaning("runs that came to rest after the preceding row, up to and including this time");
    list.count("censored", |row| row.value.censored).meaning(
        "censored runs: stopped while moving before the next row; limit cycles count at the last \
         end time",
    );
    list.number("probability_at_rest", "1", |row| row.value.probability)
        .meaning("probability of being at rest by this time (Kaplan-Meier)");
    list.number("ci_low", "1", |row| row.value.interval.0).meaning(
        "lower end of its 95 % confidence interval (Greenwood, log(-log); exact binomial at 0 and \
         1)",
    );
    list.number("ci_high", "1", |row| row.value.interval.1)
        .meaning("upper end of its 95 % confidence interval");
    list.finish()
}
