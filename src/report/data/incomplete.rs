//! The points of a study whose runs are not all finished.

use std::collections::HashMap;

use crate::engine::Shard;
use crate::study::Study;
use crate::table::{Manifest, Table, TableError};

/// The largest number of ranges of points that a sentence lists.
const MOST_RANGES: usize = 6;

/// The points whose runs are not all finished.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct IncompletePoints {
    /// The first and the last number of consecutive points, ascending.
    ranges: Vec<[u64; 2]>,
}

impl IncompletePoints {
    /// Compares `points.parquet` with the plan of the study; a complete study has no such points. With a precision, a
    /// point is complete if it has reached the precision or the largest number of runs.
    ///
    /// # Errors
    /// Returns an error if the table lacks a column or cannot be read.
    pub fn read(study: &Study, manifest: &Manifest, points: &Table) -> Result<Self, TableError> {
        let mut incomplete = IncompletePoints::default();
        let shard: Option<Shard> = manifest.shard.parse().ok();
        let Some(shard) = shard.filter(|_| !manifest.complete) else { return Ok(incomplete) };
        let mut finished = HashMap::new();
        points.for_each(|row| {
            let known = row.count("point_id").zip(row.count("runs"));
            let precise = row.truth("precision_reached") == Some(true);
            finished.extend(known.map(|(point, runs)| (point, (runs, precise))));
        })?;
        for point in 0..study.point_count() {
            let planned = runs_of_point(study, shard, point);
            let (runs, precise) = finished.get(&point).copied().unwrap_or((0, false));
            if runs < planned && !precise {
                incomplete.add(point);
            }
        }
        Ok(incomplete)
    }

    fn add(&mut self, point: u64) {
        match self.ranges.last_mut() {
            Some([_, last]) if *last + 1 == point => *last = point,
            _ => self.ranges.push([point; 2]),
        }
    }

    /// Returns the number of these points.
    pub fn count(&self) -> u64 {
        self.ranges.iter().map(|[first, last]| last - first + 1).sum()
    }

    /// Returns a sentence part, as `points 4 and 5 are incomplete`; `None` if there are no such points.
    pub fn words(&self) -> Option<String> {
        let range = |[first, last]: &[u64; 2]| match last - first {
            0 => vec![first.to_string()],
            1 => vec![first.to_string(), last.to_string()],
            _ => vec![format!("{first} to {last}")],
        };
        let shown = &self.ranges[..self.ranges.len().min(MOST_RANGES)];
        let mut names: Vec<String> = shown.iter().flat_map(range).collect();
        let listed: u64 = shown.iter().map(|[first, last]| last - first + 1).sum();
        match self.count() - listed {
            0 => {}
            1 => names.push("one more".to_owned()),
            more => names.push(format!("{more} more")),
        }
        if self.count() == 1 {
            return Some(format!("point {} is incomplete", names.first()?));
        }
        let last = names.pop()?;
        Some(match names.is_empty() {
            true => format!("points {last} are incomplete"),
            false => format!("points {} and {last} are incomplete", names.join(", ")),
        })
    }
}

/// Returns the planned number of runs of a point in a shard; with a precision, the largest number.
fn runs_of_point(study: &Study, shard: Shard, point_id: u64) -> u64 {
    if study.precision().is_some() {
        let is_in_shard = shard.fraction(point_id + 1) > shard.fraction(point_id);
        return if is_in_shard { study.point(point_id).sampling.most } else { 0 };
    }
    let point = study.point(point_id);
    let (first, runs) = (point.first_run, point.sampling.most);
    shard.fraction(first + runs) - shard.fraction(first)
}

#[cfg(test)]
mod tests {
    use super::IncompletePoints;

    fn words(points: &[u64]) -> Option<String> {
        let mut incomplete = IncompletePoints::default();
        points.iter().for_each(|point| incomplete.add(*point));
        assert_eq!(incomplete.count(), points.len() as u64);
        incomplete.words()
    }

    #[test]
    fn points_are_listed_as_ranges() {
        assert_eq!(words(&[]), None);
        assert_eq!(words(&[3]).as_deref(), Some("point 3 is incomplete"));
        assert_eq!(words(&[4, 5]).as_deref(), Some("points 4 and 5 are incomplete"));
        assert_eq!(words(&[4, 5, 6]).as_deref(), Some("points 4 to 6 are incomplete"));
        let some = words(&[0, 3, 4, 5, 9]);
        assert_eq!(some.as_deref(), Some("points 0, 3 to 5 and 9 are incomplete"));
        let many = words(&[0, 2, 4, 6, 8, 10, 12, 14]);
        assert_eq!(many.as_deref(), Some("points 0, 2, 4, 6, 8, 10 and 2 more are incomplete"));
    }
}
