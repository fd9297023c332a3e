//! `equilibrium_histogram.parquet`: how often balls came to rest in which part of the ring, one row per
//! point of the sweep and occupied bin.

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
    /// The bin and what is known of it.
    pub bin: HistogramBin,
}

impl HistogramRow {
    /// A row of a point.
    pub fn new(point: &PointRow, bin: HistogramBin) -> Self {
        HistogramRow { point_id: point.point_id, swept: point.swept.clone(), bin }
    }
}

/// The columns of `equilibrium_histogram.parquet`: of one ball or two for both angles together, of more for one of
/// them.
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
            "the first of the identical balls, from 1; the row counts the angle of each of them alone",
            |row: &HistogramRow| Some(row.bin.ball as u64 + 1),
        ));
    }
    for angle in 0..angles {
        let number = angle + 1;
        columns.push(Column::count(
            &format!("bin_{number}"),
            "bin of the angle, from 0; the smaller angle of two identical balls is the first",
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
            "equilibria in the bin; of three balls and more, those with at least one of these balls in it",
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
            "lower end of its 95 % interval (Wilson)",
            |row: &HistogramRow| Some(row.bin.interval.0),
        ),
        Column::number(
            "ci_high",
            "1",
            "upper end of its 95 % interval (Wilson)",
            |row: &HistogramRow| Some(row.bin.interval.1),
        ),
    ]);
    columns
}
