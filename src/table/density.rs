//! `density.parquet`: where on the ring balls came to rest, one row per point of the sweep and occupied
//! bin.

use super::column::Column;
use super::points::PointRow;
use super::runs::swept_columns;
use crate::analysis::{DensityBin, bin_edges};
use crate::study::{ParameterValue, Study};

/// An occupied bin at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityRow {
    /// Number of the point, from 0.
    pub point_id: u64,
    /// Values of the swept parameters, in the order of [`Study::swept`].
    pub swept: Vec<ParameterValue>,
    /// The bin and what is known of it.
    pub bin: DensityBin,
}

impl DensityRow {
    /// A row of a point.
    pub fn new(point: &PointRow, bin: DensityBin) -> Self {
        DensityRow { point_id: point.point_id, swept: point.swept.clone(), bin }
    }
}

/// The columns of `density.parquet`: of one ball or two for both angles together, of more for one of
/// them.
pub fn density_columns(study: &Study) -> Vec<Column<DensityRow>> {
    let balls = study.model().balls();
    let angles = if balls > 2 { 1 } else { balls };
    let mut columns = vec![Column::count(
        "point_id",
        "number of the sweep's point, from 0",
        |row: &DensityRow| Some(row.point_id),
    )];
    columns.extend(swept_columns(study, |row: &DensityRow| &row.swept));
    if balls > 2 {
        columns.push(Column::count(
            "ball",
            "the first of the balls that are alike, from 1; the row is about the angles of all of \
             them, each alone",
            |row: &DensityRow| Some(row.bin.ball as u64 + 1),
        ));
    }
    for angle in 0..angles {
        let number = angle + 1;
        columns.push(Column::count(
            &format!("bin_{number}"),
            "bin of the angle, from 0; of two balls that are alike, the smaller angle is the first",
            move |row: &DensityRow| row.bin.bins.get(angle).map(|&bin| bin as u64),
        ));
        for (end, word, meaning) in [(0, "from", "begins"), (1, "to", "ends")] {
            columns.push(Column::number(
                &format!("beta_{number}_{word}_rad"),
                "rad",
                &format!("angle from the imbalance at which the bin {meaning}"),
                move |row: &DensityRow| row.bin.bins.get(angle).map(|&bin| bin_edges(bin)[end]),
            ));
        }
    }
    columns.extend([
        Column::count(
            "runs",
            "equilibria in the bin; of three balls and more, those with one of these balls in it or \
             several",
            |row: &DensityRow| Some(row.bin.runs),
        ),
        Column::number(
            "share",
            "1",
            "share of all equilibria of the point",
            |row: &DensityRow| Some(row.bin.share),
        ),
        Column::number(
            "ci_low",
            "1",
            "lower end of its 95 % interval (Wilson)",
            |row: &DensityRow| Some(row.bin.interval.0),
        ),
        Column::number(
            "ci_high",
            "1",
            "upper end of its 95 % interval (Wilson)",
            |row: &DensityRow| Some(row.bin.interval.1),
        ),
    ]);
    let (name, unit) = match angles {
        2 => ("density_1_rad2", "1/rad²"),
        _ => ("density_1_rad", "1/rad"),
    };
    columns.push(Column::number(
        name,
        unit,
        "density of equilibria at the bin's centre (von Mises kernels); of balls that are alike the same \
         whatever their order; integrates to 1 over all angles from 0 to 2π",
        |row: &DensityRow| Some(row.bin.density),
    ));
    columns.push(Column::number(
        "kernel_width_rad",
        "rad",
        "standard deviation of the kernels, of some widths the one under which each run is most likely \
         by all others",
        |row: &DensityRow| Some(row.bin.kernel_width_rad),
    ));
    columns
}
