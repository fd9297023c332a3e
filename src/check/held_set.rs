//! The equilibrium set of a system of one's own: the start positions at which friction holds its contacts, at quasi-random samples.

use rayon::prelude::*;

use super::steady::{HeldPosition, SteadySearch};
use crate::analysis::{REPLICATES, fraction_with_interval, sample_coordinate};

/// The equilibrium set at one point of a sweep.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeldSet {
    /// The number of start positions that were examined.
    pub examined: u64,
    /// The positions that were examined, unless all contacts slide there.
    pub positions: Vec<HeldPosition>,
    /// The fraction of the start positions at which friction holds all contacts that do not slide, with its 95 % interval; `None` if
    /// all contacts slide there.
    pub fraction: Option<(f64, (f64, f64))>,
    /// Which coordinates are angles that go round.
    angular: Vec<bool>,
}

impl HeldSet {
    /// Examines this number of positions in each of the independent scrambles, on the current thread pool.
    pub fn of(search: &SteadySearch<'_>, samples: u32) -> Self {
        let scramble = |replicate: u32| -> Vec<HeldPosition> {
            let place = |index: u32| move |axis: usize| sample_coordinate(axis, replicate, index);
            (0..samples).filter_map(|index| search.position(place(index))).collect()
        };
        let scrambles: Vec<Vec<HeldPosition>> =
            (0..REPLICATES).into_par_iter().map(scramble).collect();
        let is_held = |position: &&HeldPosition| position.is_held();
        let fraction =
            |of: &Vec<HeldPosition>| of.iter().filter(is_held).count() as f64 / f64::from(samples);
        let fractions: Vec<f64> = scrambles.iter().map(fraction).collect();
        let may_hold = scrambles.iter().any(|of| !of.is_empty());
        HeldSet {
            examined: u64::from(REPLICATES) * u64::from(samples),
            positions: scrambles.concat(),
            angular: search.units.outputs.iter().map(|units| units.angular).collect(),
            fraction: may_hold.then(|| fraction_with_interval(&fractions, samples)),
        }
    }

    /// Returns the least and the greatest value of each coordinate in the set, which an angle does not have; none in an empty set.
    pub fn extremes(&self) -> Vec<[f64; 2]> {
        let held = || self.positions.iter().filter(|position| position.is_held());
        let count = held().next().map_or(0, |position| position.coordinates.len());
        let extremes = |place: usize| {
            if self.angular.get(place) == Some(&true) {
                return [f64::NAN; 2];
            }
            let values = held().map(|position| position.coordinates[place]);
            let widen = |[least, most]: [f64; 2], value: f64| [least.min(value), most.max(value)];
            values.fold([f64::INFINITY, f64::NEG_INFINITY], widen)
        };
        (0..count).map(extremes).collect()
    }
}
