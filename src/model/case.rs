//! One case: everything that decides one run. An outcome is a pure function of this value.

use serde::Serialize;

use super::{Model, State};

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

    /// The start state of a balancer with `N` balls; `None` of another number.
    pub fn of_balls<const N: usize>(&self) -> Option<State<N>> {
        let (position, rest) = self.0.split_first_chunk()?;
        let (beta, rest) = rest.split_first_chunk()?;
        let (velocity, rest) = rest.split_first_chunk()?;
        let beta_dot = rest.try_into().ok()?;
        Some(State { position: *position, velocity: *velocity, beta: *beta, beta_dot })
    }
}

/// How stick and slip are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Method {
    /// The switch model with a band of finite width (thesis section 4.2, after Leine).
    Switch,
    /// Its limit as the band goes to zero, the exact motion: stops and break-aways are located.
    Event,
}

/// Which runs are continued past the end time, and how far: those of which, at the end time, no
/// ending is known. Equilibria and limit cycles are over, and failures cannot be continued.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extend {
    /// The time to which they are continued, over the end time.
    pub factor: f64,
    /// Whether runs are continued of which nothing could be shown.
    pub undecided: bool,
    /// Whether runs are continued that have been shown to be irregular.
    pub irregular: bool,
}

/// Which endings of a run are looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum Endings {
    /// Rest, limit cycles and irregular motion.
    #[default]
    All,
    /// Rest only: what else a run ends in stays undecided, and most of what is computed beside the
    /// motion is not.
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
    /// When a run that has not ended by itself is stopped, s.
    pub end_time_s: f64,
    /// Which of these runs are continued, to a later time.
    pub extend: Option<Extend>,
    /// Which endings are looked for.
    pub endings: Endings,
    /// Relative error allowed per step.
    pub relative_tolerance: f64,
    /// Absolute error allowed per step, non-dimensional.
    pub absolute_tolerance: f64,
}

impl Default for Simulation {
    /// The thesis's end time, and tolerances at which fractions no longer change.
    ///
    /// The thesis's band is lost in the scan but for "a power of ten, smaller values change
    /// nothing". Final ball angles converge to the exact motion in proportion to the band: against
    /// an independent event-located integration their 99th percentile is off by 4e-2 rad with
    /// 1e-4 and by 2e-6 rad with 1e-8 at -160.8103 rad/s. As switches are located, a narrower band
    /// costs nothing.
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
    /// The end time, and that of runs that are continued, s; the same where none are.
    pub fn end_times_s(&self) -> [f64; 2] {
        let factor = self.extend.map_or(1.0, |extend| extend.factor);
        [self.end_time_s, factor * self.end_time_s]
    }

    /// The settings of a second computation that should end alike: the other method, with a tenth of
    /// both tolerances.
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
    /// Where it starts.
    pub start: Start,
    /// How it is integrated.
    pub simulation: Simulation,
}
