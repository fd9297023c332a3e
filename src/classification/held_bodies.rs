//! Bodies at rest that contacts hold in all directions, such as a box on two feet or a ladder at a wall.
//!
//! Such bodies rest if there are forces of the contacts that balance all others: in each contact that may open a normal force
//! `n ≥ 0`, and in each contact a friction force `|t| ≤ μ n` (the static law; R. I. Leine, N. van de Wouw, *Stability and Convergence
//! of Mechanical Systems with Unilateral Constraints*, Springer 2008, doi:10.1007/978-3-540-76975-0). Rigid bodies do not determine
//! these forces. A linear programme finds those with the largest reserve. If the contacts act in all directions and all of them have
//! a reserve, a small further force moves nothing.

use nalgebra::{DMatrix, DVector, SVD};

use super::rest_in_touch::at_rest;
use super::system_view::SystemView;
use crate::model::{MOST_STRENGTH, largest_reserve, least_strength};
use crate::motion::{Direction, ImpactPlace, Phase, Phases, STILL, lies};

/// The largest component of the time derivative of bodies at rest, non-dimensional.
const RESTS: f64 = 1e-9;
/// Each contact has at least this part of its friction in reserve.
const RESERVE: f64 = 1e-6;
/// Singular values below this part of the largest one are zero.
const DEPENDENT: f64 = 1e-9;
/// The largest force that is not balanced, over the largest force: a motion that has settled is slow.
const BALANCED: f64 = 1e-5;

/// The effects of the contacts on the bodies: the rates of change of the state without the forces that hold them, and with a unit of
/// each of these forces.
struct ContactEffects {
    pushed: DVector<f64>,
    forces: Vec<DVector<f64>>,
    supports: Vec<Support>,
}

/// A contact at rest, or one whose friction its normal force determines.
struct Support {
    /// The place of its normal force among the forces, or the force.
    normal: Result<usize, f64>,
    /// The place of its friction force, and the static coefficient of friction.
    friction: Option<(usize, f64)>,
}

/// Returns the part of its friction that the contact with the least of it has in reserve, for the best forces; `None` if the bodies
/// move, if contacts do not hold them in all directions, or if no forces hold them with a reserve. Where the equations determine all
/// forces, closed forms at rest say so, if there are some.
pub(super) fn held_margin(view: &SystemView, phases: &[Phase], state: &[f64]) -> Option<f64> {
    let (evaluator, graph) = (&view.evaluator, view.evaluator.graph());
    let is_slow = |rate: &f64| rate.abs() <= RESTS;
    let gaps = || evaluator.openings(|component| state[component]);
    let lie_apart = || {
        let at = graph.openings.iter().zip(gaps()).filter(|(_, at)| lies(at));
        at.map(|(opening, _)| opening.contact).collect::<Vec<_>>()
    };
    // A contact that slides, or would if it touched.
    let slides = || {
        let lie_apart = lie_apart();
        (0..view.contacts.len()).any(|contact| {
            let touches = phases[contact] != Phase::Apart || lie_apart.contains(&contact);
            let can_hold = view.system().friction(contact).limit > 0.0;
            can_hold && touches && view.speed(state, contact).abs() > STILL
        })
    };
    let mut velocities = graph.layout.velocities.iter().flatten();
    if !velocities.all(|velocity| is_slow(&state[*velocity]))
        || !graph.gaps.is_empty()
        || view.rest_forms().is_some() && graph.determines_all_forces()
        || !evaluator.rates(phases, state).iter().all(is_slow)
        || slides()
    {
        return None;
    }
    let velocities: Vec<usize> = graph.layout.velocities.iter().flatten().copied().collect();
    let effects = ContactEffects::of(view, phases, state);
    let still = |place: usize| velocities.contains(&place) || is_slow(&effects.pushed[place]);
    let acts = |velocity: &usize| effects.forces.iter().any(|force| force[*velocity] != 0.0);
    if !(0..graph.derivative.len()).all(still) || !velocities.iter().all(acts) {
        return None;
    }
    let (balance, rank) = effects.balance(&velocities)?;
    let presses = effects.reserve(&balance, 1.0) > RESERVE * balance.some.amax().min(1.0);
    if rank < velocities.len() || !presses {
        return None;
    }
    let strength = effects.strength(&balance, 1.0)?;
    (strength < 1.0 - RESERVE).then_some(1.0 - strength)
}

