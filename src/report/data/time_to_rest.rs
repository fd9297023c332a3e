//! Curves of `time_to_rest.parquet`: the probability of rest over time.

use crate::table::{Table, TableError};

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
pub fn read(table: &Table, points: &[u64], most: usize) -> Result<Vec<RestCurve>, TableError> {
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
