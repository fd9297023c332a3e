//! The engine: computes runs on all cores, stores them, shows progress, and handles interruption, resume and shards.
//!
//! The order and place of computation do not affect results: a run is a pure function of the study and its number.
//!
//! Read `compute` first: it computes one run, also with its motion, or many in lockstep. `batches` says which runs come
//! next, and `store` keeps finished runs. `progress_counts`, `watch` and `progress` show how far a computation is;
//! `interrupt` and `stop` end it early. A `worker` computes runs, `chunk_writer` passes them on to the store, and a
//! `worker_pool` has the workers. `run_study` combines all of these.
//!
//! Directories of results follow: `output_dir` prepares the directory of a study. `exclusive_directory` is for commands
//! that fill a directory once, and `continued_directory` for commands that continue one. `results_study` reads the
//! study of a directory. `readable_results` reads the finished runs and makes tables of them.

mod batches;
mod chunk_writer;
mod command_error;
mod compute;
mod continued_directory;
mod exclusive_directory;
mod interrupt;
mod message;
mod options;
mod output_dir;
mod progress;
mod progress_counts;
mod readable_results;
mod results_study;
mod run_study;
mod stop;
mod store;
mod watch;
mod worker;
mod worker_pool;

pub use command_error::CommandError;
pub use compute::{MOST_INSTANTS, compute, quietly, record};
pub use continued_directory::ContinuedDirectory;
pub use exclusive_directory::ExclusiveDirectory;
pub use interrupt::{stop_on_signals, survive_file_size_limit};
pub use message::{say, show_messages};
pub use options::EngineOptions;
pub use output_dir::{OutputDir, PreparedDirectory};
pub use progress::{Planned, Progress, ProgressDisplay};
pub use progress_counts::{Parts, Snapshot};
pub use readable_results::{ReadableResults, finished_run, how_to_continue, readable_results};
pub use results_study::{begun_study, results_study};
pub use run_study::{RunTotals, run_study, run_study_with};
pub use stop::StopReason;
pub use store::{CHUNKS, Chunk, ChunkFault, ListedChunk, Lock, Store, StoreError, listed_runs};
pub use watch::Watch;
pub use worker_pool::WorkerPool;

pub use crate::table::{Shard, ShardError, Sink};
