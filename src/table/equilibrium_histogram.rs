//! `equilibrium_histogram.parquet`: the number of equilibria in each part of the ring, with one row
//! per point of the sweep and occupied bin.

use super::column::{Column, Columns};
use super::point_key::{OfPoint, add_point};
use crate::analysis::{HistogramBin, bin_edges};
use crate::study::Study;

/// An occupied bin at a point.
pub type HistogramRow = OfPoint<HistogramBin>;

/// Returns the columns of `equilibrium_histogram.parquet`. For one or two balls, a bin has the
/// angles of all balls; for more balls, it has the angle of one ball. A sweep over the number of
/// balls has the columns of all its numbers.
pub fn histogram_columns(study: &Study) -> Vec<Column<HistogramRow>> {
    let (fewest, most) = study.numbers_of_balls().into_inner();
    let angles = if fewest > 2 { 1 } else { most.min(2) };
    let mut list = Columns::new();
    add_point(&mut list, study, |row: &HistogramRow| &row.point);
    if most > 2 {
        list.count("ball", |row| (row.value.bins.len() == 1).then_some(row.value.ball as u64 + 1)).meaning(
            "first ball of the group of identical balls, from 1; the row counts the angle of each \
             ball of the group separately",
        );
    }
    for angle in 0..angles {
        let number = angle + 1;
        list.count(format!("bin_{number}"), move |row| {
            row.value.bins.get(angle).map(|&bin| bin as u64)
        })
        .meaning(
            "interval of the angle, from 0, 10° wide; for two identical balls, the smaller angle comes \
             first; for three or more balls, the angle of any ball in the group of the column ball",
        );
        for (end, word, verb) in [(0, "from", "begins"), (1, "to", "ends")] {
            list.number(format!("beta_{number}_{word}_rad"), "rad", move |row| {
                row.value.bins.get(angle).map(|&bin| bin_edges(bin)[end])
            })
            .meaning(format!("angle from the imbalance at which the bin {verb}"));
        }
    }
    list.count("runs", |row| row.value.runs).meaning(
        "equilibria in the bin; for three or more balls, equilibria with at least one ball of the \
         group in the bin",
    );
    list.number("fraction", "1", |row| row.value.fraction)
        .meaning("fraction of all equilibria of the point");
    list.number("ci_low", "1", |row| row.value.interval.0)
        .meaning("lower end of its 95 % confidence interval (Wilson)");
    list.number("ci_high", "1", |row| row.value.interval.1)
        .meaning("upper end of its 95 % confidence interval (Wilson)");
    list.finish()
}
