//! The key `identify` of a study file.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::file::schema_parts as schema;
use crate::study::file::values::Count;

/// Parameters that `stickslip identify` infers from measured positions of rest, and its effort.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct IdentifyFile {
    /// Numeric parameters to infer, each with the range of its prior.
    #[schemars(schema_with = "schema::priors")]
    pub parameters: IndexMap<String, PriorFile>,
    /// Number of parameter sets in the initial space-filling sample, 8 to 300; the default is 32 for one parameter, 64 for
    /// two, and so on, at most 256.
    pub start_designs: Option<Count>,
    /// Number of parameter sets in total, 8 to 300; those after the initial sample lie where the posterior is; the
    /// default is 1.25 times `start_designs`.
    pub designs: Option<Count>,
    /// Number of samples of the posterior, 100 to 100,000; the default is 4000.
    pub posterior_samples: Option<Count>,
}

/// The prior of a parameter: all values of a range with equal probability density.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PriorFile {
    /// Smallest value, in the unit of the parameter.
    pub from: f64,
    /// Largest value, in the unit of the parameter; above `from`.
    pub to: f64,
}
