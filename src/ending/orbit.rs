//! Closed orbits: evidence that a run has settled on a limit cycle.
//!
//! A running ball goes round the ring, so that an orbit closes only modulo 2π. The section is its
//! passage through the angle 0; the return map takes the state at one passage to that some turns
//! later. An orbit is a limit cycle on three counts:
//!
//! 1. it closes: the state comes back to itself within a small multiple of the tolerances;
//! 2. it is stable: all multipliers of the return map, by central differences, lie inside the unit
//!    circle, and the fixed point that they point to is as near as the closure says;
//! 3. balls that rest keep a margin all along it. Where such a ball rests does not change from one
//!    return to the next: those neutral directions (the cycles form a continuous family) are left
//!    out of the map instead of being mistaken for instability.
//!
//! Only cycles in which each ball either runs or rests all along are recognised so far; a cycle in
//! which a ball sticks and slips stays undecided.

use nalgebra::{DMatrix, DVector};

use crate::model::{Balancer, State};
use crate::motion::{Phase, Settings, SwitchModel, Tolerance};

/// The most turns of the running ball after which an orbit may close.
const MOST_TURNS: usize = 8;
/// Returns in a row that must be close.
const CLOSE_RETURNS: usize = 3;
/// How often per run the multipliers are computed at most.
const MOST_ATTEMPTS: u32 = 4;
/// Step of the central differences, non-dimensional.
const DIFFERENCE: f64 = 1e-4;
/// Multipliers must stay this far inside the unit circle to count as stable, and go this far
/// outside to count as unstable: the accuracy of the differences.
const MULTIPLIER_DOUBT: f64 = 1e-3;

/// A closed orbit.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit<const N: usize> {
    /// Period, non-dimensional.
    pub period: f64,
    /// Which balls run.
    pub running: [bool; N],
    /// Mean speed of each ball relative to the ring, non-dimensional.
    pub speed: [f64; N],
    /// Root mean square over the period of the table's displacement, over `L`.
    pub amplitude: f64,
    /// The least part of the friction limit that is left to a resting ball; none where none rests.
    pub margin: Option<f64>,
    /// Largest modulus of the multipliers off the neutral directions.
    pub largest_multiplier: f64,
}

/// What a look at a closing orbit has shown.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict<const N: usize> {
    /// A limit cycle.
    Stable(Orbit<N>),
    /// A closed orbit that a disturbance grows away from.
    Unstable,
    /// Neither could be shown.
    Open,
}

/// A passage of the running ball through the section.
#[derive(Clone, Debug)]
struct Passage<const N: usize> {
    time: f64,
    state: State<N>,
    phases: [Phase; N],
}

/// Watches a motion for a closing orbit.
#[derive(Clone, Debug)]
pub struct OrbitWatch<const N: usize> {
    closure: f64,
    ball: Option<usize>,
    passages: Vec<Passage<N>>,
    close_in_a_row: [usize; MOST_TURNS + 1],
    attempts: u32,
    wait_until: f64,
}

impl<const N: usize> OrbitWatch<N> {
    /// A watch for motions computed with `settings`.
    pub fn new(settings: &Settings) -> Self {
        let Tolerance { relative, absolute } = settings.tolerance;
        OrbitWatch {
            closure: 100.0 * (relative + absolute),
            ball: None,
            passages: Vec::with_capacity(MOST_TURNS + 2),
            close_in_a_row: [0; MOST_TURNS + 1],
            attempts: 0,
            wait_until: 0.0,
        }
    }

    /// Looks at the motion's latest step. Most steps show nothing.
    pub fn look(
        &mut self,
        balancer: &Balancer<N>,
        settings: &Settings,
        motion: &mut SwitchModel<N>,
        switched: bool,
    ) -> Option<Verdict<N>> {
        if switched {
            self.restart(None);
        }
        let gone_round = |angle: f64| !(0.0..std::f64::consts::TAU).contains(&angle);
        let beta = motion.state().beta;
        let reference = match self.ball {
            Some(ball) if gone_round(beta[ball]) => ball,
            Some(_) => return None,
            None => (0..N).find(|&ball| gone_round(beta[ball]))?,
        };
        let Some((time, state)) = motion.passage(reference) else {
            self.restart(None);
            return None;
        };
        self.ball = Some(reference);
        let passage = Passage { time, state, phases: *motion.phases() };
        let candidate = self.record(reference, passage);
        let turns = candidate?;
        if self.attempts >= MOST_ATTEMPTS || time < self.wait_until {
            return None;
        }
        self.attempts += 1;
        // After a look that showed nothing, give the motion ten times as long to settle.
        self.wait_until = time + 10.0 * (time - self.passages.first()?.time);
        Some(self.examine(balancer, settings, reference, turns))
    }

