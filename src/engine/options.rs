//! How a study is computed: threads, chunks, the shard, and when to stop early.

use std::time::Instant;

use super::Shard;

/// How a study is computed. No option changes a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EngineOptions {
    /// Number of worker threads; at least one is used.
    pub threads: usize,
    /// Number of runs in one part of a batch and in one chunk file; at least one.
    pub chunk: usize,
    /// The part of the study to compute.
    pub shard: Shard,
    /// The time from which no further run begins; runs in progress are abandoned a second later.
    pub deadline: Option<Instant>,
    /// The number of failed runs above which no further run begins; no limit if `None`.
    pub most_failed: Option<u64>,
    /// Whether failed runs are computed again, from the same case.
    pub retry_failed: bool,
}

impl Default for EngineOptions {
    /// Returns options for the whole study on one thread, without limits.
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
