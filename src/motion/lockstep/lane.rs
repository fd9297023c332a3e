//! One of the runs in lockstep: its scalar part, and the complete run outside of a lane.

use super::root_isolation::width;
use crate::model::{Balancer, RestPoint, State, System};
use crate::motion::contact::Phase;
use crate::motion::driver::Motion;
use crate::motion::guard::Margins;
use crate::motion::{Effort, Failure, Settings};

/// The scalar part of a run.
#[derive(Clone, Debug)]
pub(crate) struct Lane<const N: usize> {
    pub(crate) balancer: Balancer<N>,
    pub(crate) settings: Settings,
    pub(super) margins: Margins,
    /// Whether stick and slip have a unique decision for all positions of the balls.
    pub(super) surely_one_solution: bool,
    pub(super) slow: f64,
    /// Width within which events are located.
    pub(super) width: f64,
    pub(super) phases: [Phase; N],
    /// The phases of the balls in the latest step, if an event has ended it.
    pub(super) during: [Phase; N],
    pub(super) last_switches: [f64; N],
    pub(super) switches: u64,
    /// Whether a displacement met a switch by grazing.
    pub(super) grazed: bool,
}

impl<const N: usize> Lane<N> {
    /// Returns the effort of the run for this number of steps.
    pub(super) fn effort(&self, taken: f64) -> Effort {
        Effort { steps: taken as u64, rejected_steps: 0, switches: self.switches }
    }
}

/// The reason why a run cannot continue in lockstep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Trouble {
    /// It cannot continue at all.
    Failure(Failure),
    /// An event could not be located: the run is computed alone from its start.
    Fallback,
}

impl From<Failure> for Trouble {
    fn from(failure: Failure) -> Self {
        Trouble::Failure(failure)
    }
}

/// A run taken out of its lane, which can be put into any lane.
#[derive(Clone, Debug)]
pub(crate) struct Saved<const N: usize> {
    pub(super) lane: Lane<N>,
    pub(super) time: f64,
    pub(super) state: State<N>,
    pub(super) turns: [f64; N],
    pub(super) slow_since: [f64; N],
    pub(super) next: f64,
    pub(super) taken: f64,
    pub(super) displacement: State<N>,
}

impl<const N: usize> Saved<N> {
    /// Creates a run at its start.
    ///
    /// # Errors
    /// [`Failure`] if the motion cannot be continued from the start state.
    pub(crate) fn start(
        balancer: &Balancer<N>,
        settings: Settings,
        state: State<N>,
    ) -> Result<Self, Failure> {
        let motion = Motion::new(balancer, settings, state)?;
        let margins = motion.margins();
        let state = *motion.state();
        let phases = *motion.phases();
        let lane = Lane {
            balancer: *balancer,
            settings,
            margins,
            surely_one_solution: balancer.surely_one_solution(),
            slow: motion.slow(),
            width: width(settings.tolerance.relative),
            phases,
            during: phases,
            last_switches: [0.0; N],
            switches: 0,
            grazed: false,
        };
        Ok(Saved {
            lane,
            time: 0.0,
            state,
            turns: [0.0; N],
            slow_since: [0.0; N],
            next: balancer.longest_step(),
            taken: 0.0,
            displacement: State::zero(),
        })
    }
}

impl<const N: usize> Saved<N> {
    /// Returns the time.
    pub(crate) fn time(&self) -> f64 {
        self.time
    }

    /// Returns the effort so far.
    pub(crate) fn effort(&self) -> Effort {
        self.lane.effort(self.taken)
    }
}

/// Returns the square of the distance from rest below which no ball can break loose, apart from the
/// residual speeds of sticking balls in the switch model; negative if there is no such distance.
pub(super) fn rest_radius_squared<const N: usize>(
    balancer: &Balancer<N>,
    rest: &RestPoint<N>,
) -> f64 {
    let mut least = f64::INFINITY;
    for (i, ball) in balancer.balls.iter().enumerate() {
        let limit = ball.friction.limit;
        least = least.min((limit * rest.normal[i] - rest.friction[i].abs()) / (1.0 + limit));
    }
    if least < 0.0 || least.is_nan() {
        return -1.0;
    }
    // Slightly larger, so that rounding leaves the decision to the certificate itself.
    let radius = least / balancer.acceleration_bound(1.0) * (1.0 + 1e-9);
    radius * radius
}
