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
//! Read `site` and `end` first: what is measured, and what a simulation shows of it. `sampler` draws random numbers, and
//! `smoother` is the regression over parameter sets. `parameter_set` has and keeps the simulated ends of one set. `density` and
//! `set_densities` make the densities of the measurements from them, and `references` corrects their tails. `likelihood`
//! adds up all measurements, and its replicates give the error of the regression. `regression_width` finds the width that
//! predicts best, `posterior` draws parameters and chooses further sets, and `fit_test` tests the model. `inference`
//! combines all of this, `result_files` keeps the results, and `into_directory` runs everything with progress.

mod density;
mod end;
mod fit_test;
mod in_words;
mod inference;
mod into_directory;
mod likelihood;
mod parameter_set;
mod posterior;
mod references;
mod regression_width;
mod result_files;
mod sampler;
mod set_densities;
mod site;
mod smoother;
mod tables;
mod warnings;

pub use density::Rests;
pub use end::{BallsEnd, SimulatedEnd};
pub use fit_test::{SeenRun, SiteFit, fit_tests};
pub use in_words::{identification_json, result_in_words};
pub use inference::{Inference, InferenceEnd, Inferred};
pub use into_directory::{Identified, Identify};
pub use likelihood::{Likelihood, REPLICATES, Replicated, set_weights};
pub use parameter_set::{ParameterSet, read_parameter_set, set_columns, set_facts, set_name};
pub use posterior::{Marginal, Posterior, posterior};
pub use references::{References, with_references};
pub use set_densities::{SetDensities, sums_of_rests};
pub use site::{MeasuredRest, Site, sites};
pub use smoother::{SetWeight, Smoother, positive, sums};
pub use tables::{
    PositionRow, evaluated_set_columns, fit_columns, position_columns, position_rows,
    posterior_columns,
};