/// Returns the least part of its friction that a contact that sticks has in reserve, for the best forces of the contacts; `None` if no
/// contact sticks. Other bodies may move.
pub(super) fn friction_margin(view: &SystemView, phases: &[Phase], state: &[f64]) -> Option<f64> {
    let effects = ContactEffects::of(view, &at_rest(view, phases, state), state);
    effects.supports.iter().find(|support| support.friction.is_some())?;
    let velocities = view.evaluator.graph().layout.velocities.iter().flatten();
    let acts = |velocity: &usize| effects.forces.iter().any(|force| force[*velocity] != 0.0);
    let balance = effects.balance(&velocities.copied().filter(acts).collect::<Vec<_>>());
    let strength = balance.and_then(|(balance, _)| effects.strength(&balance, f64::INFINITY));
    Some(strength.map_or(f64::NEG_INFINITY, |strength| 1.0 - strength))
}

impl ContactEffects {
    /// Returns the effects of contacts in a state: of those that stick, of those that slip, if their normal forces are reactions, and
    /// of bodies that touch without a force.
    fn of(view: &SystemView, phases: &[Phase], state: &[f64]) -> Self {
        let evaluator = &view.evaluator;
        let openings = &evaluator.graph().openings;
        let opening =
            |contact: usize| openings.iter().position(|opening| opening.contact == contact);
        let slides = |contact: usize| {
            matches!(phases[contact], Phase::Slip(_)) && view.speed(state, contact).abs() > RESTS
        };
        let without = |contact: usize| match opening(contact) {
            Some(_) => Phase::Apart,
            None if slides(contact) => phases[contact],
            None => Phase::Free,
        };
        let contacts = 0..view.contacts.len();
        let without: Phases =
            contacts.clone().map(without).chain(phases[contacts.end..].iter().copied()).collect();
        let rates = |phases: &[Phase]| DVector::from_row_slice(&evaluator.rates(phases, state));
        let gaps = evaluator.openings(|component| state[component]);
        let places: Vec<ImpactPlace> = (0..gaps.len()).map(ImpactPlace::Opening).collect();
        let responses = evaluator.responses(state, &places);
        let found = evaluator.forces(phases, state);
        let mut all =
            ContactEffects { pushed: rates(&without), forces: Vec::new(), supports: Vec::new() };
        for contact in contacts {
            let limit = view.system().friction(contact).limit;
            let support = match opening(contact) {
                Some(place) if phases[contact] == Phase::Apart && !lies(&gaps[place]) => continue,
                Some(place) => {
                    let [across, along] = [0, 1]
                        .map(|way| DVector::from_row_slice(&responses[2 * place + way].components));
                    if slides(contact) {
                        // Its friction is in proportion to its normal force.
                        let factor = match found[contact].friction / found[contact].normal {
                            factor if factor.is_finite() => factor,
                            _ => 0.0,
                        };
                        Support { normal: Ok(all.add(across + along * factor)), friction: None }
                    } else {
                        let normal = Ok(all.add(across));
                        let friction = (limit > 0.0).then(|| (all.add(along), limit));
                        Support { normal, friction }
                    }
                }
                None if slides(contact) || limit == 0.0 => continue,
                None => {
                    let [forward, backward] =
                        [Direction::Forward, Direction::Backward].map(|direction| {
                            let mut phases = without.clone();
                            phases[contact] = Phase::Transition(direction);
                            (rates(&phases), evaluator.forces(&phases, state)[contact].friction)
                        });
                    let along = (forward.0 - backward.0) / (forward.1 - backward.1);
                    let normal = Err(found[contact].normal);
                    Support { normal, friction: Some((all.add(along), limit)) }
                }
            };
            all.supports.push(support);
        }
        all
    }

    fn add(&mut self, force: DVector<f64>) -> usize {
        self.forces.push(force);
        self.forces.len() - 1
    }

