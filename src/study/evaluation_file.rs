//! What `stickslip evaluate` varies and answers, as a study file says it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::file_values::Named;

/// A variable of a design: `from` and `to`, or `choices`.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct VariableFile {
    /// Smallest value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<f64>,
    /// Largest value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<f64>,
    /// Choices by name, each a value for every one of the same numeric parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choices: Option<Named<Named<f64>>>,
}

/// A response of a design. Amplitudes are residual ones, as in `amplitude_m` of `runs.parquet`; with
/// `relative` over the amplitude without balls of the run's own machine.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ResponseFile {
    /// Mean amplitude.
    AmplitudeMean {
        /// Over the amplitude without balls.
        #[serde(default)]
        relative: bool,
    },
    /// Standard deviation of the amplitude.
    AmplitudeStdDev {
        /// Over the amplitude without balls.
        #[serde(default)]
        relative: bool,
    },
    /// Quantile of the amplitude.
    AmplitudeQuantile {
        /// Fraction of the runs below it, above 0 and below 1.
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
        fraction: f64,
        /// Over the amplitude without balls.
        #[serde(default)]
        relative: bool,
    },
    /// Largest amplitude of all runs.
    AmplitudeWorst {
        /// Over the amplitude without balls.
        #[serde(default)]
        relative: bool,
    },
    /// Probability of an amplitude above a limit.
    AmplitudeAbove {
        /// The limit, m, or over the amplitude without balls.
        #[schemars(extend("minimum" = 0))]
        limit: f64,
        /// Over the amplitude without balls.
        #[serde(default)]
        relative: bool,
    },
    /// Probability of being at rest by this time, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    AtRestByS(f64),
    /// Time by which half of the runs have come to rest, s.
    MedianTimeToRest,
}
