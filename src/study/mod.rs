//! Studies: from a study file to planned runs.
//!
//! A study file ([`file::study_file::StudyFile`]) is resolved into a [`Study`], which is validated, contains
//! every default, and numbers its points and runs. [`Plan::planned_run`] computes any run from its
//! number, without state; its memory does not grow with the number of runs.
//!
//! Map, in the order in which the files build on one another:
//!
//! 1. `error`, then `file/yaml_tree` and `file/source`: a text as a tree of values with places, and messages about them.
//! 2. `file/key_units`, `file/quantity`, `file/unit_keys` and `file/decode`: how a typed value is read from the tree.
//! 3. `resolve/system` and `kinds`: system files, and all kinds of models, which contain the built-in system files.
//! 4. `sampling`: distributions, start states and random draws from the number of a run.
//! 5. `plan/parameter` and `file/kind_parameters`: what a study may vary, and the parameters of each kind.
//! 6. `file/study_file`: all keys of a study, with the parts of the JSON Schema in `file/schema_parts`.
//! 7. `plan/planned_runs` ([`Plan`]: points and runs) and `plan/planned_study` ([`Study`]: a plan with responses, designs and
//!    searches).
//! 8. `resolve/whole_study` and `load`: from the keys to the study. `schema` and `template` write for editors and people.
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

mod error;
pub mod file;
mod kinds;
mod load;
mod plan;
mod resolve;
mod sampling;
mod schema;
mod tables;
mod template;

pub use error::StudyError;
pub(crate) use error::{list_names, shorten};
pub use file::searches_file::{OverPoints, PriorSpacing, SensitivityFrom};
pub use kinds::{Registry, RegistryError, model_kind, model_kinds};
pub use plan::expectation::Expectation;
pub use plan::parameter::{ParameterKind, ParameterValue, VariedParameter};
pub use plan::parameter_list::{ListedParameter, SweptValues, UncertainRange};
pub use plan::planned_runs::{Plan, PlannedRun, Point};
pub use plan::planned_study::Study;
pub use plan::precision::{Audit, Precision, Sampling};
pub use plan::repeated_points::RepeatedPoints;
pub use plan::resolved_study::changed_keys;
pub use plan::response::{AmplitudeKind, Response};
pub use plan::searches::{Identification, Limit, Objective, Optimization};
pub(crate) use plan::units::short_name;
pub use plan::units::{ShownUnits, Unit};
pub use plan::variable::{DesignValue, Values, Variable};
pub use resolve::system::system_in_latex;
pub(crate) use sampling::draw::mixed;
pub use schema::json_schema;
pub use tables::{MeasuredRun, TableSource, implausible_angle};
pub use template::Template;
