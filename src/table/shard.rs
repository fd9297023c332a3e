//! Shards: parts of a study with about equal cost. A shard has one of every `N` runs or, in a study with a precision,
//! one of every `N` points with all their runs.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use thiserror::Error;

use crate::study::{Sampling, Study, mixed};

/// Part `K` of `N`: one of every `N` consecutive runs or, in a study with a precision, one of every `N` points.
///
/// A fixed pseudo-random rule selects the run within each block of `N`. If the place within each block
/// were fixed, one shard could have the same cells of a stratified design at every point, and the runs of these cells
/// may take longer than others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    part: u64,
    parts: u64,
}

/// An invalid shard.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("found {0:?}, allowed: K/N with whole numbers 1 ≤ K ≤ N, such as 2/8")]
pub struct ShardError(String);

impl Shard {
    /// The whole study.
    pub const WHOLE: Shard = Shard { part: 1, parts: 1 };

    /// Returns how many of `all` runs, or points, the shard has.
    pub fn fraction(self, all: u64) -> u64 {
        let blocks = all / self.parts;
        blocks + u64::from(self.place_in(blocks) < all % self.parts)
    }

    /// Returns the number of the shard's run, or point, with this index below [`Shard::fraction`].
    pub fn number(self, index: u64) -> u64 {
        index * self.parts + self.place_in(index)
    }

    /// Returns the shard's place in a block.
    fn place_in(self, block: u64) -> u64 {
        let turn = mixed(block) % self.parts;
        // Both numbers may be close to the largest integer, so their sum could overflow.
        let before = self.part - 1;
        let room = self.parts - turn;
        if before < room { before + turn } else { before - room }
    }

    /// Returns the number of the part, from 1.
    pub fn part(self) -> u64 {
        self.part
    }

    /// Returns the number of parts.
    pub fn parts(self) -> u64 {
        self.parts
    }

    /// Returns the number of runs of the shard; an upper bound for studies with a precision.
    pub fn most_runs(self, study: &Study) -> u64 {
        if study.precision().is_none() {
            return self.fraction(study.run_count());
        }
        let of_range = |(points, runs): (Range<u64>, u64)| {
            (self.fraction(points.end) - self.fraction(points.start)) * runs
        };
        study.point_ranges().map(of_range).sum()
    }

    /// Returns the numbers of all runs of the shard, in ascending order.
    pub fn run_ids(self, study: &Study) -> impl Iterator<Item = u64> {
        self.run_ids_with(study, |sampling| sampling.most)
    }

    /// Returns the numbers of the runs that are computed in any case, in ascending order.
    pub fn first_run_ids(self, study: &Study) -> impl Iterator<Item = u64> {
        self.run_ids_with(study, |sampling| sampling.first)
    }

    fn run_ids_with(
        self,
        study: &Study,
        runs: impl Fn(Sampling) -> u64,
    ) -> impl Iterator<Item = u64> {
        let whole_points = study.precision().is_some();
        let all = if whole_points { study.point_count() } else { study.run_count() };
        (0..self.fraction(all)).flat_map(move |index| {
            let number = self.number(index);
            if !whole_points {
                return number..number + 1;
            }
            let point = study.point(number);
            point.first_run..point.first_run + runs(point.sampling)
        })
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let numbers = text.split_once('/').and_then(|(part, parts)| {
            Some(Shard { part: part.parse().ok()?, parts: parts.parse().ok()? })
        });
        numbers
            .filter(|shard| 1 <= shard.part && shard.part <= shard.parts)
            .ok_or_else(|| ShardError(text.to_owned()))
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}/{}", self.part, self.parts)
    }
}
