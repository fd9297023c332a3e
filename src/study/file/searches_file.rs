//! The keys `optimize` and `identify` of a study file.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::values::notations;
use crate::named::named;
use crate::study::file::schema_parts as schema;
use crate::study::file::values::{Count, Entry};

/// The largest number of designs in a search; surrogates of more designs take too long.
pub(in crate::study) const MAX_DESIGNS: u64 = 300;

/// Objectives, limits and effort of `stickslip optimize`.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct OptimizeFile {
    /// Response to minimise, or a list of two; `minimize` and `maximize` have one or two responses
    /// in total, and two give a Pareto front.
    pub minimize: Option<ResponseNames>,
    /// Response to maximise, or a list of two.
    pub maximize: Option<ResponseNames>,
    /// Limits of responses, by response; by default, none.
    pub subject_to: Option<IndexMap<String, LimitFile>>,
    /// Value of a response over the points of a sweep: at the `worst` point, or the `mean`; the default is `worst`.
    pub over_points: Option<OverPoints>,
    /// Number of designs in total, 2 to 300; the default is four times `start_designs`, at most
    /// 300.
    #[schemars(extend("minimum" = 2, "maximum" = MAX_DESIGNS))]
    pub designs: Option<Count>,
    /// Number of designs in the initial space-filling sample, 2 to 300; the default is 5 per
    /// variable, at least 10.
    #[schemars(extend("minimum" = 2, "maximum" = MAX_DESIGNS))]
    pub start_designs: Option<Count>,
    /// Number of best designs that are recomputed with other random numbers, 1 to 10,000; with two objectives, the largest
    /// number of recomputed designs of the Pareto front; the default is 5.
    #[schemars(extend("minimum" = 1, "maximum" = 10_000))]
    pub finalists: Option<Count>,
    /// Number of runs of a finalist, as a multiple of the runs in the search, 1 to 10,000; the
    /// default is 16.
    #[schemars(extend("minimum" = 1, "maximum" = 10_000))]
    pub final_samples: Option<Count>,
    /// Settings of the Sobol' indices of the variables.
    pub sensitivity: Option<SensitivityFile>,
    /// A reference design with a value for each variable; the search begins with it, and the best
    /// design is compared with it.
    pub compare_with: Option<IndexMap<String, Entry>>,
}

/// Limits of a response: `at_least`, `at_most` or both.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LimitFile {
    /// Smallest allowed value, in the unit of the response.
    pub at_least: Option<f64>,
    /// Largest allowed value, in the unit of the response.
    pub at_most: Option<f64>,
}

/// How the values at the points of a sweep are combined.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OverPoints {
    /// The worst value.
    #[default]
    Worst,
    /// The mean.
    Mean,
}

/// Settings of the Sobol' indices.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SensitivityFile {
    /// Source of the responses for the Sobol' indices: `surrogates` of the search, or `runs` of new designs, which give
    /// intervals; the default is `surrogates`.
    pub from: Option<SensitivityFrom>,
    /// Number of base samples of the Sobol' indices, 8 to 65,536; with `from: runs`, each base sample takes one design
    /// per variable and two more; the default is 1024 for surrogates and 64 for runs.
    #[schemars(extend("minimum" = 8, "maximum" = 65_536))]
    pub samples: Option<Count>,
}

/// Source of the responses for the Sobol' indices.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensitivityFrom {
    /// The surrogates at the end of the search; this takes no further runs, and is as accurate as
    /// the surrogates.
    #[default]
    Surrogates,
    /// Runs of new designs.
    Runs,
}

named!(SensitivityFrom { Surrogates: "surrogates", Runs: "runs" });

/// One or two names of responses.
#[derive(Clone, Debug, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
#[schemars(inline)]
pub enum ResponseNames {
    /// One name.
    One(String),
    /// A list of names.
    Several(#[schemars(length(min = 1, max = 2))] Vec<String>),
}

impl ResponseNames {
    /// Returns the names.
    pub fn as_slice(&self) -> &[String] {
        match self {
            ResponseNames::One(name) => std::slice::from_ref(name),
            ResponseNames::Several(names) => names,
        }
    }
}

notations! {
    ResponseNames: "the name of a response, or a list of two",
    text => |name: &str| Some(ResponseNames::One(name.to_owned())),
    list(Vec<String>) => ResponseNames::Several,
}

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
