//! Estimates from a sample of runs, with standard errors and 95 % intervals: pure functions of the results of the runs.
//!
//! Read `estimate` first, then `moments` and `sample_quantile`. `probability`, `amplitude` and `rest_time` are the
//! estimators, `measure` chooses between them, and `difference` compares two estimates.

mod amplitude;
mod difference;
mod estimate;
mod measure;
mod moments;
mod probability;
mod rest_time;
mod sample_quantile;

pub use amplitude::{mean, quantile, standard_deviation, worst};
pub use difference::{estimate_difference, estimate_ratio};
pub use estimate::{Estimate, RunResult, Sample};
pub use measure::Measure;
pub use probability::{above, at_rest_by};
pub use rest_time::median_time_to_rest;
