//! Simulation of one balancer run until its ending is known.

use super::certificate::{certified, certified_by_closed_form};
use super::closed_orbit::Orbit;
use super::creep::creeps;
use super::cycle::{Cycle, CyclePhase};
use super::follow::{Horizons, Run, follow};
use super::lyapunov::{SEPARATION_WINDOW, Separation};
use super::orbit::OrbitWatch;
use super::outcome::{Evidence, LyapunovExponent, Outcome};
use super::recorder::Recorder;
use super::settled::SettledWatch;
use super::step_limit::effort_limit;
use super::window::{LatestStep, WINDOW, Window};
use crate::model::{
    Balancer, Endings, Machine, RestPoint, Simulation, Start, State, wrap_to_two_pi,
};
use crate::motion::{Failure, Motion, Settings};

/// The initial state of a run.
pub(super) struct Prepared<const N: usize> {
    pub(super) balancer: Balancer<N>,
    pub(super) state: State<N>,
    pub(super) settings: Settings,
    pub(super) units: Units,
    pub(super) horizons: Horizons<Late<N>>,
    pub(super) watch: Option<OrbitWatch<N>>,
}

impl<const N: usize> Prepared<N> {
    /// Returns the initial state of a run of a machine; `None` if machine and start state differ in
    /// their number of balls.
    pub(super) fn new(machine: &Machine, start: &Start, simulation: &Simulation) -> Option<Self> {
        let (balancer, state) = (Balancer::<N>::new(machine)?, start.of_balls()?);
        let natural = machine.natural_frequency_rad_s();
        let late = |end: f64| Late::until(end, simulation.endings);
        let horizons = Horizons::new(simulation, natural, late);
        let settings = Settings::new(simulation, effort_limit(&balancer, horizons.latest_end()));
        let units = Units { natural, radius: machine.ring_radius_m };
        let watch = (simulation.endings == Endings::All).then(|| OrbitWatch::new(&settings));
        Some(Prepared { balancer, state, settings, units, horizons, watch })
    }
}

/// Returns the outcome of a case whose start state does not fit its machine.
pub(super) fn other_number_of_balls() -> Outcome {
    let error = "the start state has another number of balls than the machine";
    Outcome::failed(Evidence::InvalidParameters, error.to_owned())
}

/// Simulates a balancer with `N` balls until its ending is known.
pub(super) fn simulate_balancer<const N: usize>(
    machine: &Machine,
    start: &Start,
    simulation: &Simulation,
    recorder: Option<&mut Recorder>,
) -> Outcome {
    let Some(prepared) = Prepared::<N>::new(machine, start, simulation) else {
        return other_number_of_balls();
    };
    let Prepared { balancer, state, settings, units, horizons, watch } = prepared;
    match Motion::new(&balancer, settings, state) {
        Ok(motion) => {
            let run = BalancerRun {
                balancer: &balancer,
                settings,
                units,
                motion,
                horizons,
                watch,
                settled: SettledWatch::default(),
                rest: None,
            };
            follow(run, simulation.extend, recorder)
        }
        Err(failure) => Outcome::failed(Evidence::Failure(failure), failure.to_string()),
    }
}

/// Returns the latest of some times.
fn latest(times: &[f64]) -> f64 {
    times.iter().copied().fold(0.0, f64::max)
}

/// Conversion factors from non-dimensional values to SI units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Units {
    natural: f64,
    radius: f64,
}

/// A run in progress.
#[derive(Clone)]
pub(super) struct BalancerRun<'a, const N: usize> {
    pub(super) balancer: &'a Balancer<N>,
    pub(super) settings: Settings,
    pub(super) units: Units,
    pub(super) motion: Motion<'a, Balancer<N>, N>,
    pub(super) horizons: Horizons<Late<N>>,
    /// `None` if limit cycles are not sought.
    pub(super) watch: Option<OrbitWatch<N>>,
    pub(super) settled: SettledWatch,
    pub(super) rest: Option<RestPoint<N>>,
}

