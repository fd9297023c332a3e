//! The outcome of a run: its label, the evidence and the measured quantities.

use serde::{Deserialize, Serialize};

use super::cycle::Cycle;
use super::output_watch::OutputOutcome;
use super::stages::{PeakAmplitude, StageOutcome};
use crate::motion::{Effort, Failure};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Label {
    /// The run is at rest for good; the evidence says in which sense.
    Equilibrium,
    /// A stable periodic motion, closed modulo 2π of the running balls' angles.
    LimitCycle,
    /// The motion repeats, but was not shown to attract its neighbours: without damping, they repeat as well.
    Periodic,
    /// Contacts slip a little in every period of the forcing.
    Creep,
    /// The motion fills a torus: it has two frequencies without a common period.
    QuasiPeriodic,
    /// Neighbouring motions separate exponentially.
    Irregular,
    /// Nothing could be shown until the end time.
    Undecided,
    /// The run could not be computed.
    Failed,
}

impl Label {
    /// All labels, in the order of the tables.
    pub const ALL: [Label; 8] = [
        Label::Equilibrium,
        Label::LimitCycle,
        Label::Periodic,
        Label::Creep,
        Label::QuasiPeriodic,
        Label::Irregular,
        Label::Undecided,
        Label::Failed,
    ];

    /// The names of all labels.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Label::ALL.into_iter().map(Label::name)
    }

    /// The label's name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Label::Equilibrium => "equilibrium",
            Label::LimitCycle => "limit_cycle",
            Label::Periodic => "periodic",
            Label::Creep => "creep",
            Label::QuasiPeriodic => "quasi_periodic",
            Label::Irregular => "irregular",
            Label::Undecided => "undecided",
            Label::Failed => "failed",
        }
    }
}

/// A rest for good.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Default)]
pub struct Rest {
    /// The time since the start of the run at which the rest began, s; `None` if that is unknown.
    pub since_s: Option<f64>,
    /// The smallest friction margin of a contact at rest; `None` if no contact sticks. Creeping balls have the margin 0,
    /// because they lie on the edge of the equilibrium set within the accuracy of the run.
    pub friction_margin: Option<f64>,
}

/// A periodic motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Default)]
pub struct ClosedOrbit {
    /// The period, s.
    pub period_s: f64,
    /// The smallest friction margin of the contacts that stick throughout the period; `None` if no contact does.
    pub friction_margin: Option<f64>,
    /// The cycle; `None` if only its period is known.
    pub cycle: Option<Box<Cycle>>,
}

/// Why a run has its label, with the values that only this evidence has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Default)]
pub enum Evidence {
    /// All balls stick and the closed form excludes that any ever breaks loose.
    RestCertified(Rest),
    /// All balls stick, and bounds show that the motion approaches its rest point without breaking any loose.
    RestContracting(Rest),
    /// Balls drift ever slower at the edge of the equilibrium set.
    Creep(Rest),
    /// Not all contacts stick: the motion approaches a stable equilibrium, and friction holds the contacts that stick.
    Settled(Rest),
    /// In a period of the forcing, contacts stick or stay open, none slips, and the motion of the other components repeats.
    PeriodicRest(Rest),
    /// The orbit closes, is stable, and resting balls keep a margin.
    ClosedOrbit(ClosedOrbit),
    /// The motion repeats within its accuracy, and disturbances do not grow.
    Repeats(ClosedOrbit),
    /// The displacement in the latest periods of the forcing is small and the same.
    PeriodicCreep {
        /// The period of the forcing, s.
        period_s: f64,
    },
    /// The orbit near the run closes but is unstable.
    UnstableOrbit(Box<Cycle>),
    /// The returns to a section come back ever nearer, as on a torus.
    Torus,
    /// Neighbouring motions separate, and the confidence interval of the exponent, from enough blocks, is positive.
    Lyapunov,
    /// The end time was reached without any other evidence.
    #[default]
    EndTime,
    /// The motion could not be continued.
    Failure(Failure),
    /// The sampled parameters of the run are physically invalid, for this reason.
    InvalidParameters(String),
    /// The program itself failed in this run, with this message.
    Panic(String),
}

