//! A part of a study: every `N`-th run, so that parts cost about the same; or every `N`-th point, where
//! all runs of a point are needed to decide how many there should be.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use thiserror::Error;

use crate::study::Study;

/// Part `K` of `N`: the runs whose number leaves the remainder `K - 1` when divided by `N`; in a study
/// with a precision, the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    part: u64,
    parts: u64,
}

/// A shard that does not exist.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("found {0:?}, allowed: K/N with whole numbers 1 ≤ K ≤ N, such as 2/8")]
pub struct ShardError(String);

impl Shard {
    /// The whole study.
    pub const WHOLE: Shard = Shard { part: 1, parts: 1 };

    /// How many of so many runs, or points, it has.
    pub fn share(self, all: u64) -> u64 {
        let before = self.part - 1;
        if all <= before { 0 } else { (all - before).div_ceil(self.parts) }
    }

    /// The number of its run, or point, `index`; `index` below [`Shard::share`].
    pub fn number(self, index: u64) -> u64 {
        index * self.parts + self.part - 1
    }

    /// How many parts there are.
    pub fn parts(self) -> u64 {
        self.parts
    }

    /// How many runs of a study it has; with a precision, the most.
    pub fn most_runs(self, study: &Study) -> u64 {
        if study.precision().is_none() {
            return self.share(study.run_count());
        }
        let of_stretch = |(points, runs): (Range<u64>, u64)| {
            (self.share(points.end) - self.share(points.start)) * runs
        };
        study.stretches().map(of_stretch).sum()
    }

    /// The numbers of these runs, in ascending order.
    pub fn run_ids(self, study: &Study) -> impl Iterator<Item = u64> {
        let whole_points = study.precision().is_some();
        let all = if whole_points { study.point_count() } else { study.run_count() };
        (0..self.share(all)).flat_map(move |index| {
            let number = self.number(index);
            if !whole_points {
                return number..number + 1;
            }
            let point = study.point(number);
            point.first_run..point.first_run + point.sampling.most
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

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn shards_have_every_run_once() {
        for parts in [1_u64, 2, 3, 7, 12] {
            for all in [0, 1, 5, 12, 100] {
                let mut ids: Vec<u64> = (1..=parts)
                    .flat_map(|part| {
                        let shard: Shard = format!("{part}/{parts}").parse().unwrap();
                        (0..shard.share(all)).map(move |index| shard.number(index))
                    })
                    .collect();
                ids.sort_unstable();
                assert_eq!(ids, (0..all).collect::<Vec<_>>(), "{parts} parts of {all}");
            }
        }
    }

    #[test]
    fn shards_that_do_not_exist() {
        for wrong in ["3/2", "0/2", "1/0", "2", "a/b", "", "1/2/3", "-1/2", "1.5/2"] {
            let error = wrong.parse::<Shard>().unwrap_err().to_string();
            assert!(
                error.contains(&format!("{wrong:?}")) && error.contains("1 ≤ K ≤ N"),
                "{error}"
            );
        }
    }
}
