//! The plan of a study: points, designs, responses, and any run from its number.
//!
//! Read first `parameter` (what may vary), `base` (the model without variation) and `sweep` (the points of a block), then
//! `planned_runs` with `uncertain_draws`, and last `planned_study` with `variable`, `response` and `searches`.
//! The other files are helpers of these; read them where they are imported.

pub(in crate::study) mod base;
pub(in crate::study) mod expectation;
pub(in crate::study) mod parameter;
pub(in crate::study) mod parameter_list;
pub(in crate::study) mod planned_runs;
pub(in crate::study) mod planned_study;
pub(in crate::study) mod precision;
pub(in crate::study) mod repeated_points;
pub(in crate::study) mod resolved_study;
pub(in crate::study) mod response;
pub(in crate::study) mod searches;
pub(in crate::study) mod shown_values;
pub(in crate::study) mod sweep;
pub(in crate::study) mod uncertain_draws;
pub(in crate::study) mod uncertain_parameter;
pub(in crate::study) mod units;
pub(in crate::study) mod variable;
pub(in crate::study) mod written;
