//! A motion that a table gives over time: a cubic spline through its rows. Its speed is zero at the first and at the last row, and
//! it keeps its last value.

use serde::Serialize;

/// The number of coefficients of a cubic polynomial.
const CUBIC: usize = 4;

/// A motion through the rows of a table, in SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GivenMotion {
    /// Time and value of each row. Times grow from 0.
    rows: Vec<[f64; 2]>,
    /// The slope at each row.
    #[serde(skip)]
    slopes: Vec<f64>,
}

impl GivenMotion {
    /// Creates the motion through two or more rows, whose times grow from 0.
    pub fn new(rows: Vec<[f64; 2]>) -> Self {
        // The second derivatives at a row are equal from both sides: a tridiagonal system of the slopes (C. de Boor, A Practical
        // Guide to Splines, 1978, chapter IV), solved from the first row on.
        let lengths: Vec<f64> = rows.windows(2).map(|two| two[1][0] - two[0][0]).collect();
        let changes = rows.windows(2).map(|two| two[1][1] - two[0][1]);
        let chords: Vec<f64> =
            changes.zip(&lengths).map(|(change, length)| change / length).collect();
        let (count, inner) = (rows.len(), 1..rows.len().saturating_sub(1));
        let (mut slopes, mut factors) = (vec![0.0; count], vec![0.0; count]);
        for row in inner.clone() {
            let [before, after] = [1.0 / lengths[row - 1], 1.0 / lengths[row]];
            let right = 3.0 * (chords[row - 1] * before + chords[row] * after);
            let pivot = 2.0 * (before + after) - before * factors[row - 1];
            factors[row] = after / pivot;
            slopes[row] = (right - before * slopes[row - 1]) / pivot;
        }
        for row in inner.rev() {
            slopes[row] -= factors[row] * slopes[row + 1];
        }
        GivenMotion { rows, slopes }
    }

    /// Returns time in s and value of each row.
    pub fn rows(&self) -> &[[f64; 2]] {
        &self.rows
    }

    /// Returns the times of its rows, s.
    pub fn times_s(&self) -> impl Iterator<Item = f64> + '_ {
        self.rows.iter().map(|row| row[0])
    }

    /// Returns the value that it keeps at last.
    pub fn last(&self) -> f64 {
        self.rows.last().map_or(0.0, |row| row[1])
    }

    /// Returns the coefficients of the motion as a polynomial of the time since an instant, until the next row: four, or one after
    /// the last row.
    pub fn terms_from(&self, time_s: f64) -> Vec<f64> {
        let begun = self.rows.partition_point(|row| row[0] <= time_s);
        let (Some(row), Some(next)) = (begun.checked_sub(1), self.rows.get(begun)) else {
            return vec![self.last()];
        };
        let [[begin, value], slopes] = [self.rows[row], [self.slopes[row], self.slopes[begun]]];
        let length = next[0] - begin;
        let chord = (next[1] - value) / length;
        let curved = (3.0 * chord - 2.0 * slopes[0] - slopes[1]) / length;
        let third = (slopes[0] + slopes[1] - 2.0 * chord) / (length * length);
        shifted([value, slopes[0], curved, third], time_s - begin).to_vec()
    }

    /// Returns the value at a time.
    pub fn at(&self, time_s: f64) -> f64 {
        self.terms_from(time_s)[0]
    }
}

/// Returns the coefficients of a polynomial of a time as those of a time that begins later.
pub(super) fn shifted(terms: [f64; CUBIC], later: f64) -> [f64; CUBIC] {
    let [value, slope, second, third] = terms;
    [
        value + later * (slope + later * (second + later * third)),
        slope + later * (2.0 * second + 3.0 * later * third),
        second + 3.0 * later * third,
        third,
    ]
}

#[cfg(test)]
mod tests {
    use super::GivenMotion;

    /// A spline reproduces a cubic polynomial with these ends, and is twice continuously differentiable.
    #[test]
    fn a_spline_is_smooth_and_exact_for_a_cubic() {
        let smooth = |time: f64| time * time * (3.0 - 2.0 * time);
        let rows = [0.0, 0.2, 0.3, 0.75, 1.0].map(|time| [time, 5.0 - smooth(time)]);
        let motion = GivenMotion::new(rows.to_vec());
        for time in [0.0, 0.1, 0.25, 0.5, 0.9, 1.0, 3.0] {
            let expected = 5.0 - smooth(f64::min(time, 1.0));
            assert!((motion.at(time) - expected).abs() < 1e-14, "{time}");
        }
        let rows = vec![[0.0, 1.0], [0.5, 3.0], [0.7, -1.0], [2.0, 0.5]];
        let motion = GivenMotion::new(rows.clone());
        for row in &rows[1..3] {
            let [before, after] = [row[0] - 1e-9, row[0]].map(|time| motion.terms_from(time));
            for (place, bound) in [1e-7, 1e-5, 1e-5].into_iter().enumerate() {
                assert!((before[place] - after[place]).abs() < bound, "{before:?} {after:?}");
            }
            assert_eq!(after[0].to_bits(), row[1].to_bits());
        }
        assert_eq!(
            [motion.terms_from(0.0)[1], motion.terms_from(2.0 - 1e-12)[1].round()],
            [0.0; 2]
        );
        assert_eq!(motion.terms_from(2.0), [0.5]);
    }
}
