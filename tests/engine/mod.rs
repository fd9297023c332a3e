//! The engine: scheduling does not affect results, and a failed run is a row.

mod audit;
mod continued;
mod exchanged_balls;
mod failures;
pub mod kept;
mod kept_rows;
mod precision;
mod same_bytes;
