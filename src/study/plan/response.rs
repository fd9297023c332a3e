//! Responses: the quantities that are estimated for a design.

use crate::study::file::yaml_tree::describe_number;

/// The estimated quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Mean amplitude.
    Mean,
    /// Standard deviation of the amplitude.
    StandardDeviation,
    /// Quantile of the amplitude, with the fraction of runs below it.
    Quantile(f64),
    /// Largest amplitude.
    Worst,
    /// Probability of an amplitude above this limit.
    Above(f64),
    /// Probability of rest by this time, s.
    AtRestBy(f64),
    /// Median time to rest.
    MedianTimeToRest,
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
}

/// Suffixes of the columns that accompany the value of a response.
pub(crate) const SUFFIXES: [&str; 4] = ["_standard_error", "_low", "_high", "_reason"];

/// Names of columns that result tables use themselves.
pub(in crate::study) const RESERVED_COLUMNS: [&str; 15] = [
    "id",
    "design",
    "point_id",
    "responses",
    "runs",
    "equilibrium",
    "limit_cycle",
    "irregular",
    "undecided",
    "failed",
    "discontinuous",
    "origin",
    "role",
    "met",
    "on_front",
];

impl Response {
    /// Returns the unit of the value; `1` if it is dimensionless.
    pub fn unit(&self) -> &'static str {
        match self.measure {
            Measure::Above(_) | Measure::AtRestBy(_) => "1",
            Measure::MedianTimeToRest => "s",
            _ if self.amplitude == AmplitudeKind::RelativeResidual => "1",
            _ => "m",
        }
    }

    /// Returns the meaning of the value.
    pub fn meaning(&self) -> String {
        let (amplitude, unit) = match self.amplitude {
            AmplitudeKind::Residual => ("residual amplitude", " m"),
            AmplitudeKind::RelativeResidual => {
                ("residual amplitude over the amplitude without balls", "")
            }
            AmplitudeKind::Peak => ("peak amplitude", " m"),
        };
        match self.measure {
            Measure::Mean => format!("mean {amplitude}"),
            Measure::StandardDeviation => format!("standard deviation of the {amplitude}"),
            Measure::Quantile(fraction) => {
                format!("quantile {} of the {amplitude}", describe_number(fraction))
            }
            Measure::Worst => format!("largest {amplitude} of all runs"),
            Measure::Above(limit) => {
                let limit = describe_number(limit);
                format!("probability of a {amplitude} above {limit}{unit}")
            }
            Measure::AtRestBy(time) => {
                format!("probability of being at rest by {} s", describe_number(time))
            }
            Measure::MedianTimeToRest => "median time to rest (Kaplan-Meier)".into(),
        }
    }
}
