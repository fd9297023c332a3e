//! Classes of limit cycles from `cycles.parquet`, and curves of `time_to_rest.parquet`: the probability of rest over time.

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
pub fn read_cycles(table: &Table) -> Result<Vec<CycleFacts>, TableError> {
    let facts = |row: &Row<'_>| CycleFacts {
        point_id: row.count("point_id").unwrap_or(u64::MAX),
        class: row.text("class").unwrap_or_default(),
        runs: row.count("runs").unwrap_or(0),
        values: QUANTITIES.map(|(.., columns)| columns.map(|name| row.number_if_there(name))),
    };
    table.read_rows(facts)?.take(MOST_ROWS).collect()
}

/// The probability of rest by time t, of one point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestCurve {
    /// Number of the point.
    pub point_id: u64,
    /// Times of the steps, s, ascending.
    pub time_s: Vec<f64>,
    /// The probability from each step on.
    pub probability: Vec<f64>,
    /// Lower end of the 95 % interval.
    pub low: Vec<f64>,
    /// Upper end of the 95 % interval.
    pub high: Vec<f64>,
}

/// Reads the curves of these points, in the order of the table, each thinned out to at most `most` steps.
pub fn read_rest(table: &Table, points: &[u64], most: usize) -> Result<Vec<RestCurve>, TableError> {
    let mut curves: Vec<RestCurve> = Vec::new();
    table.for_each(|row| {
        let key = row.count("point_id").zip(row.number("time_s"));
        let numbers = ["probability_at_rest", "ci_low", "ci_high"].map(|name| row.number(name));
        let Some((point_id, time_s)) = key else { return };
        if points.binary_search(&point_id).is_err() {
            return;
        }
        if curves.last().is_none_or(|curve| curve.point_id != point_id) {
            if let Some(last) = curves.last_mut() {
                thin(last, most);
            }
            curves.push(RestCurve { point_id, ..RestCurve::default() });
        }
        if let Some(curve) = curves.last_mut() {
            curve.time_s.push(time_s);
            let RestCurve { probability, low, high, .. } = curve;
            for (values, number) in [probability, low, high].into_iter().zip(numbers) {
                values.push(number.unwrap_or(f64::NAN));
            }
        }
    })?;
    if let Some(last) = curves.last_mut() {
        thin(last, most);
    }
    Ok(curves)
}

/// Thins out the steps evenly, keeping the first and the last one.
fn thin(curve: &mut RestCurve, most: usize) {
    let places = super::evenly(curve.time_s.len(), most);
    let RestCurve { time_s, probability, low, high, .. } = curve;
    for values in [time_s, probability, low, high] {
        *values = places.iter().filter_map(|&place| values.get(place).copied()).collect();
    }
}
