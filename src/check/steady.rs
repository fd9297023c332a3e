//! The steady states of a system of one's own: where friction holds its contacts, and where all of them slide steadily.
//!
//! Start positions at which nothing moves are examined, with the coordinates that no friction holds where the forces on them
//! vanish (Newton's method). If the equations contain only differences of positions, steady motion at a constant speed is sought from
//! the start states, too.

use indexmap::IndexMap;
use nalgebra::Schur;
use serde::Serialize;

use crate::analysis::Stability;
use crate::model::{Model, Start, Translation, Translations, Units, wrap_to_two_pi};
use crate::motion::{Direction, Evaluator, Phase, Phases, ReducedEquations};

/// The number of start positions that are examined.
const EXAMINED: usize = 400;
/// The most steps of Newton's method, and the size of the last of them, over 1 and the largest component.
const MOST_STEPS: usize = 30;
const THERE: f64 = 1e-10;
/// Steady states nearer to each other than this, non-dimensional, are one.
const SAME: f64 = 1e-6;
/// Real parts of eigenvalues up to this, over the largest eigenvalue, are rounding.
const ROUNDING: f64 = 1e-9;
/// Contacts that slide more slowly than this, non-dimensional, while no coordinate moves, stick.
const STILL: f64 = 1e-12;

/// The steady states of a model.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SteadyStates {
    /// The fraction of the start positions, with all speeds zero, at which friction holds all contacts that do not slide; `None`
    /// if all contacts slide there.
    pub held_fraction: Option<f64>,
    /// The states in which all contacts slide and no coordinate moves, or coordinates move on at constant speeds.
    pub sliding: Vec<SteadySliding>,
}

/// A state in which all contacts slide and no coordinate moves, or coordinates move on at constant speeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteadySliding {
    /// The value of each coordinate, or the speed at which it moves on, by its name with the unit.
    pub coordinates: IndexMap<String, f64>,
    /// The largest real part of the eigenvalues of small motions, 1/s.
    pub largest_real_part_1_s: f64,
    /// `stable` if it is negative, `unstable` if it is positive, and `marginal` if it vanishes to rounding.
    pub stability: &'static str,
}

impl SteadyStates {
    /// Finds the steady states of a model in the ranges of its start states; `None` for a ball balancer, and for a system with
    /// contacts that open, with events, or that changes with time.
    pub fn of(model: &Model, ranges: &[[f64; 2]]) -> Option<Self> {
        let system = model.system().filter(|_| model.ball_balancer().is_none())?;
        let evaluator = Evaluator::new(system);
        let graph = evaluator.graph();
        if !graph.openings.is_empty() || !graph.events.is_empty() || graph.layout.forcing.is_some()
        {
            return None;
        }
        let (mut held, mut may_hold, mut found) = (0, false, Vec::<Vec<f64>>::new());
        let (units, mut states) = (model.units(), SteadyStates::default());
        let translations = evaluator.translations();
        let goes_on = translations != Translations::default();
        let starts_at_rest = ranges[ranges.len() / 2..].iter().all(|range| *range == [0.0; 2]);
        for number in 0..EXAMINED {
            let start = |moves: bool| -> Option<SteadyState> {
                let start = ranges.iter().enumerate().map(|(place, [low, high])| {
                    let is_sampled = moves || 2 * place < ranges.len();
                    if is_sampled { low + (high - low) * sample(number, place) } else { 0.0 }
                });
                let mut state = model.start_state(&Start(start.collect())).ok()?;
                // Half of the motions start with any velocities.
                if moves && (starts_at_rest || number % 2 == 1) {
                    for component in graph.layout.velocities.iter().flatten() {
                        state[*component] = 2.0 * sample(number, *component) - 1.0;
                    }
                }
                SteadyState::new(&evaluator, &translations, state.to_vec())
            };
            let still = start(false)?;
            may_hold |= still.sticks();
            let moving = goes_on.then(|| start(true)).flatten();
            let moving = moving.filter(|state| !state.sticks());
            for mut examined in std::iter::once(still).chain(moving) {
                if !examined.settles() || !examined.holds() {
                    continue;
                }
                if examined.sticks() {
                    held += 1;
                    continue;
                }
                let constants = examined.constants(&units);
                let state = examined.sliding(model, &units, &constants)?;
                let place = examined.place(&constants, &state);
                let is_known = |known: &Vec<f64>| {
                    known.iter().zip(&place).all(|(left, right)| (left - right).abs() < SAME)
                };
                if !found.iter().any(is_known) {
                    states.sliding.push(state);
                    found.push(place);
                }
            }
        }
        states.held_fraction = may_hold.then(|| f64::from(held) / EXAMINED as f64);
        Some(states)
    }
}

