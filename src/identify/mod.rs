//! Inference of parameters from measured positions of rest.
//!
//! The module draws parameter sets from the prior and simulates the study for each. The simulated positions of rest give a
//! probability density on the torus of ball angles, and with it the density of each measured position. A regression over
//! the parameter sets estimates these densities, and from them the likelihood, at any place of the prior. It stands in for
//! further simulations, and an ensemble sampler draws parameters from the posterior that it gives. Further parameter sets
//! lie where the posterior is. A test at each point says how well the model explains the measurements.
//!
//! All results are functions of the study and of the measurements.
//!
//! Read `site` first: what is measured, and what a simulation shows of it. `sampler` draws random numbers, and
//! `smoother` is the regression over parameter sets. `parameter_set` has and keeps the simulated ends of one set. `density` and
//! `set_densities` make the densities of the measurements from them. `likelihood` corrects their tails and adds up all
//! measurements, and its replicates give the error of the regression. `regression_width` finds the width that predicts best,
//! `posterior` draws parameters and chooses further sets, and `fit_test` tests the model. `inference`
//! combines all of this, `result_files` keeps the results, and `into_directory` runs everything with progress.

mod density;
mod fit_test;
mod in_words;
mod inference;
mod into_directory;
mod likelihood;
mod parameter_set;
mod posterior;
mod regression_width;
mod result_files;
mod sampler;
mod set_densities;
mod site;
mod smoother;

pub use into_directory::{Identified, Identify};
