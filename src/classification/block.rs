//! Simulation of one run of a block on a spring until its ending is known.
//!
//! On rigid ground a block that sticks stays at rest, because the spring force on it is constant.
//! On a belt the block is carried along until it breaks away, always at the same position, so that
//! its state there is the same each time: two successive break-aways close a cycle, and a
//! disturbance vanishes within one period. This requires a static coefficient above the kinetic
//! one.
//!
//! With equal coefficients, the block reaches the belt's speed only on the orbit that starts at its
//! break-away, the outermost of the orbits on which it slides permanently. This orbit preserves
//! every inward disturbance, so that no cycle is claimed. A block that slides permanently on a belt
//! is not stopped by dry friction; unless its law damps the motion, so that it settles, it
//! oscillates with constant amplitude.

use super::block_cycle::BlockCycleRecorder;
use super::cycle::Cycle;
use super::extremes::{Extremes, Passed};
use super::follow::{Horizons, Run, follow};
use super::outcome::{Evidence, Outcome};
use super::recorder::Recorder;
use super::settled::SettledWatch;
use super::step_limit::effort_limit;
use super::window::WINDOW;
use crate::model::{Block, Endings, Simulation, Slider, SliderState, Start};
use crate::motion::{Failure, Motion, Settings};

/// Simulates a block until its ending is known.
pub(super) fn simulate_block(
    block: &Block,
    start: &Start,
    simulation: &Simulation,
    recorder: Option<&mut Recorder>,
) -> Outcome {
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
    let horizons = Horizons::new(simulation, natural, |end| Extremes::from((1.0 - WINDOW) * end));
    let settings = Settings::new(simulation, effort_limit(&slider, horizons.latest_end()));
    match Motion::new(&slider, settings, state) {
        Ok(motion) => {
            let run = BlockRun {
                slider: &slider,
                natural,
                length,
                motion,
                horizons,
                looks_for_cycles: simulation.endings == Endings::All,
                last_break_away: None,
                settled: SettledWatch::default(),
            };
            follow(run, simulation.extend, recorder)
        }
        Err(failure) => Outcome::failed(Evidence::Failure(failure), failure.to_string()),
    }
}

#[derive(Clone)]
struct BlockRun<'a> {
    slider: &'a Slider,
    natural: f64,
    length: f64,
    motion: Motion<'a, Slider, 1, 0>,
    horizons: Horizons<Extremes>,
    looks_for_cycles: bool,
    last_break_away: Option<BreakAway>,
    settled: SettledWatch,
}

/// The instant at which the block breaks away from the belt.
#[derive(Clone, Debug)]
struct BreakAway {
    time: f64,
    position: f64,
    /// The extremes since then.
    extremes: Extremes,
    /// The phases since then.
    course: BlockCycleRecorder,
}

/// How the simulation ended.
enum Ending {
    Rest,
    Settled,
    Cycle { period: f64 },
    EndTime,
    Failure(Failure),
}

impl BlockRun<'_> {
    /// Records a break-away. Returns the period if it closes a cycle.
    fn break_away(&mut self) -> Option<f64> {
        if self.slider.friction.limit <= self.slider.friction.coefficient {
            return None;
        }
        let (time, position) = (self.motion.time(), self.motion.state().beta[0]);
        if let Some(last) = &self.last_break_away
            && (position - last.position).abs() <= 1e-6 * position.abs().max(1.0)
        {
            return Some(time - last.time);
        }
        let extremes = Extremes::from_place(time, position);
        let course = BlockCycleRecorder::default();
        self.last_break_away = Some(BreakAway { time, position, extremes, course });
        None
    }

    /// Returns half of the distance between the extremes since the last break-away, or in the last
    /// part of the time if there was none.
    fn amplitude_m(&self) -> Option<f64> {
        let last = self.last_break_away.as_ref().map(|last| &last.extremes);
        let extremes = last.unwrap_or(self.horizons.window());
        extremes.amplitude().map(|amplitude| amplitude * self.length)
    }

    /// Returns the cycle since the last break-away.
    fn cycle(&self) -> Option<Cycle> {
        let course = &self.last_break_away.as_ref()?.course;
        Some(course.cycle(self.length * self.natural, self.amplitude_m()?))
    }
}

impl Run for BlockRun<'_> {
    type Ending = Ending;

    fn reaches_end(&self) -> bool {
        self.motion.reaches(self.horizons.end())
    }

    fn advance(&mut self) -> Option<Ending> {
        let (end, before) = (self.horizons.end(), self.motion.time());
        if before >= end {
            return Some(Ending::EndTime);
        }
        let stuck = self.motion.all_stick();
        let [phase] = *self.motion.phases();
        if stuck && self.slider.belt_speed == 0.0 {
            return Some(Ending::Rest);
        }
        if let Err(failure) = self.motion.advance(end) {
            return Some(Ending::Failure(failure));
        }
        let passed = Passed::of(self.slider, &mut self.motion, before, stuck);
        if let Some(last) = &mut self.last_break_away {
            last.course.extend(self.slider, &mut self.motion, phase);
        }
        let since = self.last_break_away.iter_mut().map(|last| &mut last.extremes);
        for extremes in since.chain(self.horizons.windows()) {
            extremes.take_in(&passed, &mut self.motion);
        }
        if self.settled.look(self.slider, &self.motion, end) {
            return Some(Ending::Settled);
        }
        let breaks_away = stuck && !self.motion.all_stick();
        let period = if breaks_away && self.looks_for_cycles { self.break_away() } else { None };
        period.map(|period| Ending::Cycle { period })
    }

    fn extend(&mut self) {
        self.horizons.extend();
    }

    fn show(&mut self, recorder: &mut Recorder) {
        recorder.take_in(self.slider, &mut self.motion);
    }

    fn goes_on(&self, recorder: &mut Recorder) {
        recorder.rewind(self.motion.time(), self.motion.effort());
    }

    fn outcome(&self, ending: Ending) -> Outcome {
        let Self { natural, length, .. } = *self;
        let motion = &self.motion;
        let position = motion.state().beta[0];
        let base = Outcome {
            evidence: Evidence::EndTime,
            balls_running: None,
            time_to_rest_s: None,
            end_time_s: Some(motion.time() / natural),
            extended: false,
            position: Some(vec![position * length]),
            amplitude_m: None,
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
                // On the very edge of the interval only the slack of the conditions is missing.
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
                amplitude_m: self.amplitude_m(),
                cycle: self.cycle().map(Box::new),
                ..base
            },
            Ending::EndTime => Outcome { amplitude_m: self.amplitude_m(), ..base },
            Ending::Failure(failure) => Outcome {
                evidence: Evidence::Failure(failure),
                error: Some(failure.to_string()),
                ..base
            },
        }
    }
}
