//! The return map of a running ball: from one passage through the angle 0 to one some turns later.
//!
//! Newton's method finds the closed orbit near a state, central differences of the map its
//! multipliers. Both integrate through all switches on the way.

use nalgebra::{DMatrix, DVector, Dyn, LU, Schur};

use crate::model::{Balancer, State};
use crate::motion::{Motion, Phase, Settings};

/// How far from the run the closed orbit may lie, non-dimensional.
pub(super) const REACH: f64 = 1e-2;
/// Most turns that Newton's method follows: 15 steps on an orbit of a few turns, and the slope taken
/// anew on the way; one slope and five steps on one of twelve.
const MOST_TURNS_FOLLOWED: usize = 150;
/// Most returns within which the run must come ten times nearer to the orbit.
const MOST_RETURNS: usize = 200;
/// Multipliers by one-sided differences beyond this leave no doubt.
const CLEARLY_UNSTABLE: f64 = 1.2;
/// Step of the differences, non-dimensional: for multipliers, and the most and the least for Newton's
/// method.
const DIFFERENCE: f64 = 1e-4;
const LEAST_DIFFERENCE: f64 = 1e-6;
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
pub(super) enum Verdict<const N: usize> {
    /// A limit cycle.
    Stable(Orbit<N>),
    /// A closed orbit that a disturbance grows away from.
    Unstable,
    /// Neither could be shown.
    Open,
}