/// Returns an angle in [0, 2π), where an angle that is 2π but for rounding is 0.
fn within_a_turn(angle: f64) -> f64 {
    let angle = wrap_to_two_pi(angle);
    if std::f64::consts::TAU - angle < SAME { 0.0 } else { angle }
}

/// Returns a point of a sequence that fills the unit cube evenly: multiples of square roots of primes (Weyl).
fn sample(number: usize, dimension: usize) -> f64 {
    let is_prime = |value: &u32| (2..*value).all(|divisor| !value.is_multiple_of(divisor));
    let prime = (2..).filter(is_prime).nth(dimension).map_or(2.0, f64::from);
    ((number as f64 + 0.5) * prime.sqrt()).fract()
}

/// A state in which nothing moves but along translations that no equation notices.
struct SteadyState<'e> {
    evaluator: &'e Evaluator,
    reduced: ReducedEquations<'e>,
    state: Vec<f64>,
}

impl<'e> SteadyState<'e> {
    /// Returns `None` if a contact may stick whose sliding speed is no component of the state, or if a component, such as the
    /// time, moves by itself.
    fn new(evaluator: &'e Evaluator, translations: &Translations, state: Vec<f64>) -> Option<Self> {
        let (graph, system) = (evaluator.graph(), evaluator.system());
        let phase = |(contact, speed): (usize, &f64)| match speed.abs() <= STILL {
            _ if !system.friction(contact).can_stick() => Phase::Free,
            true => Phase::Stick,
            false => Phase::Slip(Direction::of(*speed)),
        };
        let phases: Phases = evaluator.speeds(&state).iter().enumerate().map(phase).collect();
        let has_speed =
            |(contact, phase)| phase != &Phase::Stick || graph.speed_component(contact).is_some();
        let rates = evaluator.rates(&phases, &state);
        let velocities = || graph.layout.velocities.iter().flatten();
        let runs = |place: usize| {
            graph.is_clock(place) && rates[place] != 0.0 && !velocities().any(|one| *one == place)
        };
        if !phases.iter().enumerate().all(has_speed)
            || (0..state.len()).any(|place| runs(place) && !translations.displace(place))
        {
            return None;
        }
        let reduced = ReducedEquations::new(evaluator, &phases, translations);
        Some(SteadyState { evaluator, reduced, state })
    }

    fn sticks(&self) -> bool {
        self.reduced.phases.contains(&Phase::Stick)
    }

    /// Changes the variables to where their rates vanish; returns whether there is such a place.
    fn settles(&mut self) -> bool {
        for _ in 0..MOST_STEPS {
            if self.reduced.variables.is_empty() {
                break;
            }
            let slopes = self.reduced.slopes(&self.state);
            let Some(step) = slopes.lu().solve(&-self.reduced.rates(&self.state)) else {
                return false;
            };
            if !step.iter().all(|entry| entry.is_finite()) {
                return false;
            }
            self.reduced.displace(&mut self.state, &step);
            let variables = self.reduced.variables.iter();
            let largest = variables.fold(1.0_f64, |most, of| most.max(self.state[*of].abs()));
            if step.amax() <= THERE * largest {
                break;
            }
        }
        // A component that only time moves is no steady state.
        self.reduced.all_rates(&self.state).iter().all(|rate| rate.abs() <= THERE)
    }

