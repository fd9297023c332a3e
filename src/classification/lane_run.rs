//! One of the runs in lockstep, with its monitors, step by step until its ending is known.
//!
//! The endings are those of a run computed alone (`classification::balancer`). A lane is inspected
//! only after an event, a section crossing, near rest, or at a requested time.

use fearless_simd::Simd;

use super::balancer::{BalancerRun, Ending, Late, Prepared, Units};
use super::certificate::certified;
use super::follow::{Horizons, Run, continues};
use super::orbit::{GoneRound, OrbitWatch};
use super::outcome::Outcome;
use super::recorder::Recorder;
use super::settled::SettledWatch;
use super::window::{NODES, Taken};
use crate::model::{Balancer, Extend, Simulation};
use crate::motion::lockstep::{Group, Happened, Room, Saved, Trouble};
use crate::motion::{Failure, Settings};

/// Sizes of a displacement that need no renormalisation.
const HANDY: std::ops::Range<f64> = 1e-99..1e99;

/// A run in a lane.
#[derive(Clone, Debug)]
pub(super) struct LaneRun<const N: usize> {
    /// The run's number, which identifies it to the caller.
    pub(super) number: u64,
    balancer: Balancer<N>,
    settings: Settings,
    units: Units,
    extend: Option<Extend>,
    horizons: Horizons<Late<N>>,
    /// `None` if limit cycles are not sought.
    watch: Option<OrbitWatch<N>>,
    settled: SettledWatch,
    still: bool,
    /// The saved run before its end time had any effect, if the run may be continued.
    kept: Option<Box<(Saved<N>, LaneRun<N>)>>,
    extended: bool,
}

/// The action on a run after a step.
pub(super) enum Next<const N: usize> {
    /// The run stays in its lane.
    Stay,
    /// The run moves to the group with displacements, or back.
    Move,
    /// The run continues later from this saved state.
    Continue(Box<(Saved<N>, LaneRun<N>)>),
    /// The run has ended.
    Done(Box<Outcome>),
    /// The run must be computed alone.
    Fallback,
}

impl<const N: usize> LaneRun<N> {
    /// Creates a run at its start.
    ///
    /// # Errors
    /// If the motion cannot be started from the start state.
    pub(super) fn start(
        number: u64,
        prepared: Prepared<N>,
        simulation: &Simulation,
    ) -> Result<(Saved<N>, Self), Failure> {
        let Prepared { balancer, state, settings, units, horizons, watch } = prepared;
        let saved = Saved::start(&balancer, settings, state)?;
        let run = LaneRun {
            number,
            balancer,
            settings,
            units,
            extend: simulation.extend,
            horizons,
            watch,
            settled: SettledWatch::default(),
            still: false,
            kept: None,
            extended: false,
        };
        Ok((saved, run))
    }

    /// Returns the run's end time.
    pub(super) fn end(&self) -> f64 {
        self.horizons.end()
    }

    /// Returns whether the run needs a displacement at a time.
    pub(super) fn is_displaced(&self, time: f64) -> bool {
        let separation = &self.horizons.window().separation;
        separation.has_begun() && separation.follows(time)
    }

    /// Must be called when the run has been put into a lane: it may be at rest already.
    pub(super) fn begins<S: Simd>(
        mut self: Box<Self>,
        group: &mut Group<S, N>,
        lane: usize,
    ) -> (Next<N>, Option<Box<Self>>) {
        if let Some(ending) = self.rests(group, lane) {
            return (self.ends(group, lane, ending), None);
        }
        group.set_told(lane, self.watch.is_some());
        self.plan(group, lane);
        (Next::Stay, Some(self))
    }

    /// Passes the start of the run to a recorder.
    pub(super) fn show_start<S: Simd>(
        &self,
        recorder: &mut Recorder,
        group: &Group<S, N>,
        lane: usize,
    ) {
        if let Some(mut motion) = group.motion(lane, &self.balancer) {
            recorder.take_in(&self.balancer, &mut motion);
        }
    }

    /// Passes the latest step to a recorder.
    pub(super) fn show<S: Simd>(
        &self,
        recorder: &mut Recorder,
        group: &Group<S, N>,
        room: &Room<S, N>,
        lane: usize,
        had_event: bool,
    ) {
        if let Some(mut motion) = group.motion_with_step(room, lane, had_event, &self.balancer) {
            recorder.take_in(&self.balancer, &mut motion);
        }
    }

    /// Evaluates the latest step.
    pub(super) fn look<S: Simd>(
        &mut self,
        group: &mut Group<S, N>,
        room: &Room<S, N>,
        lane: usize,
        happened: &Happened,
    ) -> Next<N> {
        let bit = 1 << lane;
        match happened.trouble[lane] {
            Some(Trouble::Failure(failure)) => {
                return self.ends(group, lane, Ending::Failure(failure));
            }
            Some(Trouble::Fallback) => return Next::Fallback,
            None => {}
        }
        let time = group.time(lane);
        let displaced = self.is_displaced(time);
        let late = self.horizons.window_mut();
        if time > late.means.start() {
            late.means.take_in(LaneStep { group, room, lane });
        }
        if displaced {
            self.separate(group, lane, time, happened.attention & bit != 0);
        } else if late.separation.follows(time) && !late.separation.has_begun() {
            group.displace(lane);
            late.separation.begin(time, group.courses(lane));
        }
        if happened.still & bit != 0 || self.still {
            self.still = happened.still & bit != 0;
            if let Some(motion) = group.motion(lane, &self.balancer)
                && self.settled.look(&self.balancer, &motion, self.horizons.end())
            {
                return self.ends(group, lane, Ending::Settled);
            }
        }
        if (happened.event | happened.round | happened.turned) & bit != 0
            && let Some(orbit) = self.closes(group, room, lane, happened.event & bit != 0)
        {
            return self.ends(group, lane, Ending::Cycle(orbit));
        }
        if time >= self.horizons.end() {
            return self.ends_in_time(group, lane);
        }
        if happened.rest & bit != 0
            && let Some(ending) = self.rests(group, lane)
        {
            return self.ends(group, lane, ending);
        }
        self.plan(group, lane);
        if self.is_displaced(time) == displaced { Next::Stay } else { Next::Move }
    }

