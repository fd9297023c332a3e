//! The engine: computes runs on all cores, stores them, shows progress, and handles interruption, resume and shards.
//!
//! The order and place of computation do not affect results: a run is a pure function of the study and its number.
//!
//! Read `compute` first: it computes one run, also with its motion, or many in lockstep. `batches` says which runs come
//! next, and `store` keeps finished runs. `progress_counts` and `progress` show how far a computation is; `stop`
//! ends it early. The workers of a `worker_pool` compute runs, and `chunk_writer` passes them on to the store. `run_study`
//! combines all of these.
//!
//! Directories of results follow: `output_dir` prepares the directory of a study, and `command_directory` those of other
//! commands. `readable_results` reads the study of a directory and its finished runs, and makes tables of them.

mod batches;
mod chunk_writer;
mod command_directory;
mod command_error;
mod compute;
mod message;
mod output_dir;
mod progress;
mod progress_counts;
mod readable_results;
mod run_study;
mod stop;
mod store;
mod worker_pool;

pub use command_directory::{ContinuedDirectory, ExclusiveDirectory};
pub use command_error::CommandError;
pub use compute::{MOST_INSTANTS, compute, quietly, record};
pub use message::{say, show_messages};
pub use output_dir::{OutputDir, PreparedDirectory};
pub use progress::{Planned, Progress, ProgressDisplay};
pub use progress_counts::{Parts, Snapshot, Watch};
pub use readable_results::{
    ReadableResults, begun_study, finished_run, how_to_continue, readable_results, results_study,
};
pub use run_study::{RunTotals, run_study, run_study_with};
pub use stop::{EngineOptions, StopReason, stop_on_signals, survive_file_size_limit};
pub use store::{CHUNKS, Chunk, ChunkFault, ListedChunk, Lock, Store, StoreError, listed_runs};
pub use worker_pool::WorkerPool;

pub use crate::table::{Shard, ShardError, Sink};
