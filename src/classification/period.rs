//! Properties of one period of a cycle: sequence of stick and slip, extremes, means, margins.

use super::cycle::CyclePhase;
use super::section::Section;
use crate::model::{Balancer, State};
use crate::motion::{Motion, Phase, derivative, forces};

/// Number of instants inside a step at which a resting ball's margin is evaluated.
const LOOKS: usize = 8;

/// One period, accumulated step by step.
pub(super) struct Period<const N: usize> {
    rests: [bool; N],
    time: f64,
    state: State<N>,
    /// The sequence of phases of the balls.
    pub(super) configurations: Vec<[CyclePhase; N]>,
    /// Least and greatest speed of each ball.
    pub(super) speeds: [[f64; 2]; N],
    /// Least and greatest angle of each ball.
    pub(super) angles: [[f64; 2]; N],
    /// Greatest displacement of the table.
    pub(super) peak: f64,
    /// Integral over time of its square.
    pub(super) square_time: f64,
    /// The smallest friction margin of a resting ball.
    pub(super) margin: f64,
}

fn widen([low, high]: &mut [f64; 2], value: f64) {
    (*low, *high) = (low.min(value), high.max(value));
}

fn square<const N: usize>(state: &State<N>) -> f64 {
    state.position.iter().map(|p| p * p).sum()
}

/// Half of the rate of change of the square.
fn outward<const N: usize>(state: &State<N>) -> f64 {
    state.position.iter().zip(&state.velocity).map(|(p, v)| p * v).sum()
}

impl<const N: usize> Period<N> {
    pub(super) fn new(balancer: &Balancer<N>, section: &Section<N>, start: &State<N>) -> Self {
        let mut period = Period {
            rests: section.rests,
            time: 0.0,
            state: *start,
            configurations: vec![cycle_phases(&section.phases, start)],
            speeds: start.beta_dot.map(|speed| [speed; 2]),
            angles: start.beta.map(|angle| [angle.rem_euclid(std::f64::consts::TAU); 2]),
            peak: square(start).sqrt(),
            square_time: 0.0,
            margin: f64::INFINITY,
        };
        period.look_at_margin(balancer, &section.phases, start);
        period
    }

    /// Adds a step with the phases `during` it; if the period ends inside the step, with time and
    /// state there.
    pub(super) fn take_in(
        &mut self,
        balancer: &Balancer<N>,
        motion: &mut Motion<'_, Balancer<N>, N>,
        during: &[Phase; N],
        end: Option<(f64, State<N>)>,
    ) {
        let ends = end.is_some();
        let (time, state) = end.unwrap_or((motion.time(), *motion.state()));
        let length = time - self.time;
        // The trapezoidal rule with end corrections (Euler and Maclaurin), of order 4.
        self.square_time += 0.5 * length * (square(&self.state) + square(&state))
            + length * length / 6.0 * (outward(&self.state) - outward(&state));
        self.peak = self.peak.max(square(&state).sqrt());
        if let Some((_, outermost)) = motion.falls_through_zero(outward) {
            self.peak = self.peak.max(square(&outermost).sqrt());
        }
        for ball in 0..N {
            let turns = [1.0, -1.0].map(|sign| {
                let acceleration =
                    |state: &State<N>| sign * derivative(balancer, during, state).beta_dot[ball];
                motion.falls_through_zero(acceleration).map(|(_, state)| state.beta_dot[ball])
            });
            for speed in turns.into_iter().flatten().chain([state.beta_dot[ball]]) {
                widen(&mut self.speeds[ball], speed);
            }
            // It turns back where it stops, usually at a switch at the step's end.
            let stops = [1.0, -1.0].map(|sign| {
                let stop = motion.falls_through_zero(|state| sign * state.beta_dot[ball]);
                stop.map(|(_, state)| state.beta[ball])
            });
            let whole_turns = motion.unwrapped_angle(ball) - motion.state().beta[ball];
            for angle in stops.into_iter().flatten().chain([state.beta[ball]]) {
                widen(&mut self.angles[ball], angle + whole_turns);
            }
        }
        if self.rests.contains(&true) {
            for look in 1..=LOOKS {
                let inside = self.time + look as f64 / LOOKS as f64 * length;
                if let Some(state) = motion.within_last_step(inside) {
                    self.look_at_margin(balancer, during, &state);
                }
            }
        }
        // At its end the period returns to its start.
        let now = cycle_phases(motion.phases(), &state);
        if !ends && self.configurations.last() != Some(&now) {
            self.configurations.push(now);
        }
        if ends
            && self.configurations.len() > 1
            && self.configurations.last() == self.configurations.first()
        {
            self.configurations.pop();
        }
        (self.time, self.state) = (time, state);
    }

    fn look_at_margin(&mut self, balancer: &Balancer<N>, phases: &[Phase; N], state: &State<N>) {
        if !self.rests.contains(&true) {
            return;
        }
        let forces = forces(balancer, phases, state);
        for ball in (0..N).filter(|&ball| self.rests[ball]) {
            let limit = balancer.balls[ball].friction.limit * forces.normal[ball];
            self.margin = self.margin.min(1.0 - forces.friction[ball].abs() / limit);
        }
    }
}

fn cycle_phases<const N: usize>(phases: &[Phase; N], state: &State<N>) -> [CyclePhase; N] {
    std::array::from_fn(|ball| CyclePhase::of(phases[ball], state.beta_dot[ball]))
}
