//! Sampling designs of start states, and the random numbers of a study.
//!
//! Every random number of a study is a quantile of a uniform number from a stream that is keyed by names (seed,
//! parameter or axis, cell, replicate, run), not a draw from a sequence of `rand`: Latin hypercubes and Sobol' points
//! need the quantile, and common random numbers and enlarged samples need the keys.
//!
//! Read first `draw` (the streams), then `initial_box` and `sampling_design` (start states); `distribution`, `correlation`
//! and `uncertain_design` give the draws of uncertain parameters.

pub(in crate::study) mod apart;
pub(in crate::study) mod correlation;
pub(in crate::study) mod distribution;
pub(in crate::study) mod draw;
pub(in crate::study) mod initial_box;
pub(in crate::study) mod sampling_design;
pub(in crate::study) mod uncertain_design;
