//! Sampling designs of start states, and the random numbers of a study.
//!
//! A name selects each random number: seed, parameter or axis, cell, replicate and run select a uniform number, and a
//! quantile turns it into the drawn value. No number comes from a sequence of `rand`. Latin hypercubes and Sobol' points
//! need the quantile; common random numbers and enlarged samples need the names.
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
