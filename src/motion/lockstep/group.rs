//! Eight lanes: the vectorised part of the runs.

use fearless_simd::{Simd, prelude::*};

use super::equations::Equations;
use super::event_functions::{Doubts, Watched};
use super::lane::{Lane, Saved, rest_radius_squared};
use super::series::Series;
use super::{Flow, LANES, Lanes};
use crate::model::{State, System};
use crate::motion::contact::Phase;
use crate::motion::driver::{Motion, TrajectoryState};
use crate::motion::first_switch::LastStep;
use crate::motion::interpolant::Interpolant;
use crate::motion::settings::MOST_PER_TIME;
use crate::motion::{Effort, Step};

/// Ratio of the longest step to that of a run computed alone: 5 over the highest frequency of the
/// table in the turning frame, `1 + |ω|`. The tolerance would allow longer steps, because errors
/// become visible in the next step, but displacements are not subject to the tolerance, and the
/// terms of their series (`tangent`) are accurate up to this length. Hardly any step is as long.
const LONGEST: f64 = 5.0 / std::f64::consts::FRAC_PI_2;

/// Eight lanes, some of them empty.
pub(crate) struct Group<S: Simd, const N: usize> {
    pub(super) state: Flow<S, N>,
    pub(super) time: Lanes<S>,
    pub(super) until: Lanes<S>,
    pub(super) attention: Lanes<S>,
    pub(super) longest: Lanes<S>,
    pub(super) next: Lanes<S>,
    pub(super) tolerance: [Lanes<S>; 2],
    pub(super) equations: Equations<S, N>,
    pub(super) watched: [Watched<S>; N],
    pub(super) turns: [Lanes<S>; N],
    pub(super) slow: Lanes<S>,
    pub(super) slow_since: [Lanes<S>; N],
    pub(super) rest: [Lanes<S>; 2],
    pub(super) rest_radius_squared: Lanes<S>,
    /// Number of steps taken.
    pub(super) taken: Lanes<S>,
    pub(super) most: Lanes<S>,
    /// Number of steps allowed per unit of time.
    pub(super) most_per_time: Lanes<S>,
    pub(super) displacement: Flow<S, N>,
    pub(super) lanes: [Option<Lane<N>>; LANES],
    /// Bit masks: lanes with a run, and lanes with a ball that cannot stick.
    pub(super) alive: u64,
    pub(super) sliding: u64,
    /// Lanes for which turns and switches are reported.
    pub(super) told: u64,
    /// The state before the latest step.
    pub(super) before: Flow<S, N>,
    pub(super) time_before: Lanes<S>,
}

/// Work space of a step, with the results of the latest step.
pub(crate) struct Room<S: Simd, const N: usize> {
    pub(super) series: Series<S, N>,
    pub(super) displaced: Series<S, N>,
    pub(super) doubts: Doubts<S, N>,
    /// The step's end, with angles not yet reduced to one turn.
    pub(super) end: Flow<S, N>,
    pub(super) length: Lanes<S>,
}

impl<S: Simd, const N: usize> Room<S, N> {
    pub(crate) fn new(simd: S) -> Self {
        Room {
            series: Series::zero(simd),
            displaced: Series::zero(simd),
            doubts: Doubts::none(simd),
            end: Flow::zero(simd),
            length: Lanes::splat(simd, 0.0),
        }
    }
}

impl<S: Simd, const N: usize> Group<S, N> {
    /// Empty lanes.
    pub(crate) fn new(simd: S) -> Self {
        let constant = |value: f64| Lanes::splat(simd, value);
        let zero = constant(0.0);
        Group {
            state: Flow::zero(simd),
            time: zero,
            until: constant(1.0),
            attention: constant(f64::INFINITY),
            longest: zero,
            next: constant(1.0),
            tolerance: [constant(1.0); 2],
            equations: Equations::blank(simd),
            watched: [Watched::nothing(simd); N],
            turns: [zero; N],
            slow: zero,
            slow_since: [zero; N],
            rest: [zero; 2],
            rest_radius_squared: constant(-1.0),
            taken: zero,
            most: constant(f64::INFINITY),
            most_per_time: zero,
            displacement: Flow::zero(simd),
            lanes: std::array::from_fn(|_| None),
            alive: 0,
            sliding: 0,
            told: 0,
            before: Flow::zero(simd),
            time_before: zero,
        }
    }

    /// Returns an empty lane, or `None` if all lanes have a run.
    pub(crate) fn empty_lane(&self) -> Option<usize> {
        let lane = (!self.alive).trailing_zeros() as usize;
        (lane < LANES).then_some(lane)
    }

    /// Returns the number of lanes with a run.
    pub(crate) fn runs(&self) -> u32 {
        self.alive.count_ones()
    }

