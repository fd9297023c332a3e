//! stickslip: parallel parameter studies and Monte Carlo for mechanical systems with dry friction.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod ending;
pub mod model;
pub mod motion;
pub mod study;
