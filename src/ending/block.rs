//! One run of a block on a spring: simulated until its ending is known.
//!
//! On rigid ground a block that sticks stays: the spring's force on it no longer changes. On a belt
//! it is carried along until it breaks away, always at the same place, so that its state there is
//! the same each time: two break-aways in a row close a cycle, and nothing of a disturbance is left
//! after one. That takes a static coefficient above the kinetic one. With equal ones the block only
//! touches the belt's speed on the orbit that begins at its break-away, the outermost of those on
//! which it slides for good; such an orbit keeps every disturbance towards the inside, so that no
//! cycle is claimed. A block that slides on a belt for good has no dry friction to stop it; unless
//! its law damps it, so that it settles, it swings for ever as it started.

use super::block_cycle::BlockCourse;
use super::outcome::{Evidence, Outcome};
use super::settled::SettledWatch;
use super::simulate::{WINDOW, effort_limit, stiff_pace};
use crate::model::{Block, Simulation, Slider, SliderState, Start, System};
use crate::motion::{Failure, Motion, Settings};

/// Simulates a block until its ending is known.
pub(super) fn simulate_block(block: &Block, start: &Start, simulation: &Simulation) -> Outcome {
    let [position_m, velocity_m_s] = start.0[..] else {
        let error = "the start state of a block is its position and its velocity";
        return Outcome::failed(Evidence::InvalidParameters, error.to_owned());
    };
    let natural = block.natural_frequency_rad_s();
    let length = block.unit_length_m();
    let slider = block.slider();
    let state = SliderState {
        position: [],
        velocity: [],
        beta: [position_m / length],
        beta_dot: [velocity_m_s / (length * natural) - slider.belt_speed],
    };
    let end = simulation.end_time_s * natural;
    let pace = 1.0 + stiff_pace(slider.friction.damping_rate(1.0));
    let settings = Settings::new(simulation, effort_limit(end, pace, 1.0 / slider.longest_step()));
    match Motion::new(&slider, settings, state) {
        Ok(motion) => {
            let settled = SettledWatch::default();
            let course = BlockCourse::default();
            let (extremes, last_break_away) = (None, None);
            Run { slider: &slider, motion, extremes, last_break_away, course, settled, end }
                .finish(natural, length)
        }
        Err(failure) => Outcome::failed(Evidence::Failure(failure), failure.to_string()),
    }
}

struct Run<'a> {
    slider: &'a Slider,
    motion: Motion<'a, Slider, 1, 0>,
    /// The least and the greatest position since the last break-away, or in the last part of the
    /// time.
    extremes: Option<[f64; 2]>,
    last_break_away: Option<BreakAway>,
    /// What it has done since the last break-away.
    course: BlockCourse,
    settled: SettledWatch,
    end: f64,
}

/// The instant at which the block breaks away from the belt.
#[derive(Clone, Copy, Debug)]
struct BreakAway {
    time: f64,
    position: f64,
}

/// How the loop came to its end.
enum Ending {
    Rest,
    Settled,
    Cycle { period: f64 },
    EndTime,
    Failure(Failure),
}

impl Run<'_> {
    fn until_it_ends(&mut self) -> Ending {
        let window = (1.0 - WINDOW) * self.end;
        while self.motion.time() < self.end {
            let stuck = self.motion.all_stick();
            if stuck && self.slider.belt_speed == 0.0 {
                return Ending::Rest;
            }
            let before = self.motion.time();
            let [phase] = *self.motion.phases();
            // The last part of the time begins with a step, or it would miss what the step passes.
            let until = if before < window { window } else { self.end };
            if let Err(failure) = self.motion.advance(until) {
                return Ending::Failure(failure);
            }
            if before < window && self.motion.time() >= window && self.last_break_away.is_none() {
                self.extremes = Some([self.motion.state().beta[0]; 2]);
            } else {
                self.extend(stuck);
            }
            if self.last_break_away.is_some() {
                self.course.extend(self.slider, &mut self.motion, phase);
            }
            if self.settled.look(self.slider, &self.motion, self.end) {
                return Ending::Settled;
            }
            if stuck
                && !self.motion.all_stick()
                && let Some(period) = self.break_away()
            {
                return Ending::Cycle { period };
            }
        }
        Ending::EndTime
    }

    /// Takes a break-away in; the period where it closes a cycle.
    fn break_away(&mut self) -> Option<f64> {
        if self.slider.friction.limit <= self.slider.friction.coefficient {
            return None;
        }
        let now = BreakAway { time: self.motion.time(), position: self.motion.state().beta[0] };
        if let Some(last) = self.last_break_away
            && (now.position - last.position).abs() <= 1e-6 * now.position.abs().max(1.0)
        {
            return Some(now.time - last.time);
        }
        self.last_break_away = Some(now);
        self.course = BlockCourse::default();
        self.extremes = Some([now.position; 2]);
        None
    }

    /// Extends the extremes by the latest step: its end, and where the block turns back in it, which
    /// it cannot while it sticks.
    fn extend(&mut self, stuck: bool) {
        let belt = self.slider.belt_speed;
        let turns = [1.0, -1.0].map(|direction| {
            let velocity = |state: &SliderState| direction * (belt + state.beta_dot[0]);
            let turn = if stuck { None } else { self.motion.falls_through_zero(velocity) };
            turn.map(|(_, state)| state.beta[0])
        });
        let end = self.motion.state().beta[0];
        let [low, high] = self.extremes.get_or_insert([end; 2]);
        for position in turns.into_iter().flatten().chain([end]) {
            *low = low.min(position);
            *high = high.max(position);
        }
    }

    fn finish(mut self, natural: f64, length: f64) -> Outcome {
        let ending = self.until_it_ends();
        let motion = &self.motion;
        let position = motion.state().beta[0];
        let base = Outcome {
            evidence: Evidence::EndTime,
            balls_running: None,
            time_to_rest_s: None,
            end_time_s: Some(motion.time() / natural),
            position: Some(vec![position * length]),
            amplitude_m: self.extremes.map(|[low, high]| 0.5 * (high - low) * length),
            friction_margin: None,
            period_s: None,
            mean_speed: None,
            cycle: None,
            lyapunov: None,
            effort: motion.effort(),
            error: None,
        };
        match ending {
            Ending::Rest => Outcome {
                evidence: Evidence::RestCertified,
                time_to_rest_s: Some(motion.last_switches()[0] / natural),
                amplitude_m: Some(0.0),
                // On the very edge of the interval the slack of the conditions is all that is missing.
                friction_margin: Some(1.0 - position.abs() / self.slider.friction.limit)
                    .filter(|margin| margin.is_finite())
                    .map(|margin| margin.max(0.0)),
                ..base
            },
            Ending::Settled => Outcome {
                evidence: Evidence::Settled,
                time_to_rest_s: self.settled.slow_since().map(|since| since / natural),
                amplitude_m: Some(0.0),
                ..base
            },
            Ending::Cycle { period } => Outcome {
                evidence: Evidence::ClosedOrbit,
                period_s: Some(period / natural),
                cycle: base
                    .amplitude_m
                    .map(|amplitude| Box::new(self.course.cycle(length * natural, amplitude))),
                ..base
            },
            Ending::EndTime => base,
            Ending::Failure(failure) => Outcome {
                evidence: Evidence::Failure(failure),
                error: Some(failure.to_string()),
                ..base
            },
        }
    }
}
