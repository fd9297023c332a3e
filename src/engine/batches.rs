//! Batches: sets of runs that are all computed before it is decided whether more runs are needed.

use super::Shard;
use crate::analysis::{HalfWidths, PointAccumulator};
use crate::study::{Point, Sampling, Study};

/// Runs that are computed together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RunBatch {
    which: BatchRuns,
    /// Number of runs.
    pub runs: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BatchRuns {
    /// The runs of a shard.
    Of(Shard),
    /// Consecutive runs from this number.
    From(u64),
}

impl RunBatch {
    /// Returns the number of the run with this index in the batch.
    pub fn run_id(&self, index: u64) -> u64 {
        match self.which {
            BatchRuns::Of(shard) => shard.number(index),
            BatchRuns::From(first) => first + index,
        }
    }
}

/// The batches of a shard: one batch with all its runs, or, in a study with a precision, as many batches per point
/// as the precision requires, point by point.
pub(super) struct Batches<'a> {
    study: &'a Study,
    shard: Shard,
    /// Number of points (or batches) that have begun.
    begun: u64,
    /// The point that is being sampled, and the number of its runs in batches so far.
    point: Option<(Point, u64)>,
    /// An upper bound of the number of runs of all batches, from what is known so far.
    pub most: u64,
}

impl<'a> Batches<'a> {
    /// Creates the batches of a study's shard.
    pub fn new(study: &'a Study, shard: Shard) -> Self {
        Batches { study, shard, begun: 0, point: None, most: shard.most_runs(study) }
    }

    /// Returns the next batch, if any; `so_far` holds all runs of the point of the last batch.
    pub fn next(&mut self, so_far: Option<&PointAccumulator>) -> Option<RunBatch> {
        let Some(precision) = self.study.precision() else {
            let batch = RunBatch { which: BatchRuns::Of(self.shard), runs: self.most };
            self.begun += 1;
            return (self.begun == 1).then_some(batch);
        };
        if let (Some((point, runs)), Some(so_far)) = (&mut self.point, so_far) {
            let Sampling { replicate, most, .. } = point.sampling;
            if let Some(more) = HalfWidths::from(precision).more(replicate, most, *runs, so_far) {
                let batch =
                    RunBatch { which: BatchRuns::From(point.first_run + *runs), runs: more };
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
        let batch =
            RunBatch { which: BatchRuns::From(point.first_run), runs: point.sampling.first };
        self.point = Some((point, batch.runs));
        Some(batch)
    }
}
