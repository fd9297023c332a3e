//! Responses: the quantities that are estimated for a design, and how a study file writes them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::analysis::Measure;
use crate::classification::Label;
use crate::model::OutputValue;
use crate::study::error::describe_number;
use crate::study::file::schema_parts as schema;
use crate::study::file::values::NumberOrLength;
use crate::study::plan::units::{ShownUnits, Unit, six_digits};

/// A response of a design, estimated from the residual amplitudes (`amplitude_m` in `runs.parquet`), the peak amplitudes
/// (`peak_amplitude_m`) or the times to rest of its runs.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ResponseFile {
    /// Mean amplitude, m; with `relative`, dimensionless.
    AmplitudeMean(Amplitude),
    /// Standard deviation of the amplitude, m; with `relative`, dimensionless.
    AmplitudeStdDev(Amplitude),
    /// Quantile of the amplitude at `fraction`, above 0 and below 1, in m; with `relative`, dimensionless.
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
    /// Probability of an amplitude above `limit`, such as `20 µm`; with `relative`, a number without a unit.
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

impl ResponseFile {
    /// Returns the measure of a response, and the amplitude that it measures.
    pub(in crate::study) fn parts(&self) -> (Measure, Amplitude) {
        match self.clone() {
            ResponseFile::AmplitudeMean(quantity) => (Measure::Mean, quantity),
            ResponseFile::AmplitudeStdDev(quantity) => (Measure::StandardDeviation, quantity),
            ResponseFile::AmplitudeQuantile { fraction, relative, of } => {
                (Measure::Quantile(fraction), Amplitude { relative, of })
            }
            ResponseFile::AmplitudeWorst(quantity) => (Measure::Worst, quantity),
            ResponseFile::AmplitudeAbove { limit: NumberOrLength(limit), relative, of } => {
                (Measure::Above(limit), Amplitude { relative, of })
            }
            ResponseFile::AtRestByS(time) => (Measure::AtRestBy(time), Amplitude::default()),
            ResponseFile::MedianTimeToRest => (Measure::MedianTimeToRest, Amplitude::default()),
        }
    }
}

/// A response with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Name, unique in the study.
    pub name: String,
    /// What is measured.
    pub measure: Measure,
    /// The amplitude of each run that is measured.
    pub amplitude: AmplitudeKind,
    /// The name of an output that is measured, as the study gives it, and its unit.
    pub output: Option<(String, String)>,
}

/// An amplitude of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AmplitudeKind {
    /// The residual amplitude, m.
    Residual,
    /// The residual amplitude over that of the same machine without balls.
    RelativeResidual,
    /// The largest amplitude from the start to the end, m.
    Peak,
    /// A value of the output with this number.
    Output(usize, OutputValue),
}

/// Suffixes of the columns that accompany the value of a response.
pub(crate) const SUFFIXES: [&str; 5] =
    ["_standard_error", "_low", "_high", "_reason", "_without_balls"];

/// Names of columns that result tables use themselves, beside those of the labels.
const RESERVED_COLUMNS: [&str; 10] = [
    "id",
    "design",
    "point_id",
    "responses",
    "runs",
    "discontinuous",
    "origin",
    "role",
    "met",
    "on_front",
];

/// Returns whether result tables have a column of their own with this name.
pub(in crate::study) fn is_reserved(name: &str) -> bool {
    RESERVED_COLUMNS.contains(&name) || Label::names().any(|label| label == name)
}

impl Response {
    /// Returns the name of the column in `points.parquet`, where other columns could have the name of the response.
    pub fn column(&self) -> String {
        format!("response_{}", self.name)
    }

    /// Returns the name of the column with the value for machines without balls.
    pub fn column_without_balls(&self) -> String {
        format!("{}_without_balls", self.column())
    }

    /// Returns whether the response also has a value for the machine without balls: every response of the absolute residual
    /// amplitude, but not of time.
    pub fn has_value_without_balls(&self) -> bool {
        let is_time = matches!(self.measure, Measure::AtRestBy(_) | Measure::MedianTimeToRest);
        self.amplitude == AmplitudeKind::Residual && !is_time
    }

    /// Returns the unit of the value; `1` if it is dimensionless.
    pub fn unit(&self) -> &str {
        match (self.measure, &self.output) {
            (Measure::Above(_) | Measure::AtRestBy(_), _) => "1",
            (Measure::MedianTimeToRest, _) => "s",
            (_, Some((_, unit))) => unit,
            _ if self.amplitude == AmplitudeKind::RelativeResidual => "1",
            _ => "m",
        }
    }

    /// Returns the unit in which people read the value.
    pub fn shown_unit(&self, units: &ShownUnits) -> Unit {
        let (symbol, si) = match (self.measure, self.unit()) {
            (Measure::Above(_) | Measure::AtRestBy(_), _) => ("%", 0.01),
            (_, "m") => return units.vibration(),
            (_, "1") => ("ratio", 1.0),
            (_, unit) => (unit, 1.0),
        };
        Unit { symbol: symbol.to_owned(), si }
    }

    /// Returns the meaning of the value, with a limit in m.
    pub fn meaning(&self) -> String {
        self.meaning_in(&Unit { symbol: "m".to_owned(), si: 1.0 })
    }

    /// Returns the meaning of the value, with a limit in this unit.
    pub fn meaning_in(&self, length: &Unit) -> String {
        let output = self.output.as_ref().map_or("", |(name, _)| name);
        let amplitude = match self.amplitude {
            AmplitudeKind::Residual => "residual amplitude".to_owned(),
            AmplitudeKind::RelativeResidual => {
                "residual amplitude over the amplitude without balls".to_owned()
            }
            AmplitudeKind::Peak => "peak amplitude".to_owned(),
            AmplitudeKind::Output(_, OutputValue::Amplitude) => format!("amplitude of {output}"),
            AmplitudeKind::Output(..) => output.to_owned(),
        };
        match self.measure {
            Measure::Mean => format!("mean {amplitude}"),
            Measure::StandardDeviation => format!("standard deviation of the {amplitude}"),
            Measure::Quantile(fraction) => {
                format!("quantile {} of the {amplitude}", describe_number(fraction))
            }
            Measure::Worst => format!("largest {amplitude} of all runs"),
            Measure::Above(limit) => {
                let limit = match self.amplitude {
                    AmplitudeKind::RelativeResidual | AmplitudeKind::Output(..) => {
                        describe_number(limit)
                    }
                    _ => format!("{} {}", six_digits(length.of(limit)), length.symbol),
                };
                format!("probability of a {amplitude} above {limit}")
            }
            Measure::AtRestBy(time) => {
                format!("probability of being at rest by {} s", describe_number(time))
            }
            Measure::MedianTimeToRest => "median time to rest (Kaplan-Meier)".into(),
        }
    }
}
