//! The engine: computes runs on all cores, stores them, shows progress, and handles interruption, resume and shards.
//!
//! The order and place of computation do not affect results: a run is a pure function of the study and its number.

mod batches;
mod chunk_writer;
mod compute;
mod grace_period;
mod interrupt;
mod message;
mod options;
mod output_dir;
mod progress;
mod progress_counts;
mod read_finished;
mod record_motion;
mod run_study;
mod shard;
mod stop;
mod store;
mod worker;
mod worker_pool;

pub use compute::{compute, quietly};
pub use interrupt::{stop_on_signals, survive_file_size_limit};
pub use message::say;
pub use options::EngineOptions;
pub use output_dir::{OutputDir, OutputDirError, Ready};
pub use progress::{Parts, Planned, Progress, Show};
pub use read_finished::{finished_run, read_finished};
pub use record_motion::record;
pub use run_study::{EngineError, RunTotals, Sink, run_study, run_study_with};
pub use shard::{Shard, ShardError};
pub use stop::StopReason;
pub use store::{CHUNKS, Chunk, ChunkFault, Listed, Lock, Store, StoreError, listed_runs};
pub use worker_pool::WorkerPool;
