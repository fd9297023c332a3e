//! How a study is computed: threads, chunks, the shard, and when to stop early.

use std::time::Instant;

use super::Shard;

/// How a study is computed. None of it changes a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EngineOptions {
    /// Worker threads; at least one is used.
    pub threads: usize,
    /// Runs computed before they are handed on, and kept in one file; at least one.
    pub chunk: usize,
    /// The part of the study to compute.
    pub shard: Shard,
    /// When to begin no further run; those in progress are given up a second later.
    pub deadline: Option<Instant>,
    /// How many runs may fail before no further run is begun; any number if none.
    pub most_failed: Option<u64>,
    /// Whether finished runs that failed are computed again, from the same case.
    pub retry_failed: bool,
}

impl Default for EngineOptions {
    /// The whole study on one thread, to its end.
    fn default() -> Self {
        let (deadline, most_failed, retry_failed) = (None, None, false);
        EngineOptions {
            threads: 1,
            chunk: 1024,
            shard: Shard::WHOLE,
            deadline,
            most_failed,
            retry_failed,
        }
    }
}
