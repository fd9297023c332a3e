//! Validation of swept values that are possible alone but not together at a point.
//!
//! Only the Stribeck law has such values: its static friction coefficient is at least the kinetic
//! one. If one of the two is random, the draws decide, and a run with an impossible draw fails.

use crate::model::{InvalidParameter, LawParameter, Lowest};
use crate::study::error::{Fault, StudyError};
use crate::study::file::source_path::SourcePath;
use crate::study::file::study_file::{BlockFile, StudyFile};
use crate::study::file::yaml_tree::Source;
use crate::study::plan::planned_runs::{Plan, Point};
use crate::study::plan::sweep::Listing;

/// The largest number of points that are checked; in a larger sweep, the runs of an impossible
/// point fail.
const MAX_CHECKED_POINTS: u64 = 100_000;

/// Validates the points of a sweep.
pub(in crate::study) fn check_points(
    source: &Source,
    written: &StudyFile,
    plan: &Plan,
) -> Result<(), StudyError> {
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
            return Err(path(source, written, plan, &point, &name).refuse_value(fault));
        }
    }
    Ok(())
}

/// Returns the key path at which the sweep sets this parameter, or otherwise another coefficient.
fn path<'a>(
    source: &'a Source,
    written: &StudyFile,
    plan: &Plan,
    point: &Point,
    name: &str,
) -> SourcePath<'a> {
    let index = plan.blocks.partition_point(|block| block.first_point <= point.point_id) - 1;
    let block = &plan.blocks[index];
    let path = source.path("sweep").item(index);
    let listing = match written.sweep.as_deref().and_then(|blocks| blocks.get(index)) {
        Some(BlockFile { grid: Some(_), .. }) => path.key("grid"),
        Some(BlockFile { zip: Some(_), .. }) => path.key("zip"),
        _ => return path.key("table"),
    };
    let local = point.point_id - block.first_point;
    let values = block.values(local);
    let named = |wanted: &dyn Fn(&str) -> bool| {
        block.columns.iter().find(|(parameter, _)| wanted(&parameter.name()))
    };
    let column = named(&|other| other == name)
        .or_else(|| named(&|other| other.contains("friction_coefficient")));
    let Some((parameter, list)) = column else { return listing };
    let value = values.iter().find(|(other, _)| other == parameter).map(|(_, value)| value);
    let place = match block.listing {
        Listing::Rows => usize::try_from(local).ok(),
        Listing::Grid => list.iter().position(|other| Some(other) == value),
    };
    let path = listing.key(&parameter.name());
    place.map_or(path.clone(), |place| path.item(place))
}
