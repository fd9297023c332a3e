//! A motion in progress: smooth phases, joined by switches that are located on the dense output.
//!
//! Every smooth phase is integrated with the phase of each contact fixed. The step ends at the
//! instant at which a condition of the phase fails, and the method (the switch model or its limit)
//! decides the next phase; no step crosses a switch, so that the integrator keeps its order.

use super::cancellation::unwind_if_cancelled;
use super::contact::{Phase, SmoothPhase, check_forces, derivative};
use super::dop853::Step;
use super::first_switch::{FirstSwitch, LastStep};
use super::guard::Margins;
use super::settings::{Effort, Settings, most_steps_by};
use super::{Failure, event_driven, switch_model};
use crate::model::{Forces, Method, State, System};

/// Speed, over `ω_n`, below which a contact counts as slow; see [`Motion::slow_since`].
pub const SLOW: f64 = 1e-6;

/// A motion in progress.
#[derive(Clone, Debug)]
pub struct Motion<'a, S, const N: usize, const FREE: usize = 2> {
    system: &'a S,
    settings: Settings,
    margins: Margins,
    slow: f64,
    pace: f64,
    time: f64,
    state: State<N, f64, FREE>,
    turns: [i64; N],
    phases: [Phase; N],
    forces: Forces<N, f64, FREE>,
    derivative: State<N, f64, FREE>,
    next_length: f64,
    longest: f64,
    last_switches: [f64; N],
    slow_since: [f64; N],
    effort: Effort,
    last: Option<LastStep<N, FREE>>,
}

/// The state of a motion, from which it can be resumed.
#[derive(Clone, Debug)]
pub(super) struct TrajectoryState<const N: usize, const FREE: usize> {
    pub(super) time: f64,
    pub(super) state: State<N, f64, FREE>,
    pub(super) turns: [i64; N],
    pub(super) phases: [Phase; N],
    pub(super) next_length: f64,
    pub(super) last_switches: [f64; N],
    pub(super) slow_since: [f64; N],
    pub(super) effort: Effort,
}

/// The shortest step, over the elapsed time, that still changes the time.
pub(super) const SHORTEST: f64 = 1e-14;

impl<'a, S: System<N, FREE>, const N: usize, const FREE: usize> Motion<'a, S, N, FREE> {
    /// Starts a motion from `state` at time 0.
    ///
    /// # Errors
    /// [`Failure`] if the motion cannot be continued from the start state.
    pub fn new(
        system: &'a S,
        settings: Settings,
        state: State<N, f64, FREE>,
    ) -> Result<Self, Failure> {
        let Settings { method, band, .. } = settings;
        let (margins, slow) = margins(system, &settings);
        let mut phases = std::array::from_fn(|ball| {
            let (can_stick, speed) = (system.friction(ball).can_stick(), state.beta_dot[ball]);
            match method {
                Method::Switch => switch_model::first_phase(can_stick, speed, band),
                Method::Event => event_driven::first_phase(can_stick, speed),
            }
        });
        let forces = match method {
            Method::Switch => switch_model::decide(system, &state, &mut phases)?,
            Method::Event => {
                let at_rest = phases.map(|phase| phase == Phase::Stick);
                event_driven::decide(system, &state, &mut phases, at_rest)?
            }
        };
        check_forces(&forces)?;
        let longest = system.longest_step();
        let mut motion = Motion {
            system,
            settings,
            margins,
            slow,
            pace: system.pace(),
            time: 0.0,
            derivative: derivative(system, &phases, &state),
            state,
            turns: [0; N],
            phases,
            forces,
            next_length: 0.1 * longest,
            longest,
            last_switches: [0.0; N],
            slow_since: [0.0; N],
            effort: Effort::default(),
            last: None,
        };
        motion.wrap_angles();
        motion.turns = [0; N];
        Ok(motion)
    }

    /// Resumes a motion, with its latest step for evaluation.
    pub(super) fn resume(
        system: &'a S,
        settings: Settings,
        course: TrajectoryState<N, FREE>,
        last: Option<LastStep<N, FREE>>,
    ) -> Self {
        let TrajectoryState {
            time,
            state,
            turns,
            phases,
            next_length,
            last_switches,
            slow_since,
            effort,
        } = course;
        let (margins, slow) = margins(system, &settings);
        let phase = SmoothPhase::new(system, &phases);
        let forces = phase.forces(&state);
        Motion {
            system,
            settings,
            margins,
            slow,
            pace: system.pace(),
            time,
            state,
            turns,
            phases,
            derivative: phase.derivative_with(&state, &forces),
            forces,
            next_length,
            longest: system.longest_step(),
            last_switches,
            slow_since,
            effort,
            last,
        }
    }

    /// Non-dimensional time.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The present state. Angles lie within a step of [0, 2π); whole turns are counted apart.
    pub fn state(&self) -> &State<N, f64, FREE> {
        &self.state
    }

    /// Angle of a ball, rad, with the whole turns that it has made since the start.
    pub fn unwrapped_angle(&self, ball: usize) -> f64 {
        self.state.beta[ball] + self.turns[ball] as f64 * std::f64::consts::TAU
    }

