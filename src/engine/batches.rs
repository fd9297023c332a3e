//! Batches: runs that are computed without asking in between whether more are needed.

use super::Shard;
use crate::analysis::{PointAccumulator, StoppingRule};
use crate::study::{Point, Study};

/// Runs that are computed together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RunBatch {
    which: Which,
    /// How many they are.
    pub runs: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Which {
    /// Those of a shard.
    Of(Shard),
    /// Those that follow one another from this one.
    From(u64),
}

impl RunBatch {
    /// The number of a run of the batch, counted from zero.
    pub fn run_id(&self, index: u64) -> u64 {
        match self.which {
            Which::Of(shard) => shard.number(index),
            Which::From(first) => first + index,
        }
    }
}

/// The batches of a shard: a single one with all its runs; or, where the study has a precision, as many
/// of each of its points as that takes, one point after another.
pub(super) struct Batches<'a> {
    study: &'a Study,
    shard: Shard,
    /// How many of its points (or batches) have begun.
    begun: u64,
    /// The point that is sampled and how many of its runs are in batches so far.
    point: Option<(Point, u64)>,
    most: u64,
}

impl<'a> Batches<'a> {
    /// The batches of a shard of a study.
    pub fn new(study: &'a Study, shard: Shard) -> Self {
        Batches { study, shard, begun: 0, point: None, most: shard.most_runs(study) }
    }

    /// The most runs that all batches together can have, as far as is known by now.
    pub fn most_runs(&self) -> u64 {
        self.most
    }

    /// The next batch, if there is one; `so_far` has all runs of the last batch's point.
    pub fn next(&mut self, so_far: Option<&PointAccumulator>) -> Option<RunBatch> {
        let Some(precision) = self.study.precision() else {
            let batch = RunBatch { which: Which::Of(self.shard), runs: self.most };
            self.begun += 1;
            return (self.begun == 1).then_some(batch);
        };
        if let (Some((point, runs)), Some(so_far)) = (&mut self.point, so_far) {
            let rule = StoppingRule {
                half_width: precision.equilibrium_fraction,
                replicate: point.sampling.replicate,
                most: point.sampling.most,
            };
            if let Some(more) = rule.more(*runs, so_far.equilibrium_interval().ends()) {
                let batch = RunBatch { which: Which::From(point.first_run + *runs), runs: more };
                *runs += more;
                return Some(batch);
            }
            self.most -= point.sampling.most - *runs;
        }
        if self.begun == self.shard.fraction(self.study.point_count()) {
            return None;
        }
        let point = self.study.point(self.shard.number(self.begun));
        self.begun += 1;
        let batch = RunBatch { which: Which::From(point.first_run), runs: point.sampling.first };
        self.point = Some((point, batch.runs));
        Some(batch)
    }
}
