//! Bodies at rest that contacts hold in all directions, such as a box on two feet or a ladder at a wall.
//!
//! Such bodies rest if there are forces of the contacts that balance all others: in each contact that may open a normal force
//! `n ≥ 0`, and in each contact a friction force `|t| ≤ μ n` (the static law; R. I. Leine, N. van de Wouw, *Stability and Convergence
//! of Mechanical Systems with Unilateral Constraints*, Springer 2008, doi:10.1007/978-3-540-76975-0). Rigid bodies do not determine
//! these forces. A linear programme finds those with the largest reserve. If the contacts act in all directions and all of them have
//! a reserve, a small further force moves nothing.

use nalgebra::{DMatrix, DVector, SVD};

use super::system_view::SystemView;
use crate::model::{largest_reserve, least_strength};
use crate::motion::{Direction, ImpactPlace, Phase, Phases, lies};

/// The largest component of the time derivative of bodies at rest, non-dimensional: contacts that hold a body more than once yield.
const RESTS: f64 = 1e-9;
/// Each contact has at least this part of its friction in reserve.
const RESERVE: f64 = 1e-6;
/// Singular values below this part of the largest one are zero.
const DEPENDENT: f64 = 1e-9;

/// A contact whose forces are two of the unknown forces, or whose normal force is known.
struct Support {
    /// The place of its normal force among the unknown forces, or the force.
    normal: Result<usize, f64>,
    /// The place of its friction force, and the static coefficient of friction.
    friction: Option<(usize, f64)>,
}

/// Returns the part of its friction that the contact with the least of it has in reserve, for the best forces; `None` if the bodies
/// move, if contacts do not hold them in all directions, or if no forces hold them with a reserve.
pub(super) fn held_margin(view: &SystemView, phases: &[Phase], state: &[f64]) -> Option<f64> {
    let evaluator = &view.evaluator;
    let (graph, system) = (evaluator.graph(), view.system());
    let is_slow = |rate: &f64| rate.abs() <= RESTS;
    if !graph.gaps.is_empty() || !evaluator.rates(phases, state).iter().all(is_slow) {
        return None;
    }
    let opening = |contact: usize| graph.openings.iter().position(|site| site.contact == contact);
    // Without the forces that hold the bodies.
    let contacts = 0..view.contacts.len();
    let free = |contact: usize| if opening(contact).is_some() { Phase::Apart } else { Phase::Free };
    let without: Phases = contacts.clone().map(free).collect();
    let rates = |phases: &[Phase]| DVector::from_row_slice(&evaluator.rates(phases, state));
    let pushed = rates(&without);
    let gaps = evaluator.openings(|component| state[component]);
    let places: Vec<ImpactPlace> = (0..gaps.len()).map(ImpactPlace::Opening).collect();
    let responses = evaluator.responses(state, &places);
    let forces = evaluator.forces(phases, state);
    let mut columns: Vec<DVector<f64>> = Vec::new();
    let mut add = |column: DVector<f64>| {
        columns.push(column);
        columns.len() - 1
    };
    let mut supports = Vec::new();
    for contact in contacts {
        let limit = system.friction(contact).limit;
        let opening = opening(contact);
        if opening.is_some_and(|place| phases[contact] == Phase::Apart && !lies(&gaps[place])) {
            continue;
        }
        if limit > 0.0 && view.speed(state, contact).abs() > RESTS {
            return None;
        }
        let normal = match opening {
            Some(place) => Ok(add(DVector::from_row_slice(&responses[2 * place].components))),
            None => Err(forces[contact].normal),
        };
        let friction = (limit > 0.0).then(|| {
            let column = match opening {
                Some(place) => DVector::from_row_slice(&responses[2 * place + 1].components),
                None => {
                    let [forward, backward] =
                        [Direction::Forward, Direction::Backward].map(|direction| {
                            let mut phases = without.clone();
                            phases[contact] = Phase::Transition(direction);
                            (rates(&phases), evaluator.forces(&phases, state)[contact].friction)
                        });
                    (forward.0 - backward.0) / (forward.1 - backward.1)
                }
            };
            (add(column), limit)
        });
        supports.push(Support { normal, friction });
    }
    let velocities: Vec<usize> = graph.layout.velocities.iter().flatten().copied().collect();
    let (some, rest_of_them) = balancing(&columns, &pushed, &velocities)?;
    let strength = least_strength(1.0, |strength| {
        reserve(&supports, (&some, &rest_of_them), strength) >= 0.0
    })?;
    (strength < 1.0 - RESERVE).then_some(1.0 - strength)
}

/// Returns forces with these effects on the rates that balance what pushes the bodies, and combinations of forces without an effect,
/// one in each column; `None` if no forces balance it, or if the forces do not act on all velocities.
fn balancing(
    columns: &[DVector<f64>],
    pushed: &DVector<f64>,
    velocities: &[usize],
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let (rows, count) = (velocities.len(), columns.len());
    let still =
        |component: usize| velocities.contains(&component) || pushed[component].abs() <= RESTS;
    if count == 0 || !(0..pushed.len()).all(still) {
        return None;
    }
    // Zero rows make the matrix as high as wide, so that its decomposition has all directions.
    let effect = |row: usize, column: usize| {
        velocities.get(row).map_or(0.0, |velocity| columns[column][*velocity])
    };
    let scale = |row: usize| (0..count).map(|column| effect(row, column).abs()).fold(0.0, f64::max);
    let scales: Vec<f64> = (0..rows.max(count)).map(scale).collect();
    if scales[..rows].contains(&0.0) {
        return None;
    }
    let matrix = DMatrix::from_fn(rows.max(count), count, |row, column| match scales[row] {
        0.0 => 0.0,
        scale => effect(row, column) / scale,
    });
    let right = DVector::from_fn(rows.max(count), |row, _| match velocities.get(row) {
        Some(velocity) => -pushed[*velocity] / scales[row],
        None => 0.0,
    });
    let decomposed = SVD::try_new(matrix.clone(), true, true, f64::EPSILON, 10_000)?;
    let zero = DEPENDENT * decomposed.singular_values.max();
    if decomposed.rank(zero) < rows {
        return None;
    }
    let some = decomposed.solve(&right, zero).ok()?;
    let is_balanced = (&matrix * &some - &right).amax() <= RESTS * (1.0 + right.amax());
    let directions = decomposed.v_t?;
    let values = &decomposed.singular_values;
    let without_effect: Vec<DVector<f64>> = (0..count)
        .filter(|direction| values.get(*direction).is_none_or(|value| *value <= zero))
        .map(|direction| directions.row(direction).transpose())
        .collect();
    let without_effect = match without_effect[..] {
        [] => DMatrix::zeros(count, 0),
        _ => DMatrix::from_columns(&without_effect),
    };
    is_balanced.then_some((some, without_effect))
}

/// Returns the largest reserve of the contacts with friction of a strength, up to 1: of the forces `some` with any combination of
/// those without an effect.
fn reserve(
    supports: &[Support],
    (some, without_effect): (&DVector<f64>, &DMatrix<f64>),
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
    for Support { normal, friction } in supports {
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