impl Evidence {
    /// The names of all evidence in tables, in a fixed order.
    pub const NAMES: [&'static str; 21] = [
        "rest_certified",
        "creep",
        "settled",
        "closed_orbit",
        "unstable_orbit",
        "lyapunov",
        "end_time",
        "not_finite",
        "contact_lost",
        "step_limit",
        "no_solution",
        "too_many_combinations",
        "invalid_parameters",
        "panic",
        "periodic_rest",
        "overlap",
        "torus",
        "rest_contracting",
        "indefinite_mass",
        "periodic_creep",
        "repeats",
    ];

    /// The evidence's name in tables.
    pub fn name(&self) -> &'static str {
        match self {
            Evidence::RestCertified(_) => "rest_certified",
            Evidence::RestContracting(_) => "rest_contracting",
            Evidence::Creep(_) => "creep",
            Evidence::Settled(_) => "settled",
            Evidence::PeriodicRest(_) => "periodic_rest",
            Evidence::ClosedOrbit(_) => "closed_orbit",
            Evidence::Repeats(_) => "repeats",
            Evidence::PeriodicCreep { .. } => "periodic_creep",
            Evidence::UnstableOrbit(_) => "unstable_orbit",
            Evidence::Torus => "torus",
            Evidence::Lyapunov => "lyapunov",
            Evidence::EndTime => "end_time",
            Evidence::Failure(Failure::NotFinite) => "not_finite",
            Evidence::Failure(Failure::IndefiniteMass) => "indefinite_mass",
            Evidence::Failure(Failure::ContactLost { .. }) => "contact_lost",
            Evidence::Failure(Failure::Overlap { .. }) => "overlap",
            Evidence::Failure(Failure::StepLimit) => "step_limit",
            Evidence::Failure(Failure::NoSolution { .. } | Failure::UndecidedImpact { .. }) => {
                "no_solution"
            }
            Evidence::Failure(Failure::TooManyCombinations) => "too_many_combinations",
            Evidence::InvalidParameters(_) => "invalid_parameters",
            Evidence::Panic(_) => "panic",
        }
    }

    /// The label that the evidence supports.
    pub fn label(&self) -> Label {
        match self {
            Evidence::ClosedOrbit(_) => Label::LimitCycle,
            Evidence::Repeats(_) => Label::Periodic,
            Evidence::PeriodicCreep { .. } => Label::Creep,
            Evidence::Torus => Label::QuasiPeriodic,
            Evidence::Lyapunov => Label::Irregular,
            Evidence::UnstableOrbit(_) | Evidence::EndTime => Label::Undecided,
            _ if self.rest().is_some() => Label::Equilibrium,
            _ => Label::Failed,
        }
    }

    /// The rest of a run that is at rest for good.
    pub fn rest(&self) -> Option<&Rest> {
        match self {
            Evidence::RestCertified(rest)
            | Evidence::RestContracting(rest)
            | Evidence::Creep(rest)
            | Evidence::Settled(rest)
            | Evidence::PeriodicRest(rest) => Some(rest),
            _ => None,
        }
    }

    /// The cycle that a run is on, or the unstable one near it.
    pub fn cycle(&self) -> Option<&Cycle> {
        match self {
            Evidence::ClosedOrbit(orbit) | Evidence::Repeats(orbit) => orbit.cycle.as_deref(),
            Evidence::UnstableOrbit(cycle) => Some(cycle),
            _ => None,
        }
    }

    /// The period of the cycle, or of the forcing of a run that creeps, s.
    pub fn period_s(&self) -> Option<f64> {
        match self {
            Evidence::ClosedOrbit(orbit) | Evidence::Repeats(orbit) => Some(orbit.period_s),
            Evidence::PeriodicCreep { period_s } => Some(*period_s),
            _ => None,
        }
    }

    /// The smallest friction margin of a contact at rest: at the rest point, or along the cycle.
    pub fn friction_margin(&self) -> Option<f64> {
        match self {
            Evidence::ClosedOrbit(orbit) | Evidence::Repeats(orbit) => orbit.friction_margin,
            _ => self.rest()?.friction_margin,
        }
    }

    /// Why the run failed.
    pub fn error(&self) -> Option<String> {
        match self {
            Evidence::Failure(failure) => Some(failure.to_string()),
            Evidence::InvalidParameters(error) | Evidence::Panic(error) => Some(error.clone()),
            _ => None,
        }
    }
}

