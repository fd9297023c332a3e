//! The switch model (thesis sections 4.2 and 4.3, after Leine): smooth phases joined by switches.
//!
//! Around zero speed of each ball lies a band `|β̇| ≤ η`. Outside it a ball slips; inside it either
//! sticks, its angle kept and its speed pushed to the middle of the band, or is in transition,
//! against full friction. The thesis evaluates that vector field inside a general solver. Here
//! every smooth phase is integrated with its configuration frozen, the instant at which a condition
//! of the configuration fails is located on the dense output, and the next configuration is decided
//! for all balls in the band together; no step crosses a switch, so that the method keeps its order.

use super::contact::{Phase, contacts, decide};
use super::dop853::{Interpolant, Step, Tolerance};
use super::guard::Guard;
use super::{Failure, fall_through_zero};
use crate::model::{Balancer, Contact, Forces, State};

/// How a motion is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Half width `η` of the band, over `ω_n`.
    pub band: f64,
    /// Errors allowed per step.
    pub tolerance: Tolerance,
    /// Most steps, accepted and rejected, and switches together.
    pub effort_limit: u64,
}

/// What a motion has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Accepted steps.
    pub steps: u64,
    /// Steps rejected by error control.
    pub rejected_steps: u64,
    /// Changes of a ball's phase.
    pub switches: u64,
}

/// A motion in progress.
#[derive(Clone, Debug)]
pub struct SwitchModel<'a, const N: usize> {
    balancer: &'a Balancer<N>,
    settings: Settings,
    time: f64,
    state: State<N>,
    turns: [i64; N],
    phases: [Phase; N],
    forces: Forces<N>,
    derivative: State<N>,
    next_length: f64,
    longest: f64,
    last_switches: [f64; N],
    in_band_since: [f64; N],
    effort: Effort,
    last: Option<LastStep<N>>,
}

/// The latest step as it was computed, for looking inside.
#[derive(Clone, Debug)]
struct LastStep<const N: usize> {
    step: Step<N>,
    contacts: [Contact; N],
    end_derivative: State<N>,
    start_time: f64,
    /// The part of the step that was used: less than 1 where a switch cut it short.
    used: f64,
    interpolant: Option<Interpolant<N>>,
}

impl<const N: usize> LastStep<N> {
    /// Dense output over the step, made when first asked for.
    fn interpolant(&mut self, balancer: &Balancer<N>) -> &Interpolant<N> {
        let (step, contacts) = (&self.step, &self.contacts);
        let end_derivative = &self.end_derivative;
        self.interpolant.get_or_insert_with(|| {
            let right_hand_side = |state: &State<N>| {
                balancer.derivative(state, contacts, &balancer.forces(state, contacts))
            };
            step.interpolant(right_hand_side, end_derivative)
        })
    }
}

/// The shortest step, over the time that has passed, that still moves the clock.
const SHORTEST: f64 = 1e-14;

impl<'a, const N: usize> SwitchModel<'a, N> {
    /// A motion that starts from `state` at time 0.
    ///
    /// # Errors
    /// [`Failure`] where the start state itself cannot be continued.
    pub fn new(
        balancer: &'a Balancer<N>,
        settings: Settings,
        state: State<N>,
    ) -> Result<Self, Failure> {
        let mut phases = state.beta_dot.map(|speed| {
            if speed.abs() > settings.band { Phase::Slip(speed.signum()) } else { Phase::Stick }
        });
        let forces = decide(balancer, &state, &mut phases)?;
        let derivative = balancer.derivative(&state, &contacts(balancer, &phases), &forces);
        // A quarter of the shortest period of the table in the turning frame: within it, a
        // friction force can hardly rise and fall back unseen.
        let longest = 0.5 * std::f64::consts::PI / (balancer.speed.abs() + 1.0);
        check_forces(&forces)?;
        let mut motion = SwitchModel {
            balancer,
            settings,
            time: 0.0,
            state,
            turns: [0; N],
            phases,
            forces,
            derivative,
            next_length: 0.1 * longest,
            longest,
            last_switches: [0.0; N],
            in_band_since: [0.0; N],
            effort: Effort::default(),
            last: None,
        };
        motion.wrap_angles();
        motion.turns = [0; N];
        Ok(motion)
    }

    /// Non-dimensional time.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The present state. Angles lie within a step of [0, 2π); whole turns are counted apart.
    pub fn state(&self) -> &State<N> {
        &self.state
    }

    /// Angle of a ball, rad, with the whole turns that it has made since the start.
    pub fn unwrapped_angle(&self, ball: usize) -> f64 {
        self.state.beta[ball] + self.turns[ball] as f64 * std::f64::consts::TAU
    }

    /// What each ball does.
    pub fn phases(&self) -> &[Phase; N] {
        &self.phases
    }

    /// Accelerations and forces in the present state.
    pub fn forces(&self) -> &Forces<N> {
        &self.forces
    }

    /// When each ball last changed its phase; 0 where it has not.
    pub fn last_switches(&self) -> &[f64; N] {
        &self.last_switches
    }

    /// When each ball last came into the band; 0 where it has been there from the start.
    pub fn in_band_since(&self) -> &[f64; N] {
        &self.in_band_since
    }

    /// What the motion has cost so far.
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// Whether all balls stick.
    pub fn all_stick(&self) -> bool {
        self.phases.iter().all(|phase| *phase == Phase::Stick)
    }