/// The map from one passage of the section to a later one.
pub(super) struct ReturnMap<'a, const N: usize> {
    pub(super) balancer: &'a Balancer<N>,
    pub(super) settings: Settings,
    pub(super) reference: usize,
    pub(super) turns: usize,
    pub(super) phases: [Phase; N],
    /// Which balls rest all along.
    pub(super) rests: [bool; N],
    /// Give up after this time.
    pub(super) longest: f64,
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
    pub(super) fn verdict(&self, state: &State<N>, closure: f64) -> Option<Verdict<N>> {
        let first = self.coordinates(state);
        let mut centre = first.clone();
        let mut newton: Option<LU<f64, Dyn, Dyn>> = None;
        let (mut spread, mut last) = (None, f64::INFINITY);
        let mut followed = 0;
        while followed < MOST_TURNS_FOLLOWED {
            followed += self.turns;
            let start = self.state(state, &centre);
            let orbit = self.follow(&start)?;
            let residual = (self.coordinates(&orbit.state) - &centre).map(wrapped_small);
            let size = residual.amax();
            if size <= closure {
                // One-sided differences are rough, but far outside the unit circle is outside.
                let grows = spread.is_some_and(|largest| largest > CLEARLY_UNSTABLE);
                return if grows {
                    Some(Verdict::Unstable)
                } else {
                    self.in_fewest_turns(&start, state, closure)
                };
            }
            // The map has kinks near an orbit on which a ball barely sticks: where progress is slow,
            // its slope is taken anew, from nearer by.
            if size > 0.25 * last || newton.is_none() {
                let difference = (0.1 * size).clamp(LEAST_DIFFERENCE, DIFFERENCE);
                followed += centre.len() * self.turns;
                let slope = self.slope(&start, &centre, &orbit.state, difference)?;
                spread = largest_multiplier(slope.clone());
                newton = Some((DMatrix::identity(centre.len(), centre.len()) - slope).lu());
            }
            last = size;
            // (1 - J) δ = P(s) - s
            centre += newton.as_ref()?.solve(&residual)?;
            if (&centre - &first).amax() > REACH {
                return None;
            }
        }
        None
    }

    /// What the closed orbit from `state` is when it is followed once round: an orbit that closes
    /// after six turns may close after two.
    /// `run` is where the run itself is.
    fn in_fewest_turns(
        &self,
        state: &State<N>,
        run: &State<N>,
        closure: f64,
    ) -> Option<Verdict<N>> {
        let centre = self.coordinates(state);
        for turns in (1..=self.turns).filter(|turns| self.turns.is_multiple_of(*turns)) {
            let once = ReturnMap { turns, ..*self };
            if let Some(orbit) = once.follow(state) {
                let residual = (self.coordinates(&orbit.state) - &centre).map(wrapped_small);
                if residual.amax() <= closure {
                    let jacobian = once.jacobian(state, &centre)?;
                    let verdict = once.judge(state, orbit, jacobian);
                    let claimed = matches!(verdict, Verdict::Stable(_));
                    return (!claimed || once.attracts(run, &centre, closure)).then_some(verdict);
                }
            }
        }
        None
    }

    /// Whether the run itself is drawn to the orbit: whether it comes ten times nearer. An orbit
    /// with multipliers inside the unit circle may have a small basin; a ball that slowly swings
    /// about its place in the orbit, sticking at every turn, may never come closer.
    fn attracts(&self, run: &State<N>, centre: &DVector<f64>, closure: f64) -> bool {
        let distance =
            |state: &State<N>| (self.coordinates(state) - centre).map(wrapped_small).amax();
        let mut state = *run;
        let first = distance(&state);
        for _ in 0..MOST_RETURNS {
            let now = distance(&state);
            if now <= closure.max(0.1 * first) {
                return true;
            }
            match self.follow(&state) {
                Some(next) if now <= 10.0 * first => state = next.state,
                _ => return false,
            }
        }
        false
    }

    /// The derivative of the return map, by differences to one side: good enough for Newton's
    /// method. `end` is where the map leads from `like`, whose coordinates are `centre`.
    fn slope(
        &self,
        like: &State<N>,
        centre: &DVector<f64>,
        end: &State<N>,
        difference: f64,
    ) -> Option<DMatrix<f64>> {
        let end = self.coordinates(end);
        let columns: Option<Vec<DVector<f64>>> = (0..centre.len())
            .map(|column| {
                let mut point = centre.clone();
                point[column] += difference;
                let shifted = self.follow(&self.state(like, &point))?;
                let change = self.coordinates(&shifted.state) - &end;
                Some(change.map(wrapped_small) / difference)
            })
            .collect();
        Some(DMatrix::from_columns(&columns?))
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
        let Some(largest) = largest_multiplier(jacobian) else { return Verdict::Open };
        if largest > 1.0 + MULTIPLIER_DOUBT {
            return Verdict::Unstable;
        }
        let keeps_margin = orbit.margin.is_none_or(|margin| margin > 0.0);
        if !(largest < 1.0 - MULTIPLIER_DOUBT && keeps_margin) {
            return Verdict::Open;
        }
        let turned: [f64; N] = std::array::from_fn(|ball| {
            if ball == self.reference {
                state.beta_dot[self.reference].signum() * self.turns as f64 * std::f64::consts::TAU
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
        let mut motion = Motion::new(self.balancer, self.settings, start).ok()?;
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

    fn least_margin(&self, motion: &Motion<Balancer<N>, N>) -> f64 {
        let forces = motion.forces();
        (0..N)
            .filter(|&ball| self.rests[ball])
            .map(|ball| {
                let limit = self.balancer.balls[ball].friction.limit * forces.normal[ball];
                1.0 - forces.friction[ball].abs() / limit
            })
            .fold(f64::INFINITY, f64::min)
    }
}

/// The largest modulus of a matrix's eigenvalues; none where they cannot be found.
fn largest_multiplier(jacobian: DMatrix<f64>) -> Option<f64> {
    // The decomposition is bounded: of a matrix that is not finite it would never come back.
    let multipliers = Some(jacobian)
        .filter(|jacobian| jacobian.iter().all(|slope| slope.is_finite()))
        .and_then(|jacobian| Schur::try_new(jacobian, f64::EPSILON, 10_000))?
        .complex_eigenvalues();
    Some(multipliers.iter().map(|multiplier| multiplier.norm()).fold(0.0, f64::max))
}

/// Whole turns taken off a difference that is small otherwise; anything smaller is left alone.
fn wrapped_small(difference: f64) -> f64 {
    if difference.abs() > std::f64::consts::PI { wrapped(difference) } else { difference }
}

/// An angle in [-π, π].
pub(super) fn wrapped(angle: f64) -> f64 {
    angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round()
}
