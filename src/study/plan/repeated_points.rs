//! Points of a sweep that a study lists more than once.

use std::collections::HashMap;

use crate::study::plan::parameter::ParameterValue;
use crate::study::plan::planned_runs::Plan;
use crate::study::sampling::sampling_design::Design;

/// The largest number of points that are compared.
const MOST_POINTS: u64 = 20_000;

/// Points with the parameters and the sampling design of an earlier point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RepeatedPoints {
    /// The number of such points among those that were compared.
    pub count: u64,
    /// The number of the first such point, and that of the earlier point.
    pub first: [u64; 2],
    /// The key of the block of the sweep that contains the first such point.
    pub key: String,
}

impl Plan {
    /// Returns the points that repeat an earlier point, if there are any.
    pub fn repeated_points(&self) -> Option<RepeatedPoints> {
        // Adding 0 turns -0 into 0.
        let key = |value: &ParameterValue| match value {
            ParameterValue::Number(number) => Ok((number + 0.0).to_bits()),
            ParameterValue::Text(text) => Err(*text),
        };
        let mut seen: HashMap<Vec<Result<u64, &'static str>>, u64> = HashMap::new();
        let mut found: Option<RepeatedPoints> = None;
        for point_id in 0..self.point_count().min(MOST_POINTS) {
            let values = self.point(point_id).swept.iter().map(key).collect();
            let earlier = *seen.entry(values).or_insert(point_id);
            if earlier == point_id || self.design_at(point_id) != self.design_at(earlier) {
                continue;
            }
            let key = format!("sweep[{}]", self.block_of(point_id));
            let first = [point_id, earlier];
            found.get_or_insert(RepeatedPoints { count: 0, first, key }).count += 1;
        }
        found
    }

    fn design_at(&self, point_id: u64) -> &Design {
        let block = &self.blocks[self.block_of(point_id)];
        &block.sampling_of(point_id - block.first_point).0.design
    }
}