    /// Goes on by one step, which ends at the next switch or at time `until` at the latest.
    /// Returns whether a ball changed its phase.
    ///
    /// # Errors
    /// [`Failure`]; the motion then stands where it last was sound.
    pub fn advance(&mut self, until: f64) -> Result<bool, Failure> {
        self.wrap_angles();
        let contacts = contacts(self.balancer, &self.phases);
        let balancer = self.balancer;
        let right_hand_side = |state: &State<N>| {
            balancer.derivative(state, &contacts, &balancer.forces(state, &contacts))
        };
        let (step, suggestion) = loop {
            let effort = self.effort;
            if effort.steps + effort.rejected_steps + effort.switches >= self.settings.effort_limit
            {
                return Err(Failure::StepLimit);
            }
            let length = self.next_length.min(self.longest).min(until - self.time);
            let step = Step::attempt(right_hand_side, &self.state, &self.derivative, length);
            let error = step.error(self.settings.tolerance);
            // Error control of DOP853: order 8, safety 0.9, change between 1/3 and 6.
            let change = 0.9 / error.sqrt().sqrt().sqrt();
            if error <= 1.0 {
                break (step, length * change.clamp(0.333, 6.0));
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
        };
        let end_forces = balancer.forces(&step.end, &contacts);
        let end_derivative = balancer.derivative(&step.end, &contacts, &end_forces);
        let shortened = step.length < suggestion && step.length < self.next_length;
        self.next_length = if shortened { self.next_length } else { suggestion };
        self.effort.steps += 1;
        let mut last = LastStep {
            step,
            contacts,
            end_derivative,
            start_time: self.time,
            used: 1.0,
            interpolant: None,
        };

        let switched = if let Some(theta) = self.first_switch(&mut last, &end_forces) {
            let at_switch =
                if theta > 0.0 { last.interpolant(balancer).at(theta) } else { self.state };
            let mut phases = self.phases;
            for (ball, phase) in phases.iter_mut().enumerate() {
                *phase = reclassify(*phase, at_switch.beta_dot[ball], self.settings.band);
            }
            let forces = decide(balancer, &at_switch, &mut phases)?;
            check_forces(&forces)?;
            if phases != self.phases {
                last.used = theta;
                self.time = last.start_time + theta * last.step.length;
                self.state = at_switch;
                self.forces = forces;
                for (ball, last_switch) in self.last_switches.iter_mut().enumerate() {
                    if phases[ball] != self.phases[ball] {
                        self.effort.switches += 1;
                        *last_switch = self.time;
                        if !self.phases[ball].in_band() {
                            self.in_band_since[ball] = self.time;
                        }
                    }
                }
                self.phases = phases;
                let contacts = super::contact::contacts(balancer, &phases);
                self.derivative = balancer.derivative(&self.state, &contacts, &self.forces);
                true
            } else {
                false
            }
        } else {
            false
        };
        if !switched {
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
        self.last = Some(last);
        Ok(switched)
    }

    /// Where in the latest step a ball went once round, through the angle 0: time and state there,
    /// if it did.
    pub fn passage(&mut self, ball: usize) -> Option<(f64, State<N>)> {
        let balancer = self.balancer;
        let last = self.last.as_mut()?;
        let (start, end) = (last.step.start.beta[ball], self.state.beta[ball]);
        let (mark, sign) = if start < std::f64::consts::TAU && end >= std::f64::consts::TAU {
            (std::f64::consts::TAU, 1.0)
        } else if start > 0.0 && end <= 0.0 {
            (0.0, -1.0)
        } else {
            return None;
        };
        let used = last.used;
        let (start_time, length) = (last.start_time, last.step.length);
        let interpolant = last.interpolant(balancer);
        let ahead = |theta: f64| sign * (mark - interpolant.at(theta).beta[ball]);
        let theta = fall_through_zero(
            ahead,
            (0.0, sign * (mark - start)),
            (used, sign * (mark - end)),
            1e-13,
        );
        Some((start_time + theta * length, interpolant.at(theta)))
    }

    /// The first instant of the step, as a fraction, at which a condition fails.
    fn first_switch(&self, last: &mut LastStep<N>, end_forces: &Forces<N>) -> Option<f64> {
        let balancer = self.balancer;
        let band = self.settings.band;
        let mut first: Option<f64> = None;
        for guard in Guard::all(&self.phases) {
            let start = guard.value(balancer, band, (&self.state, &self.forces));
            let end = guard.value(balancer, band, (&last.step.end, end_forces));
            let dips = || {
                guard.may_dip(balancer, last.step.length, (start, end), (&self.forces, end_forces))
            };
            if end >= 0.0 && !dips() {
                continue;
            }
            let contacts = last.contacts;
            let interpolant = last.interpolant(balancer);
            let failure = guard.first_failure((start, end), |theta| {
                let state = interpolant.at(theta);
                let forces = balancer.forces(&state, &contacts);
                guard.value(balancer, band, (&state, &forces))
            });
            first = match (first, failure) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            };
        }
        first
    }

    /// Brings angles into [0, 2π), counting whole turns apart.
    fn wrap_angles(&mut self) {
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

/// Refuses forces that are not finite and normal forces that pull.
fn check_forces<const N: usize>(forces: &Forces<N>) -> Result<(), Failure> {
    let Forces { table_acceleration, beta_ddot, normal, .. } = forces;
    if !table_acceleration.iter().chain(beta_ddot).chain(normal).all(|force| force.is_finite()) {
        return Err(Failure::NotFinite);
    }
    match normal.iter().position(|&force| force <= 0.0) {
        Some(ball) => Err(Failure::ContactLost { ball: ball + 1 }),
        None => Ok(()),
    }
}

/// The phase that a ball's speed alone gives at a switch; which phase it has in the band is decided
/// after that.
fn reclassify(phase: Phase, speed: f64, band: f64) -> Phase {
    match phase {
        Phase::Slip(direction) if direction * speed <= band => Phase::Stick,
        Phase::Transition(direction) if direction * speed >= band => Phase::Slip(direction),
        _ => phase,
    }
}
