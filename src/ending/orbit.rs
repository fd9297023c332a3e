//! Closed orbits: evidence that a run has settled on a limit cycle.
//!
//! A running ball goes round the ring, so that an orbit closes only modulo 2π. The section is its
//! passage through the angle 0; the return map takes the state at one passage to that some turns
//! later. An orbit is a limit cycle on three counts:
//!
//! 1. it closes: from where the run nearly comes back to itself, Newton's method (with the slope kept) on the return map finds an orbit that does within a small multiple of the tolerances, and the run is near it;
//! 2. it is stable: all multipliers of the return map, by central differences through all switches
//!    on the way, lie inside the unit circle;
//! 3. balls that rest keep a margin all along it. Where such a ball rests does not change from one
//!    return to the next: those neutral directions (the cycles form a continuous family) are left
//!    out of the map instead of being mistaken for instability.
//!
//! One ball at least must go round without stopping; the others may run, rest, or stick and slip.

use nalgebra::{DMatrix, DVector};

use crate::model::{Balancer, State};
use crate::motion::{Phase, Settings, SwitchModel, Tolerance};

/// The most turns of the running ball after which an orbit may close.
const MOST_TURNS: usize = 12;
/// How near a return must come to an earlier passage for a closer look, non-dimensional.
const NEAR: f64 = 1e-3;
/// How far from the run the closed orbit may lie, non-dimensional.
const REACH: f64 = 1e-2;
/// Most steps of Newton's method.
const MOST_REFINEMENTS: usize = 10;
/// Returns in a row that must be near.
const NEAR_RETURNS: usize = 3;
/// How often per run the multipliers are computed at most.
const MOST_ATTEMPTS: u32 = 3;
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
enum Verdict<const N: usize> {
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
    /// How far it is from the passage `turns` turns earlier.
    differences: [f64; MOST_TURNS + 1],
}

/// Watches a motion for a closing orbit.
#[derive(Clone, Debug)]
pub struct OrbitWatch<const N: usize> {
    closure: f64,
    ball: Option<usize>,
    passages: Vec<Passage<N>>,
    near_in_a_row: [usize; MOST_TURNS + 1],
    attempts: u32,
    wait_until: f64,
    /// Turns of an unstable closed orbit that the run has come near.
    unstable: Option<usize>,
}

impl<const N: usize> OrbitWatch<N> {
    /// A watch for motions computed with `settings`.
    pub fn new(settings: &Settings) -> Self {
        let Tolerance { relative, absolute } = settings.tolerance;
        OrbitWatch {
            closure: 100.0 * (relative + absolute),
            ball: None,
            passages: Vec::with_capacity(MOST_TURNS + 2),
            near_in_a_row: [0; MOST_TURNS + 1],
            attempts: 0,
            wait_until: 0.0,
            unstable: None,
        }
    }

    /// Looks at the motion's latest step and returns the limit cycle that the run has been shown to
    /// be on. Most steps show nothing.
    pub fn look(
        &mut self,
        balancer: &Balancer<N>,
        settings: &Settings,
        motion: &mut SwitchModel<N>,
    ) -> Option<Orbit<N>> {
        if self.ball.is_some_and(|ball| motion.phases()[ball].in_band()) {
            self.restart();
        }
        let gone_round = |angle: f64| !(0.0..std::f64::consts::TAU).contains(&angle);
        let beta = motion.state().beta;
        let reference = match self.ball {
            Some(ball) if gone_round(beta[ball]) => ball,
            Some(_) => return None,
            None => (0..N).find(|&ball| gone_round(beta[ball]))?,
        };
        let Some((time, state)) = motion.passage(reference) else {
            self.restart();
            return None;
        };
        self.ball = Some(reference);
        let differences = [f64::INFINITY; MOST_TURNS + 1];
        let passage = Passage { time, state, phases: *motion.phases(), differences };
        let turns = self.record(reference, passage)?;
        if self.attempts >= MOST_ATTEMPTS || time < self.wait_until {
            return None;
        }
        self.attempts += 1;
        // After a look that showed nothing, give the motion ten times as long to settle.
        self.wait_until = time + 10.0 * (time - self.passages.first()?.time);
        match self.examine(balancer, settings, reference, turns, motion.last_switches()) {
            Verdict::Stable(orbit) => return Some(orbit),
            Verdict::Unstable => self.unstable = Some(turns),
            Verdict::Open => {}
        }
        None
    }

    /// Whether the run itself, at its latest passage, closes on an orbit that has been shown to be
    /// unstable: only a symmetry, or too little time, has kept it there.
    pub fn on_unstable_orbit(&self) -> bool {
        match (self.unstable, self.passages.last()) {
            (Some(turns), Some(passage)) => passage.differences[turns] <= self.closure,
            _ => false,
        }
    }

