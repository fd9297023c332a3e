//! Responses of designs: numbers that an optimiser can trust, with how well each is known.
//!
//! A design is the study with its variables set. Its runs start where those of every other design do
//! and draw the same uncertain parameters, as draws are keyed by names and never by design (common
//! random numbers). Estimates are pure functions of what the runs have shown.

mod amplitude;
mod answer_json;
pub(crate) mod columns;
mod discontinuity;
mod estimate;
mod moments;
mod neighbours;
mod order_statistics;
mod probability;
mod request;
mod respond;
mod respond_to_all;
mod rest_time;

pub use amplitude::{mean, quantile, standard_deviation, worst};
pub use answer_json::to_json;
pub use columns::response_columns;
pub use discontinuity::{MOST_DESIGNS, discontinuous};
pub use estimate::{Estimate, Sample, Seen};
pub use neighbours::Neighbours;
pub use probability::{above, at_rest_by};
pub use request::{Refusal, Request};
pub use respond::{Answer, respond};
pub use respond_to_all::{check_answerable, respond_to_all, run_count};
pub use rest_time::median_time_to_rest;
