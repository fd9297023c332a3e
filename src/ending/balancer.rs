//! One run of the balancer: simulated until its ending is known.

use super::certificate::{certified, certified_by_closed_form};
use super::closed_orbit::Orbit;
use super::creep::creeps;
use super::cycle::{Cycle, Doing};
use super::orbit::OrbitWatch;
use super::outcome::{Evidence, Outcome};
use super::settled::SettledWatch;
use super::simulate::{WINDOW, effort_limit, stiff_pace};
use crate::model::{Balancer, Machine, RestPoint, Simulation, Start, System};
use crate::motion::{Failure, Motion, Settings};

/// Simulates a balancer with `N` balls until its ending is known.
pub(super) fn simulate_balancer<const N: usize>(
    machine: &Machine,
    start: &Start,
    simulation: &Simulation,
) -> Outcome {
    let (Some(balancer), Some(state)) = (Balancer::<N>::new(machine), start.of_balls()) else {
        let error = "the start state has another number of balls than the machine";
        return Outcome::failed(Evidence::InvalidParameters, error.to_owned());
    };
    let natural = machine.natural_frequency_rad_s();
    let end = simulation.end_time_s * natural;
    let weight = balancer.speed * balancer.speed;
    let rates = balancer.balls.iter().map(|ball| ball.friction.damping_rate(weight));
    let stiff = stiff_pace(rates.fold(0.0, f64::max));
    let pace = 1.0 + balancer.speed.abs() + balancer.damping_ratio + stiff;
    // An explicit method takes some tenth of the rate at which the table is damped.
    let least = 1.0 / balancer.longest_step() + 0.2 * balancer.damping_ratio;
    let settings = Settings::new(simulation, effort_limit(end, pace, least));
    let units = Units { natural, radius: machine.ring_radius_m };
    match Motion::new(&balancer, settings, state) {
        Ok(motion) => Run::new(&balancer, settings, motion, end).finish(units),
        Err(failure) => Outcome::failed(Evidence::Failure(failure), failure.to_string()),
    }
}

/// The latest of some times.
fn latest(times: &[f64]) -> f64 {
    times.iter().copied().fold(0.0, f64::max)
}

/// What turns non-dimensional values into SI units.
#[derive(Clone, Copy)]
struct Units {
    natural: f64,
    radius: f64,
}

/// Means over the last part of a run.
struct Window<const N: usize> {
    start: f64,
    angles: Option<[f64; N]>,
    opened: f64,
    square_time: f64,
}

struct Run<'a, const N: usize> {
    balancer: &'a Balancer<N>,
    settings: Settings,
    motion: Motion<'a, Balancer<N>, N>,
    end: f64,
    watch: OrbitWatch<N>,
    settled: SettledWatch,
    window: Window<N>,
    rest: Option<RestPoint<N>>,
}

/// How the loop came to its end.
enum Ending<const N: usize> {
    Rest(RestPoint<N>),
    Settled,
    Cycle(Orbit<N>),
    EndTime,
    Failure(Failure),
}

impl<'a, const N: usize> Run<'a, N> {
    fn new(
        balancer: &'a Balancer<N>,
        settings: Settings,
        motion: Motion<'a, Balancer<N>, N>,
        end: f64,
    ) -> Self {
        Run {
            balancer,
            settings,
            motion,
            end,
            watch: OrbitWatch::new(&settings),
            settled: SettledWatch::default(),
            window: Window {
                start: (1.0 - WINDOW) * end,
                angles: None,
                opened: 0.0,
                square_time: 0.0,
            },
            rest: None,
        }
    }

    fn finish(mut self, units: Units) -> Outcome {
        let ending = self.until_it_ends();
        self.outcome(ending, units)
    }

