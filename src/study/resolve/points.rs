//! The numbers of balls of the points of a sweep, and the validation of swept values that are possible alone but not together.

use crate::model::{InvalidParameter, LawParameter, Lowest, Model};
use crate::study::error::{Fault, StudyError};
use crate::study::file::source::{Source, SourcePath};
use crate::study::file::study_file::StudyFile;
use crate::study::plan::base::Base;
use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::plan::planned_runs::{Plan, Point};
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
            Listing::Zip | Listing::Table => return (one_by_one(&self.columns[place].1, 1), 1),
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
            let path = block.listing.path_of(&format!("sweep[{index}]"), &parameter.name());
            let refuse = |fault| source.path(&path).refuse_key(fault);
            base.check_varied(*parameter).map_err(refuse)?;
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

/// The largest number of points that are checked; in a larger sweep, the runs of an impossible
/// point fail.
const MAX_CHECKED_POINTS: u64 = 100_000;

/// Validates the points of a sweep.
pub(in crate::study) fn check_points(source: &Source, plan: &Plan) -> Result<(), StudyError> {
    let law = plan.base.model.friction();
    let depends = |parameter: &LawParameter| parameter.lowest == Lowest::FrictionCoefficient;
    let joined = |name: &str| name.contains("friction_coefficient");
    let drawn = plan.uncertain.iter().any(|column| joined(&column.name));
    if drawn
        || !law.law().parameters().iter().any(depends)
        || plan.point_count() > MAX_CHECKED_POINTS
    {
        return Ok(());
    }
    for point_id in 0..plan.point_count() {
        let point = plan.point(point_id);
        if let Err(invalid) = point.model().validate() {
            let columns = plan.swept.iter().zip(&point.swept);
            let values: Vec<String> = columns
                .filter(|(column, _)| joined(&column.name))
                .map(|(column, value)| format!("{} {value}", column.name))
                .collect();
            let InvalidParameter { name, found, allowed } = invalid;
            let found = format!("{name} {found} at point {point_id} ({})", values.join(", "));
            let fault = Fault::new("no physical meaning", found, allowed);
            return Err(path(source, plan, &point, &name).refuse_value(fault));
        }
    }
    Ok(())
}

/// Returns the key path at which the sweep sets this parameter, or otherwise another coefficient.
fn path<'a>(source: &'a Source, plan: &Plan, point: &Point, name: &str) -> SourcePath<'a> {
    let index = plan.blocks.partition_point(|block| block.first_point <= point.point_id) - 1;
    let block = &plan.blocks[index];
    let local = point.point_id - block.first_point;
    let values = block.values(local);
    let named = |wanted: &dyn Fn(&str) -> bool| {
        block.columns.iter().find(|(parameter, _)| wanted(&parameter.name()))
    };
    let column = named(&|other| other == name)
        .or_else(|| named(&|other| other.contains("friction_coefficient")));
    let Some((parameter, list)) = column else { return source.path("sweep").item(index) };
    let value = values.iter().find(|(other, _)| other == parameter).map(|(_, value)| value);
    let place = match block.listing {
        Listing::Grid => list.iter().position(|other| Some(other) == value),
        Listing::Zip => usize::try_from(local).ok(),
        Listing::Table => None,
    };
    let path = block.listing.path_of(&format!("sweep[{index}]"), &parameter.name());
    place.map_or(source.path(&path), |place| source.path(&path).item(place))
}