/// Statistics over the last part of the time.
#[derive(Clone, Debug)]
pub(super) struct Late<const N: usize> {
    pub(super) means: Window<N>,
    pub(super) separation: Separation<N, 2>,
}

impl<const N: usize> Late<N> {
    /// Creates the statistics for a run that ends at a time.
    fn until(end: f64, endings: Endings) -> Self {
        let separation = match endings {
            Endings::All => (1.0 - SEPARATION_WINDOW) * end,
            Endings::Rest => f64::INFINITY,
        };
        Late {
            means: Window::new((1.0 - WINDOW) * end),
            separation: Separation::new(separation, end),
        }
    }

    fn take_in(&mut self, began: f64, motion: &mut Motion<Balancer<N>, N>) {
        self.separation.follow(motion);
        self.means.take_in(LatestStep { motion, began });
    }
}

/// How the simulation ended.
pub(super) enum Ending<const N: usize> {
    Rest(RestPoint<N>),
    Settled,
    Cycle(Orbit<N>),
    EndTime,
    Failure(Failure),
}

impl<const N: usize> BalancerRun<'_, N> {
    /// Returns the rest point while all balls stick; it is constant until one breaks loose.
    fn rest_point(&mut self) -> Option<RestPoint<N>> {
        if !self.motion.all_stick() {
            return None;
        }
        let state = self.motion.state();
        Some(*self.rest.get_or_insert_with(|| self.balancer.rest_point(&state.beta)))
    }

    /// Returns the ending of a run that has reached its end time without another ending.
    pub(super) fn at_end_time(&mut self) -> Ending<N> {
        match self.rest_point() {
            Some(rest) if certified_by_closed_form(self.balancer, &rest, self.motion.state()) => {
                Ending::Rest(rest)
            }
            _ => Ending::EndTime,
        }
    }
}