    fn restart(&mut self, ball: Option<usize>) {
        self.ball = ball;
        self.passages.clear();
        self.close_in_a_row = [0; MOST_TURNS + 1];
    }

    /// Takes a passage in and returns the least number of turns after which the orbit closes.
    fn record(&mut self, reference: usize, passage: Passage<N>) -> Option<usize> {
        let mut closed = None;
        for turns in 1..=MOST_TURNS.min(self.passages.len()) {
            let earlier = &self.passages[self.passages.len() - turns];
            let close = earlier.phases == passage.phases
                && difference(&earlier.state, &passage.state, reference) <= self.closure;
            self.close_in_a_row[turns] = if close { self.close_in_a_row[turns] + 1 } else { 0 };
            if self.close_in_a_row[turns] >= CLOSE_RETURNS && closed.is_none() {
                closed = Some(turns);
            }
        }
        if self.passages.len() > MOST_TURNS {
            self.passages.remove(0);
        }
        self.passages.push(passage);
        closed
    }

    /// Multipliers, distance to the fixed point and margins of an orbit that closes.
    fn examine(
        &self,
        balancer: &Balancer<N>,
        settings: &Settings,
        reference: usize,
        turns: usize,
    ) -> Verdict<N> {
        let Some(passage) = self.passages.last() else { return Verdict::Open };
        let map = ReturnMap {
            balancer,
            settings: Settings {
                tolerance: Tolerance {
                    relative: settings.tolerance.relative.min(1e-10),
                    absolute: settings.tolerance.absolute.min(1e-12),
                },
                effort_limit: 1_000_000,
                ..*settings
            },
            reference,
            turns,
            phases: passage.phases,
            longest: 2.0 * (passage.time - self.passages[self.passages.len() - 1 - turns].time),
        };
        map.verdict(&passage.state, self.closure).unwrap_or(Verdict::Open)
    }
}

/// The larger of the differences of two states on the section, angles modulo 2π.
fn difference<const N: usize>(a: &State<N>, b: &State<N>, reference: usize) -> f64 {
    let mut largest: f64 = 0.0;
    for axis in 0..2 {
        largest = largest.max((a.position[axis] - b.position[axis]).abs());
        largest = largest.max((a.velocity[axis] - b.velocity[axis]).abs());
    }
    for ball in 0..N {
        largest = largest.max((a.beta_dot[ball] - b.beta_dot[ball]).abs());
        if ball != reference {
            largest = largest.max(wrapped(a.beta[ball] - b.beta[ball]).abs());
        }
    }
    largest
}

/// An angle in [-π, π].
fn wrapped(angle: f64) -> f64 {
    angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round()
}

/// The map from one passage of the section to a later one.
struct ReturnMap<'a, const N: usize> {
    balancer: &'a Balancer<N>,
    settings: Settings,
    reference: usize,
    turns: usize,
    phases: [Phase; N],
    /// Give up after this time.
    longest: f64,
}

/// Where the map leads and what is met on the way.
struct Return<const N: usize> {
    state: State<N>,
    time: f64,
    margin: Option<f64>,
    mean_square: f64,
}

