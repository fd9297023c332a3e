//! `equilibrium_histogram.parquet`: the number of equilibria in each part of the ring, with one row
//! per point of the sweep and occupied bin.

use super::column::Column;
use super::points::PointRow;
use super::runs::swept_columns;
use crate::analysis::{HistogramBin, bin_edges};
use crate::study::{ParameterValue, Study};

/// An occupied bin at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct HistogramRow {
    /// Number of the point, from 0.
    pub point_id: u64,
    /// Values of the swept parameters, in the order of [`Study::swept`].
    pub swept: Vec<ParameterValue>,
    /// The bin and its counts.
    pub bin: HistogramBin,
}

impl HistogramRow {
    /// Creates the row of a bin at a point.
    pub fn new(point: &PointRow, bin: HistogramBin) -> Self {
        HistogramRow { point_id: point.point_id, swept: point.swept.clone(), bin }
    }
}

/// Returns the columns of `equilibrium_histogram.parquet`. For one or two balls, a bin has the
/// angles of all balls; for more balls, it has the angle of one ball.
pub fn histogram_columns(study: &Study) -> Vec<Column<HistogramRow>> {
    let balls = study.model().balls();
    let angles = if balls > 2 { 1 } else { balls };
    let mut columns = vec![Column::count(
        "point_id",
        "number of the sweep's point, from 0",
        |row: &HistogramRow| Some(row.point_id),
    )];
    columns.extend(swept_columns(study, |row: &HistogramRow| &row.swept));
    if balls > 2 {
        columns.push(Column::count(
            "ball",
            "first ball of the group of identical balls, from 1; the row counts the angle of each \
             ball of the group separately",
            |row: &HistogramRow| Some(row.bin.ball as u64 + 1),
        ));
    }
    for angle in 0..angles {
        let number = angle + 1;
        columns.push(Column::count(
            &format!("bin_{number}"),
            "bin of the angle, from 0; for two identical balls, the smaller angle comes first",
            move |row: &HistogramRow| row.bin.bins.get(angle).map(|&bin| bin as u64),
        ));
        for (end, word, meaning) in [(0, "from", "begins"), (1, "to", "ends")] {
            columns.push(Column::number(
                &format!("beta_{number}_{word}_rad"),
                "rad",
                &format!("angle from the imbalance at which the bin {meaning}"),
                move |row: &HistogramRow| row.bin.bins.get(angle).map(|&bin| bin_edges(bin)[end]),
            ));
        }
    }
    columns.extend([
        Column::count(
            "runs",
            "equilibria in the bin; for three or more balls, equilibria with at least one ball of \
             the group in the bin",
            |row: &HistogramRow| Some(row.bin.runs),
        ),
        Column::number(
            "fraction",
            "1",
            "fraction of all equilibria of the point",
            |row: &HistogramRow| Some(row.bin.fraction),
        ),
        Column::number(
            "ci_low",
            "1",
            "lower end of its 95 % confidence interval (Wilson)",
            |row: &HistogramRow| Some(row.bin.interval.0),
        ),
        Column::number(
            "ci_high",
            "1",
            "upper end of its 95 % confidence interval (Wilson)",
            |row: &HistogramRow| Some(row.bin.interval.1),
        ),
    ]);
    columns
}