impl<const N: usize> Run for BalancerRun<'_, N> {
    type Ending = Ending<N>;

    fn reaches_end(&self) -> bool {
        self.motion.reaches(self.horizons.end())
    }

    fn advance(&mut self) -> Option<Ending<N>> {
        let end = self.horizons.end();
        if self.motion.time() >= end {
            return Some(self.at_end_time());
        }
        if let Some(rest) = self.rest_point()
            && certified(self.balancer, &rest, self.motion.state())
        {
            return Some(Ending::Rest(rest));
        }
        let began = self.motion.time();
        match self.motion.advance(end) {
            Ok(true) => self.rest = None,
            Ok(false) => {}
            Err(failure) => return Some(Ending::Failure(failure)),
        }
        self.horizons.windows().for_each(|late| late.take_in(began, &mut self.motion));
        if self.settled.look(self.balancer, &self.motion, end) {
            return Some(Ending::Settled);
        }
        let watch = self.watch.as_mut()?;
        let cycle = watch.look(self.balancer, &self.settings, &mut self.motion);
        cycle.map(Ending::Cycle)
    }

    fn extend(&mut self) {
        self.horizons.extend();
    }

    fn show(&mut self, recorder: &mut Recorder) {
        recorder.take_in(self.balancer, &mut self.motion);
    }

    fn goes_on(&self, recorder: &mut Recorder) {
        recorder.rewind(self.motion.time(), self.motion.effort());
    }

    fn outcome(&self, ending: Ending<N>) -> Outcome {
        let Units { natural, radius } = self.units;
        let state = self.motion.state();
        let base = Outcome {
            evidence: Evidence::EndTime,
            balls_running: None,
            time_to_rest_s: None,
            end_time_s: Some(self.motion.time() / natural),
            extended: false,
            position: Some(state.beta.map(wrap_to_two_pi).to_vec()),
            amplitude_m: None,
            friction_margin: None,
            period_s: None,
            mean_speed: None,
            cycle: None,
            lyapunov: None,
            effort: self.motion.effort(),
            error: None,
        };
        let at_rest = |evidence: Evidence, rest: RestPoint<N>| Outcome {
            evidence,
            balls_running: Some(0),
            time_to_rest_s: Some(latest(self.motion.last_switches()) / natural),
            amplitude_m: Some(rest.position[0].hypot(rest.position[1]) * radius),
            friction_margin: Some(1.0 - self.balancer.friction_use(&rest, 0.0))
                .filter(|margin| margin.is_finite()),
            mean_speed: Some(vec![0.0; N]),
            ..base.clone()
        };
        // Without a rest certificate, rest begins when the balls are slow.
        let slow = |evidence: Evidence| Outcome {
            time_to_rest_s: Some(latest(self.motion.slow_since()) / natural),
            ..at_rest(evidence, self.balancer.rest_point(&state.beta))
        };
        match ending {
            Ending::Rest(rest) => at_rest(Evidence::RestCertified, rest),
            Ending::Cycle(orbit) => Outcome {
                evidence: Evidence::ClosedOrbit,
                balls_running: Some(orbit.turns.iter().filter(|&&turns| turns != 0).count() as u8),
                amplitude_m: Some(orbit.amplitude * radius),
                friction_margin: orbit.margin,
                period_s: Some(orbit.period / natural),
                mean_speed: Some(orbit.speed.map(|speed| speed * natural).to_vec()),
                cycle: Some(Box::new(cycle(&orbit, self.units))),
                ..base
            },
            Ending::Settled => Outcome { friction_margin: None, ..slow(Evidence::Settled) },
            Ending::EndTime if creeps(self.balancer, &self.motion) => {
                // On the edge of the set, approached from outside.
                let slow = slow(Evidence::Creep);
                let friction_margin = slow.friction_margin.map(|margin| margin.max(0.0));
                Outcome { friction_margin, ..slow }
            }
            Ending::EndTime => {
                let Late { means, separation } = self.horizons.window();
                let means = means.means(&self.motion);
                let means = means.as_ref();
                let unstable = self.watch.as_ref().and_then(OrbitWatch::unstable_orbit);
                Outcome {
                    evidence: if unstable.is_some() {
                        Evidence::UnstableOrbit
                    } else if separation.is_irregular() {
                        Evidence::Lyapunov
                    } else {
                        Evidence::EndTime
                    },
                    lyapunov: separation.exponent().map(|exponent| in_seconds(exponent, natural)),
                    cycle: unstable.map(|orbit| Box::new(cycle(orbit, self.units))),
                    balls_running: means.map(|means| {
                        let runs = |angle: &&f64| angle.abs() >= std::f64::consts::TAU;
                        means.turned.iter().filter(runs).count() as u8
                    }),
                    amplitude_m: means.map(|means| means.amplitude * radius),
                    mean_speed: means.map(|means| means.speed.map(|s| s * natural).to_vec()),
                    ..base
                }
            }
            Ending::Failure(failure) => Outcome {
                evidence: Evidence::Failure(failure),
                error: Some(failure.to_string()),
                ..base
            },
        }
    }
}

/// An exponent per unit of non-dimensional time as one per second.
fn in_seconds(exponent: LyapunovExponent, natural: f64) -> LyapunovExponent {
    LyapunovExponent {
        exponent_1_s: exponent.exponent_1_s * natural,
        interval_1_s: exponent.interval_1_s.map(|rate| rate * natural),
        window_s: exponent.window_s / natural,
    }
}

fn cycle<const N: usize>(orbit: &Orbit<N>, Units { natural, radius }: Units) -> Cycle {
    let angles = orbit.turns.iter().zip(orbit.angle_extremes);
    let angles = angles.map(|(&turns, extremes)| (turns == 0).then_some(extremes));
    let of_all = |cycle_phase: &[CyclePhase; N]| cycle_phase.to_vec();
    Cycle {
        turns: orbit.turns.to_vec(),
        configurations: orbit.configurations.iter().map(of_all).collect(),
        speed_extremes: orbit.speed_extremes.map(|two| two.map(|speed| speed * natural)).to_vec(),
        angle_extremes: angles.collect(),
        peak_amplitude_m: orbit.peak * radius,
        multipliers: orbit.multipliers.clone(),
        neutral_directions: orbit.neutral_directions as u8,
    }
}
