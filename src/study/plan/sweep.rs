//! Blocks of a sweep: the values of a point and the numbers of its runs, computed from its index alone. Points of one kind of
//! sampling have equally many runs, and the kinds follow one another in a pattern that repeats over the points.

use std::iter::once;
use std::ops::Range;

use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::plan::precision::Sampling;
use crate::study::sampling::sampling_design::Design;
use crate::study::sampling::uncertain_design::UncertainDesign;

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

    /// Returns the index of the kind of sampling of a point, and the number of its first run.
    pub fn of_point(&self, point: u64) -> (usize, u64) {
        let (repeat, point) = (point / self.points.max(1), point % self.points.max(1));
        let index = self.pattern.partition_point(|stretch| stretch.first_point <= point);
        let place = |stretch: &Stretch| {
            let before = (point - stretch.first_point) * stretch.runs_per_point;
            (stretch.kind, repeat * self.runs + stretch.first_run + before)
        };
        // A block has points, so that its pattern has a stretch.
        let stretch = self.pattern.get(index.saturating_sub(1));
        stretch.map_or((0, 0), place)
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

/// How a block lists its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Listing {
    /// Every combination of the columns' values; the last column changes fastest.
    Grid,
    /// Lists of equal length; a point has one value of each.
    Zip,
    /// A table with one point per row.
    Table,
}

/// The sampling of the runs of a point.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PointSampling {
    /// Sampling of start states.
    pub design: Design,
    /// Sampling of the uncertain parameters.
    pub uncertain_design: UncertainDesign,
    /// Number of runs.
    pub sampling: Sampling,
}

/// A block of points that share swept parameters and, for each number of balls, a sampling design.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    /// How the points are listed.
    pub listing: Listing,
    /// Swept parameters with their values.
    pub columns: Vec<(Parameter, Vec<ParameterValue>)>,
    /// The kinds of sampling of its points, one for each number of balls.
    pub samplings: Vec<PointSampling>,
    /// The points and runs with their kind of sampling.
    pub numbers: RunNumbers,
    /// Number of the block's first point.
    pub first_point: u64,
    /// Number of the block's first run.
    pub first_run: u64,
}

impl Listing {
    /// Returns the factors whose product is the number of points.
    pub fn factors(self, columns: &[(Parameter, Vec<ParameterValue>)]) -> Vec<u64> {
        let lengths = columns.iter().map(|(_, values)| values.len() as u64);
        match self {
            Listing::Grid => lengths.collect(),
            Listing::Zip | Listing::Table => lengths.take(1).collect(),
        }
    }

    /// Returns the path of a swept parameter below the path of its block: the parameter's own key, or the table.
    pub fn path_of(self, block: &str, parameter: &str) -> String {
        match self {
            Listing::Grid => format!("{block}.grid.{parameter}"),
            Listing::Zip => format!("{block}.zip.{parameter}"),
            Listing::Table => format!("{block}.table"),
        }
    }
}

impl Block {
    /// Returns the number of the point after the last one.
    pub fn end_point(&self) -> u64 {
        self.first_point + self.numbers.point_count()
    }

    /// Returns the number of the run after the last one.
    pub fn end_run(&self) -> u64 {
        self.first_run + self.numbers.run_count()
    }

    /// Returns the sampling of a point, counted from the block's first point, and the number of its first run in the
    /// study.
    pub fn sampling_of(&self, point: u64) -> (&PointSampling, u64) {
        let (kind, first_run) = self.numbers.of_point(point);
        (&self.samplings[kind], self.first_run + first_run)
    }

    /// Returns the smallest number of runs: those before the first decision at each point.
    pub fn least_runs(&self) -> u64 {
        let points = self.numbers.points_by_kind(self.samplings.len());
        points.iter().zip(&self.samplings).map(|(points, kind)| points * kind.sampling.first).sum()
    }

    /// Returns the values of a parameter if the block sweeps it.
    pub fn list(&self, parameter: Parameter) -> Option<&[ParameterValue]> {
        let column = self.columns.iter().find(|(other, _)| *other == parameter);
        column.map(|(_, values)| values.as_slice())
    }

    /// Returns the swept values at a point, counted from the block's first point.
    pub fn values(&self, point: u64) -> Vec<(Parameter, ParameterValue)> {
        let mut rest = point;
        let mut values: Vec<(Parameter, ParameterValue)> = self
            .columns
            .iter()
            .rev()
            .filter_map(|(parameter, values)| {
                let length = (values.len() as u64).max(1);
                let index = match self.listing {
                    Listing::Zip | Listing::Table => point,
                    Listing::Grid => {
                        let index = rest % length;
                        rest /= length;
                        index
                    }
                };
                let value = usize::try_from(index).ok().and_then(|index| values.get(index))?;
                Some((*parameter, *value))
            })
            .collect();
        values.reverse();
        values
    }
}

/// Returns the product of counts, or its floating-point value if it is above the limit.
pub(crate) fn product(factors: &[u64], limit: u64) -> Result<u64, f64> {
    let exact = factors.iter().try_fold(1_u64, |product, factor| product.checked_mul(*factor));
    match exact {
        Some(exact) if exact <= limit => Ok(exact),
        _ => Err(factors.iter().map(|factor| *factor as f64).product()),
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
            assert_eq!(numbers.of_point(point), (*kind, first_run));
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
