//! Residual vibration of a point against the machine without balls, from columns of `points.parquet` that results of
//! earlier versions lack.

use crate::table::{Batch, Kind, Table, TableError};

/// Quantities of a point that answer whether the balls reduce the vibration; `None` if the table lacks the column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vibration {
    /// Fraction of the runs that vibrate more than without balls.
    pub worse_fraction: Option<f64>,
    /// Median and 95 % quantile of the balance quality grade G of ISO 21940-11, mm/s.
    pub grade_mm_s: [Option<f64>; 2],
    /// Fraction of the rests at which balls overlap.
    pub overlapping_fraction: Option<f64>,
}

const WORSE: &str = "worse_than_without_balls_fraction";
const GRADES: [&str; 2] = ["balance_quality_grade_p50_mm_s", "balance_quality_grade_p95_mm_s"];
const OVERLAPPING: &str = "overlapping_rest_fraction";

/// Reads one of every `every` points, in the order of the table.
pub fn read(table: &Table, every: u64) -> Result<Vec<Vibration>, TableError> {
    let is_there = |name: &&str| {
        table.columns().iter().any(|(column, kind)| column == name && *kind == Some(Kind::Number))
    };
    let wanted: Vec<&str> =
        [WORSE, GRADES[0], GRADES[1], OVERLAPPING].into_iter().filter(is_there).collect();
    let number = |batch: &Batch, name: &str, row: usize| match wanted.contains(&name) {
        true => batch.number(name, row),
        false => Ok(None),
    };
    let mut columns = vec![("point_id", Kind::Count)];
    columns.extend(wanted.iter().map(|name| (*name, Kind::Number)));
    let mut points = Vec::new();
    for batch in table.read(&columns)? {
        let batch = batch?;
        for row in 0..batch.rows {
            if (batch.first_row + row as u64).is_multiple_of(every) {
                let [p50, p95] = GRADES.map(|name| number(&batch, name, row));
                points.push(Vibration {
                    worse_fraction: number(&batch, WORSE, row)?,
                    grade_mm_s: [p50?, p95?],
                    overlapping_fraction: number(&batch, OVERLAPPING, row)?,
                });
            }
        }
    }
    Ok(points)
}