    /// Records the growth of the displacement when that is due or its size is out of range. Other
    /// inspections of the run do not affect the result.
    fn separate<S: Simd>(&mut self, group: &mut Group<S, N>, lane: usize, time: f64, asked: bool) {
        if !asked {
            return;
        }
        let displaced = group.displaced(lane);
        let due = time >= self.horizons.window().separation.next_mark();
        if !due && HANDY.contains(&displaced.size) {
            return;
        }
        group.normalise(lane, displaced.size);
        let courses = group.courses(lane);
        let separation = &mut self.horizons.window_mut().separation;
        separation.grow(time, displaced.size, displaced.grazed, courses);
    }

    /// Returns the limit cycle that the run has been shown to be on.
    fn closes<S: Simd>(
        &mut self,
        group: &Group<S, N>,
        room: &Room<S, N>,
        lane: usize,
        had_event: bool,
    ) -> Option<super::Orbit<N>> {
        let watch = self.watch.as_mut()?;
        let (phases, end) = group.at_end_of_step(room, lane)?;
        let reference = watch.goes_round(&phases, &end)?;
        let passage = group.passage(room, lane, reference);
        let last_switches = group.last_switches(lane)?;
        let direction = end.beta_dot[reference].signum();
        let phases = group.phases_during_step(lane, had_event)?;
        let round = GoneRound { reference, direction, passage, phases, last_switches };
        watch.take_in(&self.balancer, &self.settings, round)
    }

    /// Returns whether all balls stick and can never break loose again.
    fn rests<S: Simd>(&self, group: &Group<S, N>, lane: usize) -> Option<Ending<N>> {
        if !group.all_stick(lane) {
            return None;
        }
        let state = group.state(lane);
        let rest = self.balancer.rest_point(&state.beta);
        certified(&self.balancer, &rest, &state).then_some(Ending::Rest(rest))
    }

    /// Schedules the next inspection of the run, and saves the run if its end time may affect the
    /// next step.
    fn plan<S: Simd>(&mut self, group: &mut Group<S, N>, lane: usize) {
        let Late { means, separation } = self.horizons.window();
        let mut attention = means.start();
        if !separation.has_begun() {
            attention = attention.min(separation.start());
        } else if self.is_displaced(group.time(lane)) {
            attention = attention.min(separation.next_mark());
        }
        if let Some(later) = self.horizons.later_window()
            && self.kept.is_none()
        {
            let depends =
                later.separation.start().min(later.means.start()).min(self.horizons.end());
            if group.reaches(lane, depends) {
                let run = self.clone();
                self.kept = group.copy(lane).map(|saved| Box::new((saved, run)));
            } else {
                attention = attention.min(depends - 1.01 * group.longest(lane));
            }
        }
        group.set_attention(lane, attention);
    }

    /// Ends the run at its end time, or continues it to the later one.
    fn ends_in_time<S: Simd>(&mut self, group: &Group<S, N>, lane: usize) -> Next<N> {
        let Some(mut run) = self.by_itself(group, lane) else { return Next::Fallback };
        let ending = run.at_end_time();
        let outcome = run.outcome(ending);
        if let (Some(extend), Some(mut kept)) = (self.extend, self.kept.take())
            && continues(extend, outcome.label())
        {
            kept.1.horizons.extend();
            kept.1.extended = true;
            return Next::Continue(kept);
        }
        Next::Done(Box::new(Outcome { extended: self.extended, ..outcome }))
    }

    fn ends<S: Simd>(&self, group: &Group<S, N>, lane: usize, ending: Ending<N>) -> Next<N> {
        match self.by_itself(group, lane) {
            Some(run) => {
                let outcome = run.outcome(ending);
                Next::Done(Box::new(Outcome { extended: self.extended, ..outcome }))
            }
            None => Next::Fallback,
        }
    }

    fn by_itself<S: Simd>(&self, group: &Group<S, N>, lane: usize) -> Option<BalancerRun<'_, N>> {
        Some(BalancerRun {
            balancer: &self.balancer,
            settings: self.settings,
            units: self.units,
            motion: group.motion(lane, &self.balancer)?,
            horizons: self.horizons.clone(),
            watch: self.watch.clone(),
            settled: self.settled,
            rest: None,
        })
    }
}

/// The latest step of a lane.
struct LaneStep<'a, S: Simd, const N: usize> {
    group: &'a Group<S, N>,
    room: &'a Room<S, N>,
    lane: usize,
}

impl<S: Simd, const N: usize> Taken<N> for LaneStep<'_, S, N> {
    fn ends(&self) -> [f64; 2] {
        [self.group.time_before(self.lane), self.group.time(self.lane)]
    }

    fn angles(&mut self, after: f64) -> [f64; N] {
        self.group.angles_within(self.room, self.lane, after)
    }

    fn squares(&mut self, after: [f64; NODES.len()]) -> [f64; NODES.len()] {
        self.group.squares_within(self.room, self.lane, after)
    }
}
