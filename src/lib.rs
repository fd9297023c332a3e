//! stickslip: parallel parameter studies and Monte Carlo for mechanical systems with dry friction.
//!
//! One way through the house, from left to right:
//!
//! ```text
//! study.yaml -> study -> case -> motion, ending -> outcome -> analysis -> table
//!                         `------ farm: what is computed where ------'
//! ```
//!
//! - [`study`]: a study file, checked, and its plan: any run by its number.
//! - [`model`]: parameters, equations of motion, closed forms.
//! - [`motion`]: integration, the switch model, stick and slip.
//! - [`ending`]: how a run ends, on evidence.
//! - [`farm`]: runs over the cores, in order, whatever happens in one of them.
//! - [`analysis`]: intervals, times to rest, what is known of a point; equilibrium sets.
//! - [`design`]: responses of designs, for optimisers.
//! - `tabular`: tables in CSV, Parquet and Arrow, read in bounds; what `study` and `table` stand on.
//! - [`table`]: Parquet files with units and provenance; the only room that writes them.
//! - [`report`]: results and runs for the eye: what a figure shows, figures, animations.
//! - [`cli`]: the commands.
//!
//! A case is a pure function of the study and the run's number, an outcome a pure function of the
//! case:
//!
//! ```
//! use stickslip::ending::{Label, simulate};
//! use stickslip::model::{Case, Machine, Simulation, Start};
//!
//! let case = Case {
//!     model: Machine { speed_rad_s: -160.8103, ..Machine::default() }.into(),
//!     start: Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0, 0.02], &[0.5, -0.3]),
//!     simulation: Simulation::default(),
//! };
//! let outcome = simulate(&case);
//! assert_eq!(outcome.label(), Label::Equilibrium);
//! assert!(outcome.time_to_rest_s < Some(16.5));
//! ```
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod analysis;
pub mod cli;
pub mod design;
pub mod ending;
pub mod farm;
mod foreign;
pub mod model;
pub mod motion;
pub mod report;
pub mod study;
pub mod table;
mod tabular;
