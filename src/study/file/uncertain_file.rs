//! The distribution of a parameter as a study file writes it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
