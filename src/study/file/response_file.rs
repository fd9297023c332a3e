//! The keys `design` and `responses` of a study file.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::file::schema_parts as schema;
use crate::study::file::values::NumberOrLength;

/// A variable of a design: either `from` and `to`, or `choices`.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct VariableFile {
    /// Smallest value, in the unit of the parameter.
    pub from: Option<f64>,
    /// Largest value, in the unit of the parameter; at least `from`.
    pub to: Option<f64>,
    /// Choices by name; each choice sets the same numeric parameters.
    #[serde(default)]
    #[schemars(schema_with = "schema::choices")]
    pub choices: Option<IndexMap<String, IndexMap<String, f64>>>,
}

/// A response of a design, estimated from the residual amplitudes (`amplitude_m` in `runs.parquet`), the peak amplitudes
/// (`peak_amplitude_m`) or the times to rest of its runs.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ResponseFile {
    /// Mean amplitude, m; with `relative`, dimensionless.
    AmplitudeMean(Amplitude),
    /// Standard deviation of the amplitude, m; with `relative`, dimensionless.
    AmplitudeStdDev(Amplitude),
    /// Quantile of the amplitude, m; with `relative`, dimensionless.
    AmplitudeQuantile {
        /// Fraction of the runs below the quantile, above 0 and below 1.
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
        fraction: f64,
        /// Whether each amplitude is divided by the amplitude of the same machine without balls;
        /// the default is `false`.
        #[serde(default)]
        relative: bool,
        /// What is measured of each run; the default is `residual`.
        #[serde(default)]
        of: AmplitudeFile,
    },
    /// Largest amplitude of all runs, m; with `relative`, dimensionless.
    AmplitudeWorst(Amplitude),
    /// Probability of an amplitude above a limit.
    AmplitudeAbove {
        /// The limit, at least 0: a number in m, or a value with a unit, such as `20 µm`; with `relative`, a number without
        /// a unit.
        #[schemars(schema_with = "schema::length_limit")]
        limit: NumberOrLength,
        /// Whether each amplitude is divided by the amplitude of the same machine without balls;
        /// the default is `false`.
        #[serde(default)]
        relative: bool,
        /// What is measured of each run; the default is `residual`.
        #[serde(default)]
        of: AmplitudeFile,
    },
    /// Probability of rest by this time, s; above 0 and at most the end time of the simulation.
    AtRestByS(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// Median time to rest (Kaplan-Meier estimator), s.
    MedianTimeToRest,
}

/// The amplitude of a response.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(inline, description = "")]
pub struct Amplitude {
    /// Whether each amplitude is divided by the amplitude of the same machine without balls;
    /// the default is `false`.
    #[serde(default)]
    pub relative: bool,
    /// What is measured of each run; the default is `residual`.
    #[serde(default)]
    pub of: AmplitudeFile,
}

/// What is measured of a run: `residual`, the amplitude at the end (`amplitude_m`); `peak`, the largest amplitude from start to
/// end (`peak_amplitude_m`), only with a speed profile or disturbances; or, for a system file, an output: its name for half of
/// the distance between its extremes, or the name of a column such as `max_x_m`.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(extend("examples" = ["residual", "peak", "x_m", "max_x_m"]))]
pub struct AmplitudeFile(pub String);

impl Default for AmplitudeFile {
    fn default() -> Self {
        AmplitudeFile("residual".to_owned())
    }
}
