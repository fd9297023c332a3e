//! One case: the complete input of one run. An outcome is a pure function of this value.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Model, Start};

/// Methods for stick and slip.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "MethodKind")]
pub enum Method {
    /// The switch model with a band of finite width around zero sliding speed.
    // Thesis section 4.2, after Leine.
    Switch,
    /// The limit of the switch model for a vanishing band, with located events; does not use
    /// `band`.
    Event,
}

/// Continuation of runs past the end time; the outcome is identical to that of a study with the
/// later end time.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "ExtendFile")]
pub struct Extend {
    /// The later end time as a multiple of `end_time_s`: above 1, at most 1000; without `extend`, no run is continued.
    #[schemars(extend("exclusiveMinimum" = 1, "maximum" = 1000))]
    pub factor: f64,
    /// Labels at the end time of the runs that are continued; the default is `[undecided,
    /// irregular]`.
    #[serde(default)]
    #[schemars(with = "Vec<ExtendedLabel>", extend("minItems" = 1, "uniqueItems" = true))]
    pub labels: ExtendedLabels,
}

/// The labels of runs that are continued. Equilibria and limit cycles are final, and failed runs cannot be continued.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(try_from = "Vec<ExtendedLabel>", into = "Vec<ExtendedLabel>")]
pub struct ExtendedLabels {
    /// Whether undecided runs are continued.
    pub undecided: bool,
    /// Whether irregular runs are continued.
    pub irregular: bool,
}

/// The label of a run that can be continued.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum ExtendedLabel {
    /// Nothing could be shown until the end time.
    Undecided,
    /// Neighbouring motions separate exponentially.
    Irregular,
}

impl Default for ExtendedLabels {
    fn default() -> Self {
        ExtendedLabels { undecided: true, irregular: true }
    }
}

impl TryFrom<Vec<ExtendedLabel>> for ExtendedLabels {
    type Error = &'static str;

    fn try_from(labels: Vec<ExtendedLabel>) -> Result<Self, Self::Error> {
        let [undecided, irregular] = [ExtendedLabel::Undecided, ExtendedLabel::Irregular]
            .map(|label| labels.iter().filter(|other| **other == label).count());
        match undecided.max(irregular) {
            0 => Err(
                "`labels` is an empty list; without this key, runs of both labels are continued",
            ),
            1 => Ok(ExtendedLabels { undecided: undecided == 1, irregular: irregular == 1 }),
            _ => Err("`labels` contains a label twice"),
        }
    }
}

impl From<ExtendedLabels> for Vec<ExtendedLabel> {
    fn from(labels: ExtendedLabels) -> Self {
        let undecided = labels.undecided.then_some(ExtendedLabel::Undecided);
        undecided.into_iter().chain(labels.irregular.then_some(ExtendedLabel::Irregular)).collect()
    }
}

/// Endings that the classification detects.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "EndingsKind")]
pub enum Endings {
    /// Rest, limit cycles and irregular motion.
    #[default]
    All,
    /// Rest only: all other runs are `undecided` at the end time; runs that come to rest are
    /// identical to the last bit, and a study typically takes two thirds of the time.
    Rest,
}

/// Integration method, end time, tolerances and the endings to detect.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
#[schemars(rename = "SimulationFile")]
pub struct Simulation {
    /// How stick and slip are computed; the default is `switch`.
    pub method: Method,
    /// Half width of the band around zero sliding speed in the switch model, over the natural frequency (block: over about the
    /// natural frequency times `normal_force_n` / `stiffness_n_m`); above 0, at most 0.01; default 1e-8.
    // In a wider band, moving balls count as sticking, and may switch between stick and transition indefinitely.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 0.01))]
    pub band: f64,
    /// Time at which an undecided run stops, s; above 0; default 16.5.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub end_time_s: f64,
    /// Continuation of undecided and irregular runs past the end time; by default, none.
    pub extend: Option<Extend>,
    /// Endings that the classification detects: `all`, or `rest` only; the default is `all`.
    pub endings: Endings,
    /// Tolerated error per integration step.
    pub tolerance: Tolerance,
}

/// Tolerated error per integration step.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
#[schemars(rename = "ToleranceFile")]
pub struct Tolerance {
    /// Relative error per integration step, dimensionless; above 0; default 1e-8.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub relative: f64,
    /// Absolute error per integration step, non-dimensional; above 0; default 1e-10.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub absolute: f64,
}

/// The tolerances at which the fractions of the thesis no longer change.
impl Default for Tolerance {
    fn default() -> Self {
        Tolerance { relative: 1.0e-8, absolute: 1.0e-10 }
    }
}

impl Default for Simulation {
    /// The thesis's end time.
    ///
    /// The scan of the thesis does not show its band, except for "a power of ten, smaller values
    /// change nothing". The distance of the final ball angles from the exact motion is proportional
    /// to the band: compared with an independent event-located integration, the 99th percentile of
    /// the error is 4e-2 rad for 1e-4 and 2e-6 rad for 1e-8 at -160.8103 rad/s. Because switches
    /// are located, a narrower band has no cost.
    fn default() -> Self {
        Simulation {
            method: Method::Switch,
            band: 1.0e-8,
            end_time_s: 16.5,
            extend: None,
            endings: Endings::All,
            tolerance: Tolerance::default(),
        }
    }
}

impl Simulation {
    /// Returns the end time and that of continued runs, s; two equal times if no runs are
    /// continued.
    pub fn end_times_s(&self) -> [f64; 2] {
        let factor = self.extend.map_or(1.0, |extend| extend.factor);
        [self.end_time_s, factor * self.end_time_s]
    }

    /// Returns the settings of a second computation that should have the same ending: the other
    /// method, with a tenth of both tolerances.
    ///
    /// ```
    /// use stickslip::model::{Method, Simulation};
    ///
    /// let second = Simulation::default().counter_check();
    /// assert_eq!((second.method, second.tolerance.relative), (Method::Event, 1.0e-9));
    /// ```
    pub fn counter_check(&self) -> Simulation {
        Simulation {
            method: match self.method {
                Method::Switch => Method::Event,
                Method::Event => Method::Switch,
            },
            tolerance: Tolerance {
                relative: self.tolerance.relative / 10.0,
                absolute: self.tolerance.absolute / 10.0,
            },
            ..*self
        }
    }
}

/// Parameters, start state and settings of one run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// The system with all parameters in SI units.
    pub model: Model,
    /// The start state.
    pub start: Start,
    /// The settings of the integration.
    pub simulation: Simulation,
}
