//! Classes of limit cycles from `cycles.parquet`.

use crate::table::{Kind, Table, TableError};

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
    let has = |name: &str| table.columns().iter().any(|(column, _)| column == name);
    let mut wanted = vec![("point_id", Kind::Count), ("class", Kind::Text), ("runs", Kind::Count)];
    let columns = QUANTITIES.iter().flat_map(|(.., columns)| columns);
    wanted.extend(columns.filter(|name| has(name)).map(|name| (*name, Kind::Number)));
    let mut rows = Vec::new();
    for batch in table.read(&wanted)? {
        let batch = batch?;
        for row in 0..batch.rows.min(MOST_ROWS - rows.len()) {
            let mut values = [[None; 3]; 6];
            for (of, (.., columns)) in values.iter_mut().zip(&QUANTITIES) {
                for (value, name) in of.iter_mut().zip(columns).filter(|(_, name)| has(name)) {
                    *value = batch.number(name, row)?;
                }
            }
            rows.push(CycleFacts {
                point_id: batch.count("point_id", row)?.unwrap_or(u64::MAX),
                class: batch.text("class", row)?.unwrap_or_default(),
                runs: batch.count("runs", row)?.unwrap_or(0),
                values,
            });
        }
        if rows.len() == MOST_ROWS {
            break;
        }
    }
    Ok(rows)
}
