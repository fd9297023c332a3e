//! Estimates from a sample of runs, with standard errors and 95 % intervals: pure functions of the results of the runs.
//!
//! Read `estimate` first, then `moments` and `sample_quantile`. `probability` and `amplitude` are the estimators, and
//! `measure` chooses between them.

mod amplitude;
mod estimate;
mod measure;
mod moments;
mod probability;
mod sample_quantile;

pub use amplitude::{mean, quantile, standard_deviation, worst};
pub use estimate::{Estimate, RunResult, Sample, estimate_difference, estimate_ratio};
pub use measure::Measure;
pub use probability::{above, at_rest_by, median_time_to_rest};