    /// Whole turns that each ball has made since the start.
    pub(super) fn turns(&self) -> &[i64; N] {
        &self.turns
    }

    /// Returns the phase of each ball.
    pub fn phases(&self) -> &[Phase; N] {
        &self.phases
    }

    /// Returns the phase of each ball in the latest step, before a switch at its end; the current
    /// phase if there was no step.
    pub fn phases_during_step(&self) -> &[Phase; N] {
        self.last.as_ref().map_or(&self.phases, |last| &last.phases)
    }

    /// The time derivative of the present state.
    pub fn derivative(&self) -> &State<N, f64, FREE> {
        &self.derivative
    }

    /// Accelerations and forces in the present state.
    pub fn forces(&self) -> &Forces<N, f64, FREE> {
        &self.forces
    }

    /// Returns when each ball last changed its phase; 0 if it has not.
    pub fn last_switches(&self) -> &[f64; N] {
        &self.last_switches
    }

    /// Returns the last time at which each ball was faster than [`SLOW`], or than the band if that
    /// is wider: 0 if it never was, and the current time if it is now.
    pub fn slow_since(&self) -> &[f64; N] {
        &self.slow_since
    }

    /// Returns whether all balls are slow in the sense of [`Motion::slow_since`].
    pub fn all_slow(&self) -> bool {
        self.state.beta_dot.iter().all(|speed| speed.abs() <= self.slow)
    }

