//! One case: the complete input of one run. An outcome is a pure function of this value.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Model;

/// A start state: one value for each of [`Model::coordinates`], in that order.
///
/// The balancer's are non-dimensional as in the thesis (lengths over `L`, time times `ω_n`), in the
/// frame that turns with the disc; a block's are in m and m/s.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Start(pub Vec<f64>);

impl Start {
    /// A start state of the balancer: table position and velocity, angle and speed of each ball.
    ///
    /// ```
    /// use stickslip::model::Start;
    ///
    /// let start = Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0, 0.02], &[0.5, -0.3]);
    /// assert_eq!(start.0, [0.01, 0.0, 1.0, 4.0, 0.0, 0.02, 0.5, -0.3]);
    /// ```
    pub fn of_balancer(
        position: [f64; 2],
        beta: &[f64],
        velocity: [f64; 2],
        beta_dot: &[f64],
    ) -> Self {
        Start([&position, beta, &velocity, beta_dot].concat())
    }
}

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

/// Which undecided or irregular runs are continued past the end time, and how far. Equilibria and
/// limit cycles are final, and failed runs cannot be continued.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extend {
    /// The later end time, as a multiple of the end time.
    pub factor: f64,
    /// Whether undecided runs are continued.
    pub undecided: bool,
    /// Whether irregular runs are continued.
    pub irregular: bool,
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

/// How a case is integrated and for how long.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Simulation {
    /// Switch model or its limit.
    pub method: Method,
    /// Half width `η` of the band around zero sliding speed, non-dimensional (for a ball, over
    /// `ω_n`).
    pub band: f64,
    /// End time of a run without another ending, s.
    pub end_time_s: f64,
    /// Which runs are continued to a later end time.
    pub extend: Option<Extend>,
    /// Which endings are detected.
    pub endings: Endings,
    /// Relative error allowed per step.
    pub relative_tolerance: f64,
    /// Absolute error allowed per step, non-dimensional.
    pub absolute_tolerance: f64,
}

impl Default for Simulation {
    /// The thesis's end time, and tolerances at which fractions no longer change.
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
            relative_tolerance: 1.0e-8,
            absolute_tolerance: 1.0e-10,
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
    /// assert_eq!((second.method, second.relative_tolerance), (Method::Event, 1.0e-9));
    /// ```
    pub fn counter_check(&self) -> Simulation {
        Simulation {
            method: match self.method {
                Method::Switch => Method::Event,
                Method::Event => Method::Switch,
            },
            relative_tolerance: self.relative_tolerance / 10.0,
            absolute_tolerance: self.absolute_tolerance / 10.0,
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
