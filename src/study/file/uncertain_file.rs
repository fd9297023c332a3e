//! The uncertain parameters of a study file: their distributions, and how they are sampled together.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::named::named;

/// A distribution of a parameter, in the unit of the parameter.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DistributionFile {
    /// Normal distribution; a physically impossible draw, such as a negative mass, makes a failed
    /// run.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        std_dev: f64,
    },
    /// Normal distribution, truncated at both ends; `mean` and `std_dev` are those before truncation.
    TruncatedNormal {
        /// Mean before truncation.
        mean: f64,
        /// Standard deviation before truncation, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        std_dev: f64,
        /// Smallest value.
        min: f64,
        /// Largest value, above `min`.
        max: f64,
    },
    /// Log-normal distribution, given by mean and standard deviation of the parameter itself, not
    /// of its logarithm.
    Lognormal {
        /// Mean of the parameter, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        mean: f64,
        /// Standard deviation of the parameter, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        std_dev: f64,
    },
    /// Uniform distribution.
    Uniform {
        /// Smallest value.
        min: f64,
        /// Largest value, above `min`.
        max: f64,
    },
    /// Triangular distribution.
    Triangular {
        /// Smallest value.
        min: f64,
        /// Most likely value, from `min` to `max`.
        mode: f64,
        /// Largest value, above `min`.
        max: f64,
    },
    /// One of several values; `weights` are optional and on any scale, by default all equal.
    Choice {
        /// The values.
        #[schemars(extend("minItems" = 1))]
        values: Vec<f64>,
        /// Weights of the values, at least 0, on any scale; by default, all values are equally
        /// likely.
        weights: Option<Vec<f64>>,
    },
    /// The nominal value, which may come from the model, a sweep or a design, multiplied by a
    /// random factor from one of the other distributions.
    Times(Box<DistributionFile>),
}

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