    /// Puts a run into a lane, until a time at the latest.
    pub(crate) fn put(&mut self, lane: usize, saved: &Saved<N>, until: f64) {
        let Saved { lane: own, .. } = saved;
        let balancer = &own.balancer;
        self.equations.set_machine(lane, balancer);
        for (i, ball) in balancer.balls.iter().enumerate() {
            self.watched[i].limit[lane] = ball.friction.limit;
            self.turns[i][lane] = saved.turns[i];
            self.slow_since[i][lane] = saved.slow_since[i];
        }
        let tolerance = own.settings.tolerance;
        self.tolerance[0][lane] = tolerance.relative;
        self.tolerance[1][lane] = tolerance.absolute;
        self.time[lane] = saved.time;
        self.until[lane] = until;
        self.attention[lane] = f64::INFINITY;
        self.next[lane] = saved.next;
        self.slow[lane] = own.slow;
        self.taken[lane] = saved.taken;
        self.most[lane] = own.settings.effort_limit as f64;
        self.most_per_time[lane] = MOST_PER_TIME * balancer.pace();
        self.displacement.set_lane(lane, &saved.displacement);
        let bit = 1 << lane;
        self.alive |= bit;
        let slides = balancer.balls.iter().any(|ball| !ball.friction.can_stick());
        self.sliding = self.sliding & !bit | if slides { bit } else { 0 };
        self.lanes[lane] = Some(own.clone());
        self.set_phases(lane, &own.phases);
        self.state.set_lane(lane, &saved.state);
        self.set_rest(lane);
    }

    /// Sets the coefficients of equations and conditions that depend on the phases of a lane.
    fn set_phases(&mut self, lane: usize, phases: &[Phase; N]) {
        let Some(own) = &mut self.lanes[lane] else { return };
        own.phases = *phases;
        self.longest[lane] = LONGEST * own.balancer.longest_step();
        self.equations.set_phases(lane, &own.balancer, phases);
        let margins = [own.margins.band, own.margins.slack, 0.5 * own.width];
        for (watched, phase) in self.watched.iter_mut().zip(phases) {
            watched.set(lane, *phase, margins);
        }
    }

    fn set_rest(&mut self, lane: usize) {
        let Some(own) = &self.lanes[lane] else { return };
        self.rest_radius_squared[lane] = -1.0;
        if own.phases.iter().all(|phase| *phase == Phase::Stick) {
            let rest = own.balancer.rest_point(&self.state.lane(lane).beta);
            self.rest[0][lane] = rest.position[0];
            self.rest[1][lane] = rest.position[1];
            self.rest_radius_squared[lane] = rest_radius_squared(&own.balancer, &rest);
        }
    }

    /// Starts a phase in a lane.
    pub(super) fn enter(&mut self, lane: usize, state: &State<N>, phases: &[Phase; N]) {
        self.state.set_lane(lane, state);
        self.set_phases(lane, phases);
        self.set_rest(lane);
    }

    /// Takes a run out of its lane.
    pub(crate) fn take(&mut self, lane: usize) -> Option<Saved<N>> {
        let saved = self.copy(lane);
        let bit = 1 << lane;
        self.alive &= !bit;
        self.sliding &= !bit;
        self.lanes[lane] = None;
        // The lane takes steps of length 0 until it has a run again.
        self.until[lane] = self.time[lane];
        self.rest_radius_squared[lane] = -1.0;
        self.attention[lane] = f64::INFINITY;
        self.most[lane] = f64::INFINITY;
        saved
    }

    /// A copy of the run in a lane.
    pub(crate) fn copy(&self, lane: usize) -> Option<Saved<N>> {
        let own = self.lanes[lane].as_ref()?;
        Some(Saved {
            lane: own.clone(),
            time: self.time[lane],
            state: self.state.lane(lane),
            turns: self.turns.each_ref().map(|turns| turns[lane]),
            slow_since: self.slow_since.each_ref().map(|since| since[lane]),
            next: self.next[lane],
            taken: self.taken[lane],
            displacement: self.displacement.lane(lane),
        })
    }

    /// The time of a lane.
    pub(crate) fn time(&self, lane: usize) -> f64 {
        self.time[lane]
    }

    /// The time of a lane before its latest step.
    pub(crate) fn time_before(&self, lane: usize) -> f64 {
        self.time_before[lane]
    }

    /// Requests that a lane be reported after each step from a time on.
    pub(crate) fn set_attention(&mut self, lane: usize, from: f64) {
        self.attention[lane] = from;
    }

    /// Sets whether turns and switches of a lane are reported.
    pub(crate) fn set_told(&mut self, lane: usize, told: bool) {
        let bit = 1 << lane;
        self.told = self.told & !bit | if told { bit } else { 0 };
    }

    /// Returns whether a time may shorten the next step of a lane.
    pub(crate) fn reaches(&self, lane: usize, time: f64) -> bool {
        self.longest[lane] >= time - self.time[lane]
    }

