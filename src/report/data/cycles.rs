//! Classes of limit cycles from `cycles.parquet`.

use crate::table::{Row, Table, TableError};

/// The largest number of rows.
const MOST_ROWS: usize = 20_000;

/// The plotted quantities of cycles: name, unit, and the columns of the value and of its range.
pub const QUANTITIES: [(&str, &str, [&str; 3]); 6] = [
    ("fraction of runs", "", ["fraction", "ci_low", "ci_high"]),
    ("period", "s", ["period_s", "period_low_s", "period_high_s"]),
    (
        "amplitude (root mean square)",
        "m",
        ["amplitude_rms_m", "amplitude_rms_low_m", "amplitude_rms_high_m"],
    ),
    ("amplitude", "m", ["amplitude_m", "amplitude_low_m", "amplitude_high_m"]),
    ("speed of ball 1", "rad/s", ["mean_speed_1_rad_s", "min_speed_1_rad_s", "max_speed_1_rad_s"]),
    ("largest multiplier", "", ["largest_multiplier", "", ""]),
];

/// A class of limit cycles at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleFacts {
    /// Number of the point.
    pub point_id: u64,
    /// Name of the class: which balls run and which stick, and how.
    pub class: String,
    /// Number of runs that end on it.
    pub runs: u64,
    /// Value, minimum and maximum of each of [`QUANTITIES`].
    pub values: [[Option<f64>; 3]; 6],
}

/// Reads the classes; only the first `MOST_ROWS` ones.
pub fn read(table: &Table) -> Result<Vec<CycleFacts>, TableError> {
    let facts = |row: &Row<'_>| CycleFacts {
        point_id: row.count("point_id").unwrap_or(u64::MAX),
        class: row.text("class").unwrap_or_default(),
        runs: row.count("runs").unwrap_or(0),
        values: QUANTITIES.map(|(.., columns)| columns.map(|name| row.number_if_there(name))),
    };
    table.read_rows(facts)?.take(MOST_ROWS).collect()
}