    pub(super) fn system(&self) -> &'a S {
        self.system
    }

    pub(super) fn margins(&self) -> Margins {
        self.margins
    }

    pub(super) fn slow(&self) -> f64 {
        self.slow
    }

    /// Returns the latest step; `None` before the first.
    pub(super) fn last_step(&self) -> Option<&LastStep<N, FREE>> {
        self.last.as_ref()
    }

    /// Returns the effort so far.
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// Returns whether all balls stick.
    pub fn all_stick(&self) -> bool {
        self.phases.iter().all(|phase| *phase == Phase::Stick)
    }

    /// Returns whether [`Motion::advance`] to `until` may shorten its next step. If it may not,
    /// that step is bit for bit the one to any later time.
    pub fn reaches(&self, until: f64) -> bool {
        self.next_length.min(self.longest) >= until - self.time
    }

    /// Advances by one step, which ends at the next switch or at time `until` at the latest. If
    /// that time has passed, nothing happens. Returns whether a ball changed its phase.
    ///
    /// # Errors
    /// [`Failure`]; the motion then stays at its last valid state.
    pub fn advance(&mut self, until: f64) -> Result<bool, Failure> {
        if until <= self.time {
            self.last = None;
            return Ok(false);
        }
        self.wrap_angles();
        let system = self.system;
        let phases = self.phases;
        // If this step fails, there is no latest step.
        self.last = None;
        let (step, suggestion) = self.sound_step(until)?;
        let phase = SmoothPhase::new(system, &phases);
        let end_forces = phase.forces(&step.end);
        let end_derivative = phase.derivative_with(&step.end, &end_forces);
        let shortened = step.length <= suggestion && step.length < self.next_length;
        self.next_length = if shortened { self.next_length } else { suggestion };
        self.effort.steps += 1;
        let start_time = self.time;
        let mut last = LastStep {
            step,
            phases,
            end_derivative,
            start_time,
            used: 1.0,
            interpolant: None,
            ended_by: None,
        };
        // A condition that fails only by rounding changes no phase; the next condition may.
        let (mut switched, mut after) = (None, -1.0);
        while switched.is_none()
            && let Some(first) = last.first_switch(
                system,
                self.margins,
                ((&self.state, &self.forces), &self.derivative),
                &end_forces,
                after,
            )
        {
            switched = self.switch(&mut last, first)?;
            after = first.theta;
        }
        if switched.is_none() {
            check_forces(&end_forces)?;
            self.time = if until - self.time <= last.step.length {
                until
            } else {
                self.time + last.step.length
            };
            self.state = last.step.end;
            self.forces = end_forces;
            self.derivative = end_derivative;
        }
        for (since, speed) in self.slow_since.iter_mut().zip(self.state.beta_dot) {
            if speed.abs() > self.slow {
                *since = self.time;
            }
        }
        self.last = Some(last);
        Ok(switched.unwrap_or(false))
    }

    /// Returns a step within the tolerances, with fixed phases, and the length that error control
    /// suggests for the next step.
    fn sound_step(&mut self, until: f64) -> Result<(Step<N, f64, FREE>, f64), Failure> {
        let phase = SmoothPhase::new(self.system, &self.phases);
        loop {
            unwind_if_cancelled();
            let sound = most_steps_by(self.time, self.pace);
            if self.effort.total() >= sound.min(self.settings.effort_limit) {
                return Err(Failure::StepLimit);
            }
            let length = self.next_length.min(self.longest);
            if length < SHORTEST * self.time.max(1.0) {
                return Err(Failure::StepLimit);
            }
            let length = length.min(until - self.time);
            let right_hand_side = |state: &State<N, f64, FREE>| phase.derivative(state);
            let step = Step::attempt(right_hand_side, &self.state, &self.derivative, length);
            let error = step.error(self.settings.tolerance, S::ANGULAR);
            // Error control of DOP853: order 8, safety 0.9, change between 1/3 and 6.
            let change = 0.9 / error.sqrt().sqrt().sqrt();
            if error <= 1.0 {
                return Ok((step, length * change.clamp(0.333, 6.0)));
            }
            self.effort.rejected_steps += 1;
            self.next_length =
                if error.is_finite() { length * change.clamp(0.333, 1.0) } else { 0.1 * length };
            if self.next_length < SHORTEST * self.time.max(1.0) {
                return Err(if error.is_finite() {
                    Failure::StepLimit
                } else {
                    Failure::NotFinite
                });
            }
        }
    }

    /// Ends the step at a switch and starts the next phase. Returns whether a ball changed its
    /// phase, or `None` if the whole step remains valid.
    fn switch(
        &mut self,
        last: &mut LastStep<N, FREE>,
        FirstSwitch { theta, guard }: FirstSwitch,
    ) -> Result<Option<bool>, Failure> {
        let system = self.system;
        let mut state = if theta > 0.0 { last.interpolant(system).at(theta) } else { self.state };
        let mut phases = self.phases;
        let forces = match self.settings.method {
            Method::Switch => {
                let band = self.settings.band;
                let forces = switch_model::switch(system, band, &state, &mut phases)?;
                if phases == self.phases {
                    return Ok(None);
                }
                forces
            }
            Method::Event => {
                let slips = matches!(self.phases[guard.ball], Phase::Slip(_));
                let stopped_at_once = (theta == 0.0 && slips).then_some(guard.ball);
                event_driven::switch(system, &mut state, &mut phases, stopped_at_once)?
            }
        };
        check_forces(&forces)?;
        last.used = theta;
        last.ended_by = Some(guard);
        self.time = last.start_time + theta * last.step.length;
        self.state = state;
        self.forces = forces;
        for (ball, last_switch) in self.last_switches.iter_mut().enumerate() {
            if phases[ball] != self.phases[ball] {
                self.effort.switches += 1;
                *last_switch = self.time;
            }
        }
        let changed = phases != self.phases;
        self.phases = phases;
        self.derivative =
            SmoothPhase::new(system, &phases).derivative_with(&self.state, &self.forces);
        Ok(Some(changed))
    }

    /// Returns time and state at which a ball completed a turn, through the angle 0, in the latest
    /// step; `None` if it did not.
    pub fn passage(&mut self, ball: usize) -> Option<(f64, State<N, f64, FREE>)> {
        let (start, end) = (self.last.as_ref()?.step.start.beta[ball], self.state.beta[ball]);
        let (mark, sign) = if start < std::f64::consts::TAU && end >= std::f64::consts::TAU {
            (std::f64::consts::TAU, 1.0)
        } else if start > 0.0 && end <= 0.0 {
            (0.0, -1.0)
        } else {
            return None;
        };
        self.last.as_mut()?.passes(self.system, ball, end, (mark, sign))
    }

    /// Returns the state at a time within the latest step; `None` for any other time.
    pub fn within_last_step(&mut self, time: f64) -> Option<State<N, f64, FREE>> {
        if time == self.time {
            return Some(self.state);
        }
        let last = self.last.as_mut()?;
        let within = last.start_time <= time && time < self.time;
        let theta = (time - last.start_time) / last.step.length;
        within.then(|| last.interpolant(self.system).at(theta))
    }

    /// Returns time and state at which a function of the state fell from above zero to zero or
    /// below in the latest step; `None` if its signs at the two ends show no fall.
    pub fn falls_through_zero(
        &mut self,
        value: impl Fn(&State<N, f64, FREE>) -> f64,
    ) -> Option<(f64, State<N, f64, FREE>)> {
        self.last.as_mut()?.falls_through_zero(self.system, &self.state, value)
    }

    /// Reduces angles to [0, 2π), counting whole turns separately.
    fn wrap_angles(&mut self) {
        if !S::ANGULAR {
            return;
        }
        for ball in 0..N {
            let angle = self.state.beta[ball];
            if !(0.0..std::f64::consts::TAU).contains(&angle) {
                let turns = (angle / std::f64::consts::TAU).floor();
                self.state.beta[ball] = angle - turns * std::f64::consts::TAU;
                self.turns[ball] += turns as i64;
            }
        }
    }
}

/// Returns the tolerances of the conditions, and the speed below which a contact counts as slow.
fn margins<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    settings: &Settings,
) -> (Margins, f64) {
    let Settings { method, band, .. } = *settings;
    match method {
        Method::Switch => (Margins { band, slack: switch_model::SLACK }, SLOW.max(band)),
        Method::Event => (Margins { band: 0.0, slack: event_driven::release_slack(system) }, SLOW),
    }
}
