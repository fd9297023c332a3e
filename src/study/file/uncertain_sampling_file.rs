//! How a study file writes the joint sampling of the uncertain parameters: their design and their rank correlations.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::named::named;

/// How the uncertain parameters are sampled together.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct UncertainSamplingFile {
    /// Sampling design of the uncertain parameters over all runs of a point; the default is `monte_carlo`.
    pub design: Option<UncertainDesignKind>,
    /// A list of pairs, each with two `parameters` and their `rank_correlation`; all other pairs are uncorrelated; by default,
    /// none.
    #[schemars(extend("minItems" = 1))]
    pub correlations: Option<Vec<CorrelationFile>>,
}

/// Sampling designs of uncertain parameters.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum UncertainDesignKind {
    /// Independent draws.
    #[default]
    MonteCarlo,
    /// Latin hypercube over all runs of a point: one run in each of as many strata of equal probability.
    LatinHypercube,
    /// Scrambled Sobol' sequence of its own, independent of the start states; at most 65,536 runs per point.
    Sobol,
    /// The uncertain parameters are further axes of the design of the start states, which is `latin_hypercube`, `sobol` or
    /// `monte_carlo`.
    Joint,
}

named!(UncertainDesignKind {
    MonteCarlo: "monte_carlo",
    LatinHypercube: "latin_hypercube",
    Sobol: "sobol",
    Joint: "joint",
});

/// The rank correlation of two uncertain parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CorrelationFile {
    /// The names of two different uncertain parameters.
    #[schemars(extend("minItems" = 2, "maxItems" = 2, "uniqueItems" = true))]
    pub parameters: Vec<String>,
    /// Spearman's rank correlation of their draws, above -1 and below 1; with `times`, that of the factors. Parameters
    /// that follow from one another need a common parameter in place of a correlation of 1.
    #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 1))]
    pub rank_correlation: f64,
}
