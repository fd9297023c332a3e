//! The steady states of a system of one's own: where friction holds its contacts, and where all of them slide steadily.
//!
//! Start positions at which nothing moves are examined, with the coordinates that no friction holds where the forces on them
//! vanish (Newton's method).

use indexmap::IndexMap;
use nalgebra::{DMatrix, DVector, Schur};
use serde::Serialize;

use crate::analysis::Stability;
use crate::model::{Dual, Model, OutputUnits, Start, Units, wrap_to_two_pi};
use crate::motion::{Direction, Evaluator, Phase, Phases};

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
    /// The states in which all contacts slide and no coordinate moves.
    pub sliding: Vec<SteadySliding>,
}

/// A state in which all contacts slide and no coordinate moves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteadySliding {
    /// The value of each coordinate, by its name with the unit.
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
        for number in 0..EXAMINED {
            let start = ranges.iter().enumerate().map(|(place, [low, high])| {
                let is_position = 2 * place < ranges.len();
                if is_position { low + (high - low) * sample(number, place) } else { 0.0 }
            });
            let state = model.start_state(&Start(start.collect())).ok()?;
            let mut examined = StillState::new(&evaluator, state.to_vec())?;
            may_hold |= examined.sticks();
            if !examined.settles() || !examined.holds() {
                continue;
            }
            if examined.sticks() {
                held += 1;
                continue;
            }
            let place = examined.coordinates(&units);
            let is_known = |known: &Vec<f64>| {
                known.iter().zip(&place).all(|(left, right)| (left - right).abs() < SAME)
            };
            if !found.iter().any(is_known) {
                states.sliding.push(examined.sliding(model, &units, &place)?);
                found.push(place);
            }
        }
        states.held_fraction = may_hold.then(|| f64::from(held) / EXAMINED as f64);
        Some(states)
    }
}

/// Returns a point of a sequence that fills the unit cube evenly: multiples of square roots of primes (Weyl).
fn sample(number: usize, dimension: usize) -> f64 {
    let is_prime = |value: &u32| (2..*value).all(|divisor| !value.is_multiple_of(divisor));
    let prime = (2..).filter(is_prime).nth(dimension).map_or(2.0, f64::from);
    ((number as f64 + 0.5) * prime.sqrt()).fract()
}

/// A state in which no coordinate moves.
struct StillState<'e> {
    evaluator: &'e Evaluator,
    phases: Phases,
    state: Vec<f64>,
    /// The positions that no contact holds, and the rates that must vanish there.
    free: Vec<usize>,
    rates: Vec<usize>,
}

impl<'e> StillState<'e> {
    /// Returns `None` if a contact may stick whose sliding speed is no component of the state, or if a component that is no
    /// position, such as the time, moves by itself.
    fn new(evaluator: &'e Evaluator, state: Vec<f64>) -> Option<Self> {
        let (graph, system) = (evaluator.graph(), evaluator.system());
        let phase = |(contact, speed): (usize, &f64)| match speed.abs() <= STILL {
            _ if !system.friction(contact).can_stick() => Phase::Free,
            true => Phase::Stick,
            false => Phase::Slip(Direction::of(*speed)),
        };
        let phases: Phases = evaluator.speeds(&state).iter().enumerate().map(phase).collect();
        let (mut held, mut still) = (Vec::new(), Vec::new());
        for (contact, _) in phases.iter().enumerate().filter(|(_, phase)| **phase == Phase::Stick) {
            held.push(graph.layout.contacts[contact].position);
            still.push(graph.speed_component(contact)?);
        }
        let velocities: Vec<usize> = graph.layout.velocities.iter().flatten().copied().collect();
        let is_free = |place: &usize| !velocities.contains(place) && !held.contains(place);
        let free: Vec<usize> = (0..state.len()).filter(is_free).collect();
        let moves = |place: &usize| !still.contains(place);
        let rates: Vec<usize> = velocities.iter().copied().filter(moves).collect();
        (free.len() == rates.len()).then_some(StillState { evaluator, phases, state, free, rates })
    }