    fn restart(&mut self) {
        self.ball = None;
        self.passages.clear();
        self.near_in_a_row = [0; MOST_TURNS + 1];
    }

    /// Takes a passage in and returns the least number of turns after which the orbit seems to
    /// close: some returns in a row are near, and nearer than one such return earlier, or as near
    /// as the tolerances let them be.
    fn record(&mut self, reference: usize, mut passage: Passage<N>) -> Option<usize> {
        let mut closing = None;
        for turns in 1..=MOST_TURNS.min(self.passages.len()) {
            let earlier = &self.passages[self.passages.len() - turns];
            let distance = difference(earlier, &passage, reference);
            passage.differences[turns] = distance;
            let approaches = distance < earlier.differences[turns] || distance <= self.closure;
            let near = earlier.phases == passage.phases && distance <= NEAR && approaches;
            self.near_in_a_row[turns] = if near { self.near_in_a_row[turns] + 1 } else { 0 };
            if self.near_in_a_row[turns] >= NEAR_RETURNS.max(turns) && closing.is_none() {
                closing = Some(turns);
            }
        }
        if self.passages.len() > MOST_TURNS {
            self.passages.remove(0);
        }
        self.passages.push(passage);
        closing
    }

    /// Multipliers, distance to the fixed point and margins of an orbit that closes.
    fn examine(
        &self,
        balancer: &Balancer<N>,
        settings: &Settings,
        reference: usize,
        turns: usize,
        last_switches: &[f64; N],
    ) -> Verdict<N> {
        let Some(passage) = self.passages.last() else { return Verdict::Open };
        let earlier = self.passages[self.passages.len() - 1 - turns].time;
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
            rests: std::array::from_fn(|ball| {
                passage.phases[ball] == Phase::Stick && last_switches[ball] < earlier
            }),
            longest: 2.0 * (passage.time - earlier),
        };
        map.verdict(&passage.state, self.closure).unwrap_or(Verdict::Open)
    }
}