    /// Returns the length of the longest possible step of a lane.
    pub(crate) fn longest(&self, lane: usize) -> f64 {
        let own = self.lanes[lane].as_ref();
        own.map_or(f64::INFINITY, |own| LONGEST * own.balancer.longest_step())
    }

    /// Returns the effort of the run in a lane.
    pub(super) fn effort(&self, lane: usize) -> Effort {
        let own = self.lanes[lane].as_ref();
        own.map_or_else(Effort::default, |own| own.effort(self.taken[lane]))
    }

    /// Returns the number of turns of balls, in both directions, and switches since the start of
    /// the run.
    pub(crate) fn courses(&self, lane: usize) -> f64 {
        let angle = |ball: usize| {
            self.turns[ball][lane] + self.state.angle[ball][lane] / std::f64::consts::TAU
        };
        let turns: f64 = (0..N).map(|ball| angle(ball).abs()).sum();
        turns + self.lanes[lane].as_ref().map_or(0.0, |own| own.switches as f64)
    }

    /// The present state in a lane.
    pub(crate) fn state(&self, lane: usize) -> State<N> {
        self.state.lane(lane)
    }

    /// Whether all balls of a lane stick.
    pub(crate) fn all_stick(&self, lane: usize) -> bool {
        let all = |own: &Lane<N>| own.phases.iter().all(|phase| *phase == Phase::Stick);
        self.lanes[lane].as_ref().is_some_and(all)
    }

    /// Returns the phases of a lane's balls in its latest step, before an event at its end.
    pub(crate) fn phases_during_step(&self, lane: usize, had_event: bool) -> Option<&[Phase; N]> {
        let own = self.lanes[lane].as_ref()?;
        Some(if had_event { &own.during } else { &own.phases })
    }

    /// Returns when each ball of a lane last changed its phase.
    pub(crate) fn last_switches(&self, lane: usize) -> Option<&[f64; N]> {
        self.lanes[lane].as_ref().map(|own| &own.last_switches)
    }

    /// Returns the phases of a lane's balls after its latest step, and the state at its end with
    /// angles not yet reduced to one turn.
    pub(crate) fn at_end_of_step(
        &self,
        room: &Room<S, N>,
        lane: usize,
    ) -> Option<([Phase; N], State<N>)> {
        let mut state = self.state.lane(lane);
        state.beta = room.end.lane(lane).beta;
        Some((self.lanes[lane].as_ref()?.phases, state))
    }

    fn trajectory_state(&self, lane: usize) -> Option<TrajectoryState<N, 2>> {
        let own = self.lanes[lane].as_ref()?;
        Some(TrajectoryState {
            time: self.time[lane],
            state: self.state.lane(lane),
            turns: self.turns.each_ref().map(|turns| turns[lane] as i64),
            phases: own.phases,
            next_length: self.next[lane],
            last_switches: own.last_switches,
            slow_since: self.slow_since.each_ref().map(|since| since[lane]),
            effort: self.effort(lane),
        })
    }

    /// Returns the motion in a lane, to be continued alone.
    pub(crate) fn motion<'a>(
        &self,
        lane: usize,
        balancer: &'a crate::model::Balancer<N>,
    ) -> Option<Motion<'a, crate::model::Balancer<N>, N>> {
        let own = self.lanes[lane].as_ref()?;
        Some(Motion::resume(balancer, own.settings, self.trajectory_state(lane)?, None))
    }

    /// Returns the motion in a lane with its latest step for evaluation, with angles not yet
    /// reduced to one turn.
    pub(crate) fn motion_with_step<'a>(
        &self,
        room: &Room<S, N>,
        lane: usize,
        had_event: bool,
        balancer: &'a crate::model::Balancer<N>,
    ) -> Option<Motion<'a, crate::model::Balancer<N>, N>> {
        let own = self.lanes[lane].as_ref()?;
        let mut course = self.trajectory_state(lane)?;
        let end = room.end.lane(lane);
        for ball in 0..N {
            let turns =
                ((end.beta[ball] - course.state.beta[ball]) / std::f64::consts::TAU).round();
            course.turns[ball] -= turns as i64;
            course.state.beta[ball] = end.beta[ball];
        }
        let start = self.before.lane(lane);
        let length = room.length[lane];
        let phases = *self.phases_during_step(lane, had_event)?;
        let powers = room.series.powers(lane, &start, length);
        let last = LastStep {
            step: Step::without_stages(start, end, length),
            phases,
            end_derivative: State::zero(),
            start_time: self.time_before[lane],
            used: 1.0,
            interpolant: Some(Interpolant::of_powers(powers)),
            ended_by: None,
        };
        Some(Motion::resume(balancer, own.settings, course, Some(last)))
    }
}
