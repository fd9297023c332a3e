//! The numbers of balls of the points of a sweep, and the models with the fewest and the most balls.

use crate::model::Model;
use crate::study::error::StudyError;
use crate::study::file::source::Source;
use crate::study::file::study_file::{BlockFile, StudyFile};
use crate::study::plan::base::Base;
use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::plan::sweep::Listing;
use crate::study::resolve::sweep::ResolvedBlock;

impl ResolvedBlock {
    /// Returns the number of balls of each of its consecutive points and, if the numbers repeat, how often. The block has
    /// `points` points, and `balls` balls unless it sweeps their number.
    pub fn numbers_of_balls(&self, points: u64, balls: usize) -> (Vec<(u64, usize)>, u64) {
        let place = self.columns.iter().position(|(parameter, _)| *parameter == Parameter::BALLS);
        let Some(place) = place else { return (vec![(points, balls)], 1) };
        let inner = match self.listing {
            Listing::Grid => self.columns[place + 1..].iter().map(|(_, values)| values.len()),
            Listing::Rows => return (one_by_one(&self.columns[place].1, 1), 1),
        };
        // A product of too many points has an error of its own.
        let inner = inner.fold(1_u64, |product, length| product.saturating_mul(length as u64));
        let pattern = one_by_one(&self.columns[place].1, inner);
        let length = inner.saturating_mul(self.columns[place].1.len() as u64);
        (pattern, points / length.max(1))
    }

    /// Returns the smallest and the largest number of balls of its points; it has `balls` balls unless it sweeps their
    /// number.
    pub fn range_of_balls(&self, balls: usize) -> [usize; 2] {
        let column = self.columns.iter().find(|(parameter, _)| *parameter == Parameter::BALLS);
        let Some((_, values)) = column else { return [balls; 2] };
        let numbers = values.iter().map(whole);
        numbers.fold([usize::MAX, 0], |[least, most], number| [least.min(number), most.max(number)])
    }
}

/// Returns each number of balls with its number of points; equal neighbours are joined.
fn one_by_one(numbers: &[ParameterValue], points: u64) -> Vec<(u64, usize)> {
    let mut pattern: Vec<(u64, usize)> = Vec::new();
    for number in numbers.iter().map(whole) {
        match pattern.last_mut() {
            Some((count, last)) if *last == number => *count = count.saturating_add(points),
            _ => pattern.push((points, number)),
        }
    }
    pattern
}

/// Returns a number of balls; their values are validated as whole numbers.
fn whole(value: &ParameterValue) -> usize {
    match value {
        ParameterValue::Number(number) => *number as usize,
        ParameterValue::Text(_) => 0,
    }
}

/// Returns the base with the smallest and the largest number of balls of all points.
pub(in crate::study) fn base_of_all_points(
    source: &Source,
    blocks: &[ResolvedBlock],
    base: Base,
) -> Result<Base, StudyError> {
    let ranges = blocks.iter().map(|block| block.range_of_balls(base.balls()));
    let range = ranges.reduce(|all, range| [all[0].min(range[0]), all[1].max(range[1])]);
    let base = base.with_balls(range.unwrap_or([base.balls(); 2]));
    for (index, block) in blocks.iter().enumerate() {
        for (parameter, _) in &block.columns {
            base.check_varied(*parameter).map_err(|fault| {
                let path = source.path("sweep").item(index);
                let path = match &block.file {
                    BlockFile { grid: Some(_), .. } => path.key("grid").key(&parameter.name()),
                    BlockFile { zip: Some(_), .. } => path.key("zip").key(&parameter.name()),
                    _ => path.key("table"),
                };
                path.refuse_key(fault)
            })?;
        }
    }
    Ok(base)
}

/// Returns the model with the largest number of balls of the points that have the common design.
pub(in crate::study) fn model_of_common_design(
    written: &StudyFile,
    blocks: &[ResolvedBlock],
    base: &Base,
) -> Model {
    let design = |index: usize| written.sweep.as_ref()?.get(index)?.design.as_ref();
    let sharing = blocks.iter().enumerate().filter(|(index, _)| design(*index).is_none());
    let most = sharing.map(|(_, block)| block.range_of_balls(base.balls())[1]).max();
    most.map_or_else(|| base.model.clone(), |most| base.with_balls([most; 2]).model)
}
