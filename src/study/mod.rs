//! Studies: from a study file to planned runs.
//!
//! A study file ([`file::StudyFile`]) is resolved into a [`Study`], which is validated, contains
//! every default, and numbers its points and runs. [`Study::planned_run`] computes any run from its
//! number, without state; its memory does not grow with the number of runs.
//!
//! ```
//! use std::path::Path;
//! use stickslip::study::Study;
//!
//! let text = "
//! schema: 1
//! name: two-speeds
//! seed: 7
//! model: {kind: ball_balancer}
//! sweep: [{grid: {speed_rad_s: [-160.0, -200.0]}}]
//! initial_conditions: {design: {monte_carlo: {samples: 1000}}}
//! ";
//! let study = Study::parse(Path::new("two-speeds.yaml"), text.to_owned())?;
//! assert_eq!(study.run_count(), 2000);
//! let run = study.planned_run(1234);
//! assert_eq!((run.point_id, run.replicate), (1, 234));
//! # Ok::<(), stickslip::study::StudyError>(())
//! ```

mod audit;
mod decode;
mod design;
mod design_table;
mod difference;
mod distribution;
mod draw;
mod error;
mod evaluation_file;
mod expectation;
pub mod file;
pub mod file_values;
mod key_path;
mod node;
mod optimization;
mod optimize_file;
mod parameter;
mod plan;
mod precision;
mod read_file;
mod resolve;
mod resolve_design;
mod resolve_expectations;
mod resolve_extend;
mod resolve_friction;
mod resolve_model;
mod resolve_optimization;
mod resolve_points;
mod resolve_responses;
mod resolve_runs;
mod resolve_simulation;
mod resolve_sweep;
mod resolve_uncertain;
mod resolve_variables;
mod resolved_file;
mod resolved_study;
mod response;
mod rows;
mod schema;
mod start_box;
mod sweep;
mod table_folders;
mod variable;
mod with_design;

pub use audit::Audit;
pub use difference::difference;
pub use error::StudyError;
pub(crate) use error::{list_names, shorten};
pub use expectation::Expectation;
pub(crate) use node::describe_number;
pub use optimization::{Limit, Objective, Optimization};
pub use optimize_file::{OverPoints, SensitivityFrom};
pub use parameter::{ParameterKind, ParameterValue, VariedParameter};
pub use plan::{PlannedRun, Point, Study};
pub use precision::{Precision, Sampling};
pub use response::{Measure, Response};
pub use schema::json_schema;
pub use variable::{DesignValue, Values, Variable};