    /// Returns whether all contacts are pressed together, slide as assumed, and friction holds those that stick.
    fn holds(&self) -> bool {
        let forces = self.evaluator.forces(&self.reduced.phases, &self.state);
        forces.iter().enumerate().all(|(contact, force)| {
            let limit = self.evaluator.system().friction(contact).limit * force.normal;
            // A sliding speed that contains positions may have another direction here.
            let slides_so = match self.reduced.phases[contact] {
                Phase::Slip(direction) => direction * force.speed > STILL,
                Phase::Stick => force.speed.abs() <= STILL,
                _ => true,
            };
            force.normal > 0.0
                && slides_so
                && (self.reduced.phases[contact] != Phase::Stick || force.friction.abs() <= limit)
        })
    }

    /// Returns the numbers and values of the outputs that do not change, non-dimensional: of a coordinate that a translation displaces
    /// its rate of change, otherwise the coordinate. Angles that go round and round are within one turn.
    fn constants(&self, units: &Units) -> Vec<(usize, f64)> {
        let outputs = |state: &[f64]| self.evaluator.system().outputs(state);
        let now = outputs(&self.state);
        // A kind in Rust may have no outputs.
        let count =
            now.len().min(self.evaluator.graph().layout.velocities.iter().flatten().count());
        let displaced = |translation: &Translation| {
            let displaced = |place: usize| self.state[place] + translation.of(place);
            outputs(&(0..self.state.len()).map(displaced).collect::<Vec<_>>())
        };
        let displaced: Vec<_> = self.reduced.translations.0.iter().map(displaced).collect();
        let is_displaced =
            |number: usize| displaced.iter().any(|of| (of[number] - now[number]).abs() > ROUNDING);
        let constant = |number: usize| match is_displaced(number) {
            true => {
                let rate = count + number;
                (rate, now.get(rate).copied().unwrap_or_default())
            }
            false if units.outputs.get(number).is_some_and(|units| units.angular) => {
                (number, within_a_turn(now[number]))
            }
            false => (number, now[number]),
        };
        (0..count).map(constant).collect()
    }

    /// Returns values that are equal in equal states. Of motions that go on, only speeds are known; those with equal
    /// speeds differ in their stability.
    fn place(&self, constants: &[(usize, f64)], state: &SteadySliding) -> Vec<f64> {
        let values = constants.iter().map(|(_, value)| *value);
        let goes_on = self.reduced.translations != Translations::default();
        values.chain(goes_on.then_some(state.largest_real_part_1_s)).collect()
    }

    fn sliding(
        &self,
        model: &Model,
        units: &Units,
        constants: &[(usize, f64)],
    ) -> Option<SteadySliding> {
        // The number of iterations is bounded: for a matrix that is not finite the decomposition would not end.
        let eigenvalues = Schur::try_new(self.reduced.slopes(&self.state), f64::EPSILON, 10_000)?
            .complex_eigenvalues();
        let largest = eigenvalues.iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max);
        let size = eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let stability = match largest {
            _ if largest.abs() <= ROUNDING * size => Stability::Marginal,
            _ if largest < 0.0 => Stability::Stable,
            _ => Stability::Unstable,
        };
        let names = model.output_names();
        let named = |(number, value): &(usize, f64)| {
            let (output, units) = (names.get(*number)?, units.outputs.get(*number)?);
            Some((output.name.clone(), value * units.size))
        };
        Some(SteadySliding {
            coordinates: constants.iter().filter_map(named).collect(),
            largest_real_part_1_s: largest * units.natural_rad_s,
            stability: stability.name(),
        })
    }
}
