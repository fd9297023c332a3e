//! The numbers of the runs of a block: points of one kind of sampling have equally many runs, and the kinds follow one
//! another in a pattern that repeats over the points.

use std::iter::once;
use std::ops::Range;

/// Consecutive points of the pattern with one kind of sampling.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    /// Number of its first point in the pattern.
    first_point: u64,
    /// Number of its first run in the pattern.
    first_run: u64,
    /// Number of its points.
    points: u64,
    /// Number of runs at each of its points.
    runs_per_point: u64,
    /// Index of the kind of sampling.
    kind: usize,
}

/// Points and runs of a block, counted from its first ones.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::study) struct RunNumbers {
    pattern: Vec<Stretch>,
    /// Number of points of the pattern.
    points: u64,
    /// Number of runs of the pattern.
    runs: u64,
    /// How often the pattern occurs.
    repeats: u64,
}

/// A point of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::study) struct PlaceOfPoint {
    /// Index of its kind of sampling.
    pub kind: usize,
    /// Number of its first run.
    pub first_run: u64,
}

impl RunNumbers {
    /// Numbers the runs of `repeats` patterns, whose points are given as numbers of consecutive points with the index of
    /// their kind of sampling; `runs_of` has the number of runs at a point of each kind. Returns the approximate number
    /// of all runs as an error if there are more than `limit`.
    pub fn new(
        pattern: &[(u64, usize)],
        repeats: u64,
        runs_of: &[u64],
        limit: u64,
    ) -> Result<RunNumbers, f64> {
        let runs_per_point = |kind: usize| runs_of.get(kind).copied().unwrap_or(0);
        let each =
            pattern.iter().map(|(points, kind)| *points as f64 * runs_per_point(*kind) as f64);
        let about = each.sum::<f64>() * repeats as f64;
        let mut numbers = RunNumbers { pattern: Vec::new(), points: 0, runs: 0, repeats };
        let exact = pattern.iter().try_for_each(|&(points, kind)| {
            let (first_point, first_run) = (numbers.points, numbers.runs);
            let runs_per_point = runs_per_point(kind);
            numbers.points = first_point.checked_add(points)?;
            numbers.runs = first_run.checked_add(points.checked_mul(runs_per_point)?)?;
            let stretch = Stretch { first_point, first_run, points, runs_per_point, kind };
            numbers.pattern.push(stretch);
            Some(())
        });
        let total = exact.and_then(|()| numbers.runs.checked_mul(repeats));
        total.filter(|runs| *runs <= limit).map(|_| numbers).ok_or(about)
    }

    /// Returns the number of all points.
    pub fn point_count(&self) -> u64 {
        self.points * self.repeats
    }

    /// Returns the number of all runs.
    pub fn run_count(&self) -> u64 {
        self.runs * self.repeats
    }

    /// Returns the kind and the first run of a point.
    pub fn of_point(&self, point: u64) -> PlaceOfPoint {
        let (repeat, point) = (point / self.points.max(1), point % self.points.max(1));
        let index = self.pattern.partition_point(|stretch| stretch.first_point <= point);
        let place = |stretch: &Stretch| PlaceOfPoint {
            kind: stretch.kind,
            first_run: repeat * self.runs
                + stretch.first_run
                + (point - stretch.first_point) * stretch.runs_per_point,
        };
        // A block has points, so that its pattern has a stretch.
        let stretch = self.pattern.get(index.saturating_sub(1));
        stretch.map_or(PlaceOfPoint { kind: 0, first_run: 0 }, place)
    }

    /// Returns the point of a run.
    pub fn point_of(&self, run: u64) -> u64 {
        let (repeat, run) = (run / self.runs.max(1), run % self.runs.max(1));
        let index = self.pattern.partition_point(|stretch| stretch.first_run <= run);
        let point = |stretch: &Stretch| {
            stretch.first_point + (run - stretch.first_run) / stretch.runs_per_point.max(1)
        };
        repeat * self.points + self.pattern.get(index.saturating_sub(1)).map_or(0, point)
    }

    /// Returns the number of points of each kind, of `kinds` kinds.
    pub fn points_by_kind(&self, kinds: usize) -> Vec<u64> {
        let mut points = vec![0; kinds];
        for stretch in &self.pattern {
            points[stretch.kind] += stretch.points * self.repeats;
        }
        points
    }

    /// Returns ranges of points with equally many runs at each point, with this number.
    pub fn ranges(&self) -> Box<dyn Iterator<Item = (Range<u64>, u64)> + '_> {
        let first = self.pattern.first().map_or(0, |stretch| stretch.runs_per_point);
        if self.pattern.iter().all(|stretch| stretch.runs_per_point == first) {
            return Box::new(once((0..self.point_count(), first)));
        }
        Box::new((0..self.repeats).flat_map(move |repeat| {
            self.pattern.iter().map(move |stretch| {
                let begin = repeat * self.points + stretch.first_point;
                (begin..begin + stretch.points, stretch.runs_per_point)
            })
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::RunNumbers;

    /// Counts points and runs one by one.
    #[test]
    fn points_and_runs_have_consecutive_numbers() {
        let pattern = [(2, 0), (1, 2), (3, 1), (1, 0)];
        let runs_of = [3, 1, 4];
        let numbers = RunNumbers::new(&pattern, 3, &runs_of, 1000).expect("few runs");
        assert_eq!((numbers.point_count(), numbers.run_count()), (21, 48));
        let kinds: Vec<usize> = [0, 0, 2, 1, 1, 1, 0].repeat(3);
        let mut first_run = 0;
        for (point, kind) in (0..).zip(&kinds) {
            let place = numbers.of_point(point);
            assert_eq!((place.kind, place.first_run), (*kind, first_run));
            for _ in 0..runs_of[*kind] {
                assert_eq!(numbers.point_of(first_run), point);
                first_run += 1;
            }
        }
        assert_eq!(numbers.points_by_kind(3), [9, 9, 3]);
        let ranges: Vec<u64> =
            numbers.ranges().flat_map(|(points, runs)| points.map(move |_| runs)).collect();
        assert_eq!(ranges, kinds.iter().map(|kind| runs_of[*kind]).collect::<Vec<u64>>());
    }

    #[test]
    fn equal_numbers_of_runs_are_one_range() {
        let numbers = RunNumbers::new(&[(1, 0), (1, 1)], 500_000_000, &[1, 1], u64::MAX);
        let numbers = numbers.expect("below the limit");
        assert_eq!(numbers.ranges().collect::<Vec<_>>(), [(0..1_000_000_000, 1)]);
    }

    #[test]
    fn too_many_runs_have_an_approximate_number() {
        let many = |pattern: &[(u64, usize)], repeats| {
            RunNumbers::new(pattern, repeats, &[10, u64::MAX], 1_000_000).map(|_| ())
        };
        assert_eq!(many(&[(100_000, 0)], 1), Ok(()));
        assert_eq!(many(&[(100_001, 0)], 1), Err(1_000_010.0));
        assert_eq!(many(&[(1, 0), (2, 1)], 4), Err(8.0 * u64::MAX as f64));
        assert_eq!(many(&[(1, 0)], u64::MAX), Err(10.0 * u64::MAX as f64));
    }
}
