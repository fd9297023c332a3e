//! stickslip: parallel parameter studies and Monte Carlo for mechanical systems with dry friction.
//!
//! Data flows in one direction, from left to right:
//!
//! ```text
//! study.yaml -> study -> case -> motion -> classification -> outcome -> analysis -> table -> report
//!                         `---------- engine: which run is computed where ----------'
//! ```
//!
//! - [`study`]: a validated study file and its plan, which computes any run from its number.
//! - [`model`]: parameters, equations of motion, friction laws.
//! - `graph`: programs of straight-line arithmetic, which [`motion`] runs.
//! - [`motion`]: integration, the switch model, stick and slip.
//! - [`classification`]: how a run ends, and the evidence.
//! - [`engine`]: distribution of runs over cores and shards, storage of finished runs, progress,
//!   interruption and resumption.
//! - [`analysis`]: confidence intervals, times to rest, summaries of points, equilibrium sets.
//! - `tabular`: tables in CSV, Parquet and Arrow, read within bounds, for studies and results.
//! - [`table`]: the result tables with units and provenance. Only this module writes Parquet.
//! - [`report`]: the HTML page of results, and a run that is computed again with its motion.
//! - [`responses`]: the responses of a design, for optimisers.
//! - [`optimize`]: the search for the best design, and sensitivity indices.
//! - [`identify`]: the inference of parameters from measured positions of rest.
//! - [`check`]: closed forms and warnings, before a study is computed.
//! - [`cli`]: the commands.
//!
//! Begin with [`study`], then read [`model`], [`motion`] and [`classification`]. Small helpers lie beside this file:
//! `numbers` and `printed_table` format output, `named` names the values of enums, and `sanitize` cleans foreign text.
//!
//! A case is a pure function of the study and the number of the run, and an outcome is a pure
//! function of the case:
//!
//! ```
//! use stickslip::classification::{Label, simulate};
//! use stickslip::model::{Case, Machine, Simulation, Start};
//!
//! let case = Case {
//!     model: Machine { speed_rad_s: -160.8103, ..Machine::default() }.into(),
//!     start: Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0, 0.02], &[0.5, -0.3]),
//!     simulation: Simulation::default(),
//! };
//! let outcome = simulate(&case);
//! assert_eq!(outcome.label(), Label::Equilibrium);
//! assert!(outcome.time_to_rest_s() < Some(16.5));
//! ```
#![deny(unsafe_code)]
#![deny(missing_docs)]

pub mod analysis;
pub mod check;
pub mod classification;
pub mod cli;
pub mod engine;
mod graph;
pub mod identify;
pub mod model;
pub mod motion;
mod named;
mod numbers;
pub mod optimize;
mod printed_table;
pub mod report;
pub mod responses;
mod sanitize;
pub mod study;
pub mod table;
mod tabular;

pub use engine::CommandError;
