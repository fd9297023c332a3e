//! The key `identify` of a study file.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::file::schema_parts as schema;
use crate::study::file::values::Count;

/// The largest number of parameter sets; the densities of more take too much memory.
pub(in crate::study) const MOST_DESIGNS: u64 = 4000;
/// The largest number of parameters.
pub(in crate::study) const MOST_PARAMETERS: usize = 8;

/// Parameters that `stickslip identify` infers from measured positions of rest, and its effort.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct IdentifyFile {
    /// 1 to 8 numeric parameters to infer, each with the range of its prior.
    #[schemars(schema_with = "schema::by_parameter::<PriorFile>")]
    #[schemars(extend("minProperties" = 1, "maxProperties" = MOST_PARAMETERS))]
    pub parameters: IndexMap<String, PriorFile>,
    /// Number of parameter sets in the initial space-filling sample, 8 to 4000; the default is 128 for one parameter, 1000
    /// for two, 2000 for more.
    #[schemars(extend("minimum" = 8, "maximum" = MOST_DESIGNS))]
    pub start_designs: Option<Count>,
    /// Number of parameter sets in total, 8 to 4000; those after the initial sample lie where the posterior is; the
    /// default is 1.25 times `start_designs`, at most 4000.
    #[schemars(extend("minimum" = 8, "maximum" = MOST_DESIGNS))]
    pub designs: Option<Count>,
    /// Number of samples of the posterior, 100 to 100,000; the default is 4000.
    #[schemars(extend("minimum" = 100, "maximum" = 100_000))]
    pub posterior_samples: Option<Count>,
}

/// The prior of a parameter: a range, and where its probability density is constant.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PriorFile {
    /// Smallest value, in the unit of the parameter.
    pub from: f64,
    /// Largest value, in the unit of the parameter; above `from`.
    pub to: f64,
    /// Whether all values or all logarithms of values have equal probability density; `logarithmic` needs a positive range;
    /// the default is `linear`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing: Option<PriorSpacing>,
}

/// The scale on which the probability density of a prior is constant.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PriorSpacing {
    /// The values.
    #[default]
    Linear,
    /// The logarithms of the values.
    Logarithmic,
}