    fn sticks(&self) -> bool {
        self.phases.contains(&Phase::Stick)
    }

    /// Returns the derivatives of some rates by some components.
    fn slopes(&self, rates: &[usize], components: &[usize]) -> DMatrix<f64> {
        let columns: Vec<_> = components
            .iter()
            .map(|along| {
                let dual = |component: usize| Dual {
                    value: self.state[component],
                    slope: if component == *along { 1.0 } else { 0.0 },
                };
                self.evaluator.all_values(&self.phases, dual)
            })
            .collect();
        let derivative = &self.evaluator.graph().derivative;
        DMatrix::from_fn(rates.len(), components.len(), |row, column| {
            columns[column][derivative[rates[row]] as usize].slope
        })
    }

    /// Moves the free positions to where their accelerations vanish; returns whether there is such a place.
    fn settles(&mut self) -> bool {
        for _ in 0..MOST_STEPS {
            let rates = self.evaluator.rates(&self.phases, &self.state);
            let now =
                DVector::from_iterator(self.rates.len(), self.rates.iter().map(|row| rates[*row]));
            if self.free.is_empty() {
                return now.amax() <= THERE;
            }
            let Some(step) = self.slopes(&self.rates, &self.free).lu().solve(&now) else {
                return false;
            };
            for (component, step) in self.free.iter().zip(step.iter()) {
                self.state[*component] -= step;
            }
            let largest =
                self.free.iter().fold(1.0_f64, |most, place| most.max(self.state[*place].abs()));
            if !step.iter().all(|entry| entry.is_finite()) {
                return false;
            }
            if step.amax() <= THERE * largest {
                let rates = self.evaluator.rates(&self.phases, &self.state);
                // A component that only time moves, or a position that drifts, is no steady state.
                return self.free.iter().all(|place| rates[*place].abs() <= THERE);
            }
        }
        false
    }

    /// Returns whether all contacts are pressed together, slide as assumed, and friction holds those that stick.
    fn holds(&self) -> bool {
        let forces = self.evaluator.forces(&self.phases, &self.state);
        forces.iter().enumerate().all(|(contact, force)| {
            let limit = self.evaluator.system().friction(contact).limit * force.normal;
            // A sliding speed that contains positions may have another direction here.
            let slides_so = match self.phases[contact] {
                Phase::Slip(direction) => direction * force.speed > STILL,
                Phase::Stick => force.speed.abs() <= STILL,
                _ => true,
            };
            force.normal > 0.0
                && slides_so
                && (self.phases[contact] != Phase::Stick || force.friction.abs() <= limit)
        })
    }

    /// Returns the non-dimensional values of the coordinates; angles that go round and round are within one turn.
    fn coordinates(&self, units: &Units) -> Vec<f64> {
        let values = self.evaluator.system().outputs(&self.state);
        let wrapped = |(value, unit): (&f64, &OutputUnits)| {
            if unit.angular { wrap_to_two_pi(*value) } else { *value }
        };
        values.iter().zip(&units.outputs).take(self.state.len() / 2).map(wrapped).collect()
    }

    fn sliding(&self, model: &Model, units: &Units, place: &[f64]) -> Option<SteadySliding> {
        let all: Vec<usize> = (0..self.state.len()).collect();
        let slopes = self.slopes(&all, &all);
        // The number of iterations is bounded: for a matrix that is not finite the decomposition would not end.
        let eigenvalues = Schur::try_new(slopes, f64::EPSILON, 10_000)?.complex_eigenvalues();
        let largest = eigenvalues.iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max);
        let size = eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let stability = match largest {
            _ if largest.abs() <= ROUNDING * size => Stability::Marginal,
            _ if largest < 0.0 => Stability::Stable,
            _ => Stability::Unstable,
        };
        let names = model.output_names().into_iter();
        let values = place.iter().zip(&units.outputs).map(|(value, unit)| value * unit.size);
        Some(SteadySliding {
            coordinates: names.zip(values).map(|(output, value)| (output.name, value)).collect(),
            largest_real_part_1_s: largest * units.natural_rad_s,
            stability: stability.name(),
        })
    }
}