/// The largest difference of two passages, angles modulo 2π. What is left of the speed of a ball
/// that sticks does not count.
fn difference<const N: usize>(a: &Passage<N>, b: &Passage<N>, reference: usize) -> f64 {
    let phases = &a.phases;
    let (a, b) = (&a.state, &b.state);
    let mut largest: f64 = 0.0;
    for axis in 0..2 {
        largest = largest.max((a.position[axis] - b.position[axis]).abs());
        largest = largest.max((a.velocity[axis] - b.velocity[axis]).abs());
    }
    for (ball, phase) in phases.iter().enumerate() {
        if *phase != Phase::Stick {
            largest = largest.max((a.beta_dot[ball] - b.beta_dot[ball]).abs());
        }
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
    /// Which balls rest all along.
    rests: [bool; N],
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
    /// Refines the orbit near `state` and says what it is.
    fn verdict(&self, state: &State<N>, closure: f64) -> Option<Verdict<N>> {
        let first = self.coordinates(state);
        let mut centre = first.clone();
        let slope = self.jacobian(state, &centre)?;
        let dimension = first.len();
        let newton = (DMatrix::identity(dimension, dimension) - slope).lu();
        for _ in 0..MOST_REFINEMENTS {
            let start = self.state(state, &centre);
            let orbit = self.follow(&start)?;
            let residual = (self.coordinates(&orbit.state) - &centre).map(wrapped_small);
            if residual.amax() <= closure {
                return self.in_fewest_turns(&start, closure);
            }
            // (1 - J) δ = P(s) - s
            centre += newton.solve(&residual)?;
            if (&centre - &first).amax() > REACH {
                return None;
            }
        }
        None
    }

    /// What the closed orbit from `state` is when it is followed once round: an orbit that closes
    /// after six turns may close after two.
    fn in_fewest_turns(&self, state: &State<N>, closure: f64) -> Option<Verdict<N>> {
        let centre = self.coordinates(state);
        for turns in (1..=self.turns).filter(|turns| self.turns.is_multiple_of(*turns)) {
            let once = ReturnMap { turns, ..*self };
            if let Some(orbit) = once.follow(state) {
                let residual = (self.coordinates(&orbit.state) - &centre).map(wrapped_small);
                if residual.amax() <= closure {
                    let jacobian = once.jacobian(state, &centre)?;
                    return Some(once.judge(state, orbit, jacobian));
                }
            }
        }
        None
    }

    /// The derivative of the return map, by central differences.
    fn jacobian(&self, like: &State<N>, centre: &DVector<f64>) -> Option<DMatrix<f64>> {
        let dimension = centre.len();
        let mut jacobian = DMatrix::<f64>::zeros(dimension, dimension);
        for column in 0..dimension {
            let shifted = |step: f64| {
                let mut point = centre.clone();
                point[column] += step;
                self.follow(&self.state(like, &point)).map(|end| self.coordinates(&end.state))
            };
            let change = shifted(DIFFERENCE)? - shifted(-DIFFERENCE)?;
            jacobian.set_column(column, &(change.map(wrapped_small) / (2.0 * DIFFERENCE)));
        }
        Some(jacobian)
    }

    /// Stability and margins of a closed orbit from `state`.
    fn judge(&self, state: &State<N>, orbit: Return<N>, jacobian: DMatrix<f64>) -> Verdict<N> {
        let multipliers = jacobian.complex_eigenvalues();
        let largest = multipliers.iter().map(|m| m.norm()).fold(0.0, f64::max);
        if largest > 1.0 + MULTIPLIER_DOUBT {
            return Verdict::Unstable;
        }
        let keeps_margin = orbit.margin.is_none_or(|margin| margin > 0.0);
        if !(largest < 1.0 - MULTIPLIER_DOUBT && keeps_margin) {
            return Verdict::Open;
        }
        let turned: [f64; N] = std::array::from_fn(|ball| {
            if ball == self.reference {
                self.direction() * self.turns as f64 * std::f64::consts::TAU
            } else {
                orbit.state.beta[ball] - state.beta[ball]
            }
        });
        let running = turned.map(|angle| angle.abs() > std::f64::consts::PI);
        let speed = turned.map(|angle| angle / orbit.time);
        Verdict::Stable(Orbit {
            period: orbit.time,
            running,
            speed,
            amplitude: orbit.mean_square.sqrt(),
            margin: orbit.margin,
            largest_multiplier: largest,
        })
    }

    fn direction(&self) -> f64 {
        match self.phases[self.reference] {
            Phase::Slip(direction) | Phase::Transition(direction) => direction,
            Phase::Stick => 0.0,
        }
    }

    /// The coordinates that the map acts on: the table's, and those of balls that move on the way,
    /// less the angle of the one that marks the section and the speed of one that sticks there.
    fn coordinates(&self, state: &State<N>) -> DVector<f64> {
        let mut values = [state.position, state.velocity].concat();
        for ball in 0..N {
            if self.acts_on_speed(ball) {
                values.push(state.beta_dot[ball]);
            }
            if self.acts_on_angle(ball) {
                values.push(state.beta[ball]);
            }
        }
        DVector::from_vec(values)
    }

    fn acts_on_speed(&self, ball: usize) -> bool {
        self.phases[ball] != Phase::Stick
    }

    fn acts_on_angle(&self, ball: usize) -> bool {
        ball != self.reference && !self.rests[ball]
    }

    /// The state with these coordinates; balls at rest stay where `like` has them.
    fn state(&self, like: &State<N>, coordinates: &DVector<f64>) -> State<N> {
        let mut state = *like;
        let mut values = coordinates.iter().copied();
        let mut next = || values.next().unwrap_or(0.0);
        state.position = [next(), next()];
        state.velocity = [next(), next()];
        for ball in 0..N {
            if self.acts_on_speed(ball) {
                state.beta_dot[ball] = next();
            }
            if self.acts_on_angle(ball) {
                state.beta[ball] = next();
            }
        }
        state
    }

    /// One return; `None` where a ball that should rest moves, or the marking ball stops or does not
    /// come back.
    fn follow(&self, start: &State<N>) -> Option<Return<N>> {
        let mut start = *start;
        start.beta[self.reference] = 0.0;
        let mut motion = SwitchModel::new(self.balancer, self.settings, start).ok()?;
        let (mut margin, mut square_time) = (f64::INFINITY, 0.0);
        let square = |state: &State<N>| state.position.iter().map(|p| p * p).sum::<f64>();
        let mut passed = 0;
        while motion.time() < self.longest {
            let stays = |ball: usize| {
                let phase = motion.phases()[ball];
                (!self.rests[ball] || phase == Phase::Stick)
                    && (ball != self.reference || !phase.in_band())
            };
            if !(0..N).all(stays) {
                return None;
            }
            let (before, square_before) = (motion.time(), square(motion.state()));
            motion.advance(self.longest).ok()?;
            margin = margin.min(self.least_margin(&motion));
            if let Some((time, mut state)) = motion.passage(self.reference) {
                passed += 1;
                if passed == self.turns {
                    if motion.phases() != &self.phases {
                        return None;
                    }
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
            .filter(|&ball| self.rests[ball])
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
