//! Blocks of a sweep: the values of a point, computed from its index alone.

use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::plan::precision::Sampling;
use crate::study::plan::run_numbers::RunNumbers;
use crate::study::sampling::sampling_design::Design;
use crate::study::sampling::uncertain_design::UncertainDesign;

/// How a block lists its points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Listing {
    /// Every combination of the columns' values; the last column changes fastest.
    Grid,
    /// Rows with one value of each column.
    Rows,
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
    pub fn factors(&self, columns: &[(Parameter, Vec<ParameterValue>)]) -> Vec<u64> {
        let lengths = columns.iter().map(|(_, values)| values.len() as u64);
        match self {
            Listing::Grid => lengths.collect(),
            Listing::Rows => lengths.take(1).collect(),
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
        let place = self.numbers.of_point(point);
        (&self.samplings[place.kind], self.first_run + place.first_run)
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
                    Listing::Rows => point,
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