/// A finite-time Lyapunov exponent: the mean rate at which a neighbouring motion separates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LyapunovExponent {
    /// The exponent, 1/s.
    pub exponent_1_s: f64,
    /// Its 95 % interval from the scatter over the blocks, 1/s; `None` for one block.
    pub interval_1_s: Option<[f64; 2]>,
    /// Number of blocks of the window, each with a minimum number of turns and switches per contact.
    pub blocks: u8,
    /// The length of the window over which it was taken, s.
    pub window_s: f64,
}

/// How the balls of a run touched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TouchingOutcome {
    /// Number of impacts between two balls.
    pub impacts: u64,
    /// Number of balls that an impact lifted off the ring. The model does not follow this lift-off.
    pub lifted_off: u64,
    /// Time in which any two balls touched, s.
    pub time_s: f64,
    /// Whether any two balls touched at the end.
    pub at_end: bool,
    /// Largest force between two balls that touch at rest, N. In each contact between balls, the force is the smallest one
    /// with which friction holds both balls; it is 0 if friction holds each ball alone.
    pub force_n: Option<f64>,
}

/// One run's result. Per-ball values are in the order of the balls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Default)]
pub struct Outcome {
    /// The reason for the label, with the values that belong to it.
    pub evidence: Evidence,
    /// Number of balls that revolved in the ring in the last tenth of the time, or in the cycle.
    pub balls_running: Option<u8>,
    /// Simulated time at which the run was stopped, s.
    pub end_time_s: Option<f64>,
    /// Whether the run was continued past the study's end time; all other values are then those of
    /// a study with the later end time.
    pub extended: bool,
    /// Position of each contact at the end: a ball's angle in rad, in [0, 2π); a block's position
    /// in m.
    pub position: Option<Vec<f64>>,
    /// The outputs of the system; empty if the system has no outputs.
    pub outputs: Vec<OutputOutcome>,
    /// Amplitude of the table's vibration, m: at the rest point, or root mean square over the cycle
    /// or the last tenth of the time. For a block, half of the distance between the extremes of its
    /// position in that time; 0 at rest.
    pub amplitude_m: Option<f64>,
    /// Mean speed of each ball relative to the ring in the last tenth of the time or over the
    /// cycle, rad/s; 0 at rest.
    pub mean_speed: Option<Vec<f64>>,
    /// Separation rate of neighbouring motions, if the run was still moving at its end time.
    pub lyapunov: Option<LyapunovExponent>,
    /// The stages of a run whose disc changes its speed or whose table is kicked; empty for other runs.
    pub stages: Vec<StageOutcome>,
    /// The largest amplitude of a run with stages.
    pub peak: Option<PeakAmplitude>,
    /// How the balls touched; `None` without contact between balls.
    pub touching: Option<TouchingOutcome>,
    /// The computational effort of the run.
    pub effort: Effort,
}

impl Outcome {
    /// How the run ended.
    pub fn label(&self) -> Label {
        self.evidence.label()
    }

    /// Returns the time from the begin of the last stage until the last ball stopped for good, s.
    pub fn time_to_rest_s(&self) -> Option<f64> {
        Some((self.evidence.rest()?.since_s? - self.last_stage_begin_s()).max(0.0))
    }

    /// Returns how long the run was observed in its last stage, s, which is what [`Outcome::time_to_rest_s`] is compared
    /// with.
    pub fn observed_s(&self) -> Option<f64> {
        self.end_time_s.map(|end_s| end_s - self.last_stage_begin_s())
    }

    fn last_stage_begin_s(&self) -> f64 {
        self.stages.last().map_or(0.0, |stage| stage.time_s[0])
    }

    /// Returns whether the outcome belongs to a system with this number of contacts: vectors with
    /// one value per contact have this length.
    pub fn is_of(&self, contacts: usize) -> bool {
        let of_each =
            |values: &Option<Vec<f64>>| values.as_ref().is_none_or(|v| v.len() == contacts);
        let cycle = self.evidence.cycle().is_none_or(|cycle| cycle.is_of(contacts));
        let stages = self.stages.iter().all(|stage| {
            stage.position.len() == contacts && stage.ball_speed_rad_s.len() == contacts
        });
        of_each(&self.position) && of_each(&self.mean_speed) && cycle && stages
    }

    /// Returns the outcome of a run that has nothing but this evidence, such as a failure.
    pub fn of(evidence: Evidence) -> Self {
        Outcome { evidence, ..Outcome::default() }
    }
}