    /// Returns forces that balance what pushes these velocities, the combinations of forces without an effect, one in each column, and
    /// the number of independent forces; `None` if no forces balance it.
    fn balance(&self, velocities: &[usize]) -> Option<(BalancingForces, usize)> {
        let (rows, count) = (velocities.len(), self.forces.len());
        let are_finite =
            self.forces.iter().chain([&self.pushed]).flatten().all(|of| of.is_finite());
        if count == 0 || !are_finite {
            return None;
        }
        let effect = |row: usize, column: usize| {
            velocities.get(row).map_or(0.0, |velocity| self.forces[column][*velocity])
        };
        let scale =
            |row: usize| (0..count).map(|column| effect(row, column).abs()).fold(0.0, f64::max);
        // Zero rows make the matrix as high as wide, so that its decomposition has all directions.
        let scales: Vec<f64> = (0..rows.max(count)).map(scale).collect();
        let scaled = |row: usize, value: f64| if row < rows { value / scales[row] } else { 0.0 };
        let matrix = DMatrix::from_fn(rows.max(count), count, |row, column| {
            scaled(row, effect(row, column))
        });
        let right = DVector::from_fn(rows.max(count), |row, _| {
            scaled(row, velocities.get(row).map_or(0.0, |velocity| -self.pushed[*velocity]))
        });
        let decomposed = SVD::try_new(matrix.clone(), true, true, f64::EPSILON, 10_000)?;
        let zero = DEPENDENT * decomposed.singular_values.max();
        let some = decomposed.solve(&right, zero).ok()?;
        let is_balanced = (&matrix * &some - &right).amax() <= BALANCED * (1.0 + right.amax());
        let directions = decomposed.v_t.as_ref()?;
        let values = decomposed.singular_values.iter().enumerate();
        let without_effect: Vec<DVector<f64>> = values
            .filter(|(_, value)| **value <= zero)
            .map(|(direction, _)| directions.row(direction).transpose())
            .collect();
        let rank = count - without_effect.len();
        let without_effect = match without_effect[..] {
            [] => DMatrix::zeros(count, 0),
            _ => DMatrix::from_columns(&without_effect),
        };
        is_balanced.then_some((BalancingForces { some, without_effect }, rank))
    }

    /// Returns the smallest factor on the coefficients of friction with which forces hold the bodies, up to `most`.
    fn strength(&self, balance: &BalancingForces, most: f64) -> Option<f64> {
        least_strength(most.min(MOST_STRENGTH), |strength| self.reserve(balance, strength) >= 0.0)
    }

    /// Returns the largest reserve of the contacts with friction of a strength, up to 1.
    fn reserve(
        &self,
        BalancingForces { some, without_effect }: &BalancingForces,
        strength: f64,
    ) -> f64 {
        let combinations = without_effect.ncols();
        // A force as its value and the coefficients of the combinations.
        let force = |place: usize| -> Vec<f64> {
            std::iter::once(some[place]).chain(without_effect.row(place).iter().copied()).collect()
        };
        let mut rows = Vec::new();
        // The sum of two forces with factors is at least the reserve.
        let mut at_least = |normal: &[f64], factor: f64, friction: &[f64], sign: f64| {
            let sum = |place: usize| factor * normal[place] + sign * friction[place];
            rows.push(((1..=combinations).map(|place| -sum(place)).collect::<Vec<f64>>(), sum(0)));
        };
        for Support { normal, friction } in &self.supports {
            let none = vec![0.0; combinations + 1];
            let normal = match normal {
                Ok(place) => {
                    let normal = force(*place);
                    at_least(&normal, 1.0, &none, 1.0);
                    normal
                }
                Err(known) => {
                    let mut known_force = none.clone();
                    known_force[0] = *known;
                    known_force
                }
            };
            if let Some((place, limit)) = friction {
                for sign in [1.0, -1.0] {
                    at_least(&normal, strength * limit, &force(*place), sign);
                }
            }
        }
        largest_reserve(&rows, 1.0)
    }
}

/// Forces that balance, and the combinations of forces without an effect, one in each column.
struct BalancingForces {
    some: DVector<f64>,
    without_effect: DMatrix<f64>,
}
