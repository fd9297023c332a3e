//! The engine: scheduling does not affect results, and a failed run is a row.

mod abandoned_work;
mod audit;
mod chunk;
mod exchanged_balls;
mod extended_runs;
mod failures;
pub mod in_memory;
mod messages;
mod numbers_of_balls;
mod precision;
mod same_bytes;
mod shard;