impl<const N: usize> ReturnMap<'_, N> {
    fn verdict(&self, state: &State<N>, closure: f64) -> Option<Verdict<N>> {
        let orbit = self.follow(state)?;
        if orbit.margin.is_some_and(|margin| margin <= 0.0) {
            return Some(Verdict::Open);
        }
        let centre = self.coordinates(state);
        let image = self.coordinates(&orbit.state);
        let dimension = centre.len();
        let mut jacobian = DMatrix::<f64>::zeros(dimension, dimension);
        for column in 0..dimension {
            let shifted = |step: f64| {
                let mut point = centre.clone();
                point[column] += step;
                self.follow(&self.state(state, &point)).map(|end| self.coordinates(&end.state))
            };
            let forward = shifted(DIFFERENCE)?;
            let backward = shifted(-DIFFERENCE)?;
            let change = (forward - backward).map(wrapped_small) / (2.0 * DIFFERENCE);
            jacobian.set_column(column, &change);
        }
        let multipliers = jacobian.clone().complex_eigenvalues();
        let largest = multipliers.iter().map(|m| m.norm()).fold(0.0, f64::max);
        if !largest.is_finite() {
            return Some(Verdict::Open);
        }
        if largest > 1.0 + MULTIPLIER_DOUBT {
            return Some(Verdict::Unstable);
        }
        // How far away the fixed point is, to first order: (1 - J) δ = P(s) - s.
        let residual = (image - centre).map(wrapped_small);
        let to_fixed_point =
            (DMatrix::identity(dimension, dimension) - jacobian).lu().solve(&residual)?;
        if largest >= 1.0 - MULTIPLIER_DOUBT || to_fixed_point.amax() > 100.0 * closure {
            return Some(Verdict::Open);
        }
        let running = self.phases.map(|phase| phase != Phase::Stick);
        let speed = std::array::from_fn(|ball| {
            let turned = if ball == self.reference {
                self.direction() * self.turns as f64 * std::f64::consts::TAU
            } else {
                orbit.state.beta[ball] - state.beta[ball]
            };
            turned / orbit.time
        });
        Some(Verdict::Stable(Orbit {
            period: orbit.time,
            running,
            speed,
            amplitude: orbit.mean_square.sqrt(),
            margin: orbit.margin,
            largest_multiplier: largest,
        }))
    }

    fn direction(&self) -> f64 {
        match self.phases[self.reference] {
            Phase::Slip(direction) | Phase::Transition(direction) => direction,
            Phase::Stick => 0.0,
        }
    }

    /// The coordinates that the map acts on: the table's, and those of running balls but the angle
    /// of the one that marks the section.
    fn coordinates(&self, state: &State<N>) -> DVector<f64> {
        let mut values = [state.position, state.velocity].concat();
        for ball in 0..N {
            if self.phases[ball] != Phase::Stick {
                values.push(state.beta_dot[ball]);
                if ball != self.reference {
                    values.push(state.beta[ball]);
                }
            }
        }
        DVector::from_vec(values)
    }

    /// The state with these coordinates; balls at rest stay where `like` has them.
    fn state(&self, like: &State<N>, coordinates: &DVector<f64>) -> State<N> {
        let mut state = *like;
        let mut values = coordinates.iter().copied();
        let mut next = || values.next().unwrap_or(0.0);
        state.position = [next(), next()];
        state.velocity = [next(), next()];
        for ball in 0..N {
            if self.phases[ball] != Phase::Stick {
                state.beta_dot[ball] = next();
                if ball != self.reference {
                    state.beta[ball] = next();
                }
            }
        }
        state
    }

    /// One return; `None` where a ball changes its phase on the way or the ball does not come back.
    fn follow(&self, start: &State<N>) -> Option<Return<N>> {
        let mut start = *start;
        start.beta[self.reference] = 0.0;
        let mut motion = SwitchModel::new(self.balancer, self.settings, start).ok()?;
        let (mut margin, mut square_time) = (f64::INFINITY, 0.0);
        let square = |state: &State<N>| state.position.iter().map(|p| p * p).sum::<f64>();
        let mut passed = 0;
        while motion.time() < self.longest {
            if motion.phases() != &self.phases {
                return None;
            }
            let (before, square_before) = (motion.time(), square(motion.state()));
            motion.advance(self.longest).ok()?;
            margin = margin.min(self.least_margin(&motion));
            if let Some((time, mut state)) = motion.passage(self.reference) {
                passed += 1;
                if passed == self.turns {
                    square_time += 0.5 * (time - before) * (square_before + square(&state));
                    for ball in 0..N {
                        let turns = motion.unwrapped_angle(ball) - motion.state().beta[ball];
                        state.beta[ball] += turns;
                    }
                    let margin = margin.is_finite().then_some(margin);
                    return Some(Return { state, time, margin, mean_square: square_time / time });
                }
            }
            square_time +=
                0.5 * (motion.time() - before) * (square_before + square(motion.state()));
        }
        None
    }

    fn least_margin(&self, motion: &SwitchModel<N>) -> f64 {
        let forces = motion.forces();
        (0..N)
            .filter(|&ball| self.phases[ball] == Phase::Stick)
            .map(|ball| {
                let limit = self.balancer.balls[ball].friction_coefficient * forces.normal[ball];
                1.0 - forces.friction[ball].abs() / limit
            })
            .fold(f64::INFINITY, f64::min)
    }
}

/// Whole turns taken off a difference that is small otherwise; anything smaller is left alone.
fn wrapped_small(difference: f64) -> f64 {
    if difference.abs() > std::f64::consts::PI { wrapped(difference) } else { difference }
}