    fn until_it_ends(&mut self) -> Ending<N> {
        while self.motion.time() < self.end {
            if let Some(rest) = self.rest_point()
                && certified(self.balancer, &rest, self.motion.state())
            {
                return Ending::Rest(rest);
            }
            let (before, square) = (self.motion.time(), self.square());
            let switched = match self.motion.advance(self.end) {
                Ok(switched) => switched,
                Err(failure) => return Ending::Failure(failure),
            };
            if switched {
                self.rest = None;
            }
            self.extend_window(before, square);
            if self.settled.look(self.balancer, &self.motion, self.end) {
                return Ending::Settled;
            }
            let cycle = self.watch.look(self.balancer, &self.settings, &mut self.motion);
            if let Some(orbit) = cycle {
                return Ending::Cycle(orbit);
            }
        }
        match self.rest_point() {
            Some(rest) if certified_by_closed_form(self.balancer, &rest, self.motion.state()) => {
                Ending::Rest(rest)
            }
            _ => Ending::EndTime,
        }
    }

    /// The rest point while all balls stick; it stays the same until one breaks loose.
    fn rest_point(&mut self) -> Option<RestPoint<N>> {
        if !self.motion.all_stick() {
            return None;
        }
        let state = self.motion.state();
        Some(*self.rest.get_or_insert_with(|| self.balancer.rest_point(&state.beta)))
    }

    fn square(&self) -> f64 {
        let [x, y] = self.motion.state().position;
        x * x + y * y
    }

    fn angles(&self) -> [f64; N] {
        std::array::from_fn(|ball| self.motion.unwrapped_angle(ball))
    }

    fn extend_window(&mut self, before: f64, square_before: f64) {
        if before < self.window.start {
            return;
        }
        if self.window.angles.is_none() {
            self.window.angles = Some(self.angles());
            self.window.opened = self.motion.time();
        } else {
            self.window.square_time +=
                0.5 * (self.motion.time() - before) * (square_before + self.square());
        }
    }

    fn outcome(self, ending: Ending<N>, units: Units) -> Outcome {
        let Units { natural, radius } = units;
        let state = self.motion.state();
        let in_circle = |angle: f64| {
            let wrapped = angle.rem_euclid(std::f64::consts::TAU);
            if wrapped < std::f64::consts::TAU { wrapped } else { 0.0 }
        };
        let base = Outcome {
            evidence: Evidence::EndTime,
            balls_running: None,
            time_to_rest_s: None,
            end_time_s: Some(self.motion.time() / natural),
            position: Some(state.beta.map(in_circle).to_vec()),
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
        // Without the certainty of stick, rest begins when the balls are slow.
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
                cycle: Some(Box::new(cycle(&orbit, units))),
                ..base
            },
            Ending::Settled => Outcome { friction_margin: None, ..slow(Evidence::Settled) },
            Ending::EndTime if creeps(self.balancer, &self.motion) => slow(Evidence::Creep),
            Ending::EndTime => {
                let span = self.motion.time() - self.window.opened;
                let turned = self.window.angles.map(|earlier| {
                    let now = self.angles();
                    std::array::from_fn::<f64, N, _>(|ball| now[ball] - earlier[ball])
                });
                let turned = turned.filter(|_| span > 0.0);
                let unstable = self.watch.unstable_orbit();
                Outcome {
                    evidence: if unstable.is_some() {
                        Evidence::UnstableOrbit
                    } else {
                        Evidence::EndTime
                    },
                    cycle: unstable.map(|orbit| Box::new(cycle(orbit, units))),
                    balls_running: turned.map(|turned| {
                        let runs = |angle: &&f64| angle.abs() >= std::f64::consts::TAU;
                        turned.iter().filter(runs).count() as u8
                    }),
                    amplitude_m: turned.map(|_| (self.window.square_time / span).sqrt() * radius),
                    mean_speed: turned
                        .map(|turned| turned.map(|angle| angle / span * natural).to_vec()),
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

fn cycle<const N: usize>(orbit: &Orbit<N>, Units { natural, radius }: Units) -> Cycle {
    let of_all = |doing: &[Doing; N]| doing.to_vec();
    Cycle {
        turns: orbit.turns.to_vec(),
        configurations: orbit.configurations.iter().map(of_all).collect(),
        speed_extremes: orbit.speed_extremes.map(|two| two.map(|speed| speed * natural)).to_vec(),
        peak_amplitude_m: orbit.peak * radius,
        multipliers: orbit.multipliers.clone(),
        neutral_directions: orbit.neutral_directions as u8,
    }
}
