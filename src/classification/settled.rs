//! Settled motion: convergence to a stable equilibrium at which some contact slips, has no dry friction, or is open, or to a steady
//! motion, in which a translation that no equation notices goes on at a constant speed.
//!
//! If friction cannot hold a body (viscous drag, a smooth law), a run approaches its equilibrium
//! asymptotically; so does a block that slides on a belt at a constant position, or a wheel that rolls at a constant speed. Other contacts
//! may hold bodies there. Such a run has settled if
//!
//! - everything but the translations is slow, and Newton's method finds an equilibrium, a state whose rates of change vanish but
//!   for the translations, within [`NEAR`];
//! - all eigenvalues of the equations linearised there lie left of the
//!   imaginary axis, except for the zeros of a family of equilibria, as of three or more balls that
//!   can balance in many positions: one zero for each independent displacement of bodies without
//!   any force, and for each change of speeds that nothing notices;
//! - friction holds there each contact that sticks, with a reserve.
//!
//! Bodies that touch move together and are one body here; the forces between them must press.

use nalgebra::{Complex, DMatrix, DVector, SVD, Schur};

use super::held_bodies::{friction_margin, held_margin};
use super::rest_in_touch::at_rest;
use super::system_view::SystemView;
use crate::model::{Components, Translations};
use crate::motion::{Phase, ReducedEquations, lies};

/// Largest component of the time derivative, non-dimensional, at which the motion is examined.
pub(super) const SLOW: f64 = 1e-6;
/// The time of the next examination, over the present one, of a motion whose speed is not yet that of the steady motion near it.
const SOON: f64 = 1.1;
/// Largest distance of the equilibrium, non-dimensional.
const NEAR: f64 = 1e-3;
/// Largest size of Newton's last step, non-dimensional.
const THERE: f64 = 1e-6;
/// Eigenvalues with a real part of at most this modulus count as zero.
const NEUTRAL: f64 = 1e-9;
/// Threshold for a family of equilibria: the ratio of the force change by a combined displacement
/// to that by one body alone counts as zero below it; also the least non-dimensional force change
/// by one body that counts.
const NO_FORCE: f64 = 1e-6;
const LEAST_FORCE: f64 = 1e-5;
/// Contacts that slide at most this fast at an equilibrium stop there.
const STOPS: f64 = 1e-9;
/// A combined change of speeds that changes rates by at most this is not noticed, as the common speed of discs without drag.
const UNNOTICED: f64 = 1e-12;
/// A contact that slides at an equilibrium is at least this fast, so that it will not stick. An open contact is at least this wide.
const SLIDES: f64 = 1e-3;
/// At an equilibrium, each contact that sticks has at least this part of its friction in reserve.
const RESERVE: f64 = 1e-6;

/// How a motion is at rest.
pub(super) enum RestKind {
    /// It has settled at this equilibrium.
    Settled(Box<Components>),
    /// Contacts hold all bodies.
    Held,
}

/// Schedules the examinations so that their cost stays bounded: each waits for half of the time
/// elapsed, or for the end of the run.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SettledWatch {
    next: f64,
    /// The time since which everything is slow, if it is.
    pub(super) slow_since: Option<f64>,
}

impl SettledWatch {
    /// Returns how a motion is at rest in a state that lasts until `end`, if it is; after most steps
    /// nothing is examined. If everything is slow, it is so since `since` at the latest.
    pub(super) fn look(
        &mut self,
        view: &SystemView,
        (phases, state): (&[Phase], &[f64]),
        [since, time, end]: [f64; 3],
    ) -> Option<RestKind> {
        if !may_settle(view, phases, state) {
            self.slow_since = None;
            return held_margin(view, phases, state).map(|_| RestKind::Held);
        }
        let rates = view.remaining_rates(phases, state);
        if !rates.iter().all(|rate| rate.abs() <= SLOW) {
            self.slow_since = None;
            return None;
        }
        self.slow_since.get_or_insert(since);
        if time < self.next.min(end) {
            return None;
        }
        self.next = 1.5 * time;
        let place = equilibrium(view, &at_rest(view, phases, state), state, RESERVE)?;
        // A body that rolls out still has a way to go.
        let there = view.evaluator.rates(phases, &place);
        let here = view.evaluator.rates(phases, state);
        if here.iter().zip(&there).any(|(here, there)| (here - there).abs() > 2.0 * SLOW) {
            self.slow_since = None;
            self.next = SOON * time;
            return None;
        }
        Some(RestKind::Settled(Box::new(place)))
    }
}

/// Returns whether every contact sticks, slides without dry friction or far from stopping, or is far from closing. Where all
/// contacts stick, other evidence decides, unless bodies may roll on and on.
fn may_settle(view: &SystemView, phases: &[Phase], state: &[f64]) -> bool {
    let resting = at_rest(view, phases, state);
    let gaps = view.evaluator.openings(|component| state[component]);
    let touches = |contact: usize| {
        let mut openings = view.evaluator.graph().openings.iter().zip(&gaps);
        openings.any(|(opening, at)| opening.contact == contact && lies(at))
    };
    let sticks = |phase: &Phase| *phase == Phase::Stick;
    let lasts = |(contact, phase): (usize, &Phase)| match phase {
        Phase::Free => true,
        Phase::Slip(_) => view.speed(state, contact).abs() > SLIDES,
        Phase::Stick => {
            view.evaluator.graph().holds_position(contact)
                || view.translations.has_pivot(view.contacts[contact].position)
        }
        // The equations show the gap of an open contact as its normal force.
        Phase::Apart => {
            touches(contact) || view.evaluator.forces(&resting, state)[contact].normal > SLIDES
        }
        Phase::Transition(_) => false,
        Phase::Open | Phase::Closed => true,
    };
    let contacts = &resting[..view.contacts.len()];
    let all_stick = contacts.iter().all(sticks) && contacts.iter().any(sticks);
    let may_roll = || {
        let rolls = view.translations.pivots().any(|pivot| view.free.contains(&pivot));
        rolls || view.translations != Translations::default() && view.rest_forms().is_none()
    };
    (!all_stick || may_roll()) && resting.iter().enumerate().all(lasts)
}

/// Returns whether the forces between contacts that touch press, and friction holds the contacts that stick with more than a reserve.
fn is_held(view: &SystemView, phases: &[Phase], state: &[f64], reserve: f64) -> bool {
    let margin = friction_margin(view, phases, state);
    if margin.is_some_and(|margin| margin.is_nan() || margin <= reserve) {
        return false;
    }
    let (_, gaps) = view.evaluator.incremental_forces(state).forces_and_gaps(phases);
    let closed = phases[view.contacts.len()..].iter().zip(&gaps);
    closed.filter(|(phase, _)| **phase == Phase::Closed).all(|(_, gap)| gap.force > 0.0)
}

/// Returns whether a state in which contacts slide ever more slowly approaches an equilibrium at which they stop: friction is just able
/// to hold them there.
pub(super) fn approaches_edge(view: &SystemView, phases: &[Phase], state: &[f64]) -> bool {
    let stop = |place: Components| {
        (0..view.contacts.len()).all(|contact| view.speed(&place, contact).abs() <= STOPS)
    };
    equilibrium(view, phases, state, -RESERVE).is_some_and(stop)
}

/// Returns the stable equilibrium near a state at which friction holds contacts with more than a reserve; `None` without one, or if
/// that cannot be computed.
fn equilibrium(
    view: &SystemView,
    phases: &[Phase],
    state: &[f64],
    reserve: f64,
) -> Option<Components> {
    let reduced = ReducedEquations::new(&view.evaluator, phases, &view.translations);
    if reduced.variables.is_empty() {
        return is_held(view, phases, state, reserve).then(|| Components::from(state));
    }
    let slopes = |place: &[f64]| {
        let slopes = Some(reduced.slopes(place));
        let slopes = slopes.filter(|slopes| slopes.iter().all(|entry| entry.is_finite()))?;
        let family = family_dimension(view, &reduced.variables, &slopes)?;
        Some((slopes, family))
    };
    // Differences of large coordinates lose digits: the pivots of translations are 0 here.
    let mut place: Components = reduced.translations.all_remaining(state);
    let carried: Components = state.iter().zip(&place).map(|(at, left)| at - left).collect();
    let (mut moved, mut last) = (DVector::zeros(reduced.variables.len()), f64::INFINITY);
    for _ in 0..5 {
        let (slopes, family) = slopes(&place)?;
        let step = newton_step(slopes, -reduced.rates(&place), family.iter().sum())?;
        last = step.amax();
        reduced.displace(&mut place, &step);
        moved += step;
        let is_near = moved.amax() <= NEAR;
        if !is_near {
            return None;
        }
    }
    let (slopes, [of_places, of_speeds]) = slopes(&place)?;
    let family = of_places + of_speeds;
    // Nothing corrects a speed that nothing notices.
    let vanishes = if of_speeds == 0 { 1e-3 * SLOW } else { UNNOTICED };
    let is_there = reduced.rates(&place).amax() <= vanishes && last <= THERE;
    if !is_there || !is_held(view, phases, &place, reserve) {
        return None;
    }
    // A steep law makes eigenvalues so large that their rounding errors hide the sign of a small one. The sign of the
    // determinant tells whether their number right of the imaginary axis is odd.
    let is_odd = slopes.nrows() % 2 == 1;
    if family == 0 && (slopes.determinant() < 0.0) != is_odd {
        return None;
    }
    let eigenvalues = Schur::try_new(slopes, f64::EPSILON, 10_000)?.complex_eigenvalues();
    let stay: Vec<_> = eigenvalues.iter().filter(|value| value.re >= -NEUTRAL).collect();
    let is_zero = |value: &Complex<f64>| value.norm() <= NEUTRAL.sqrt() && value.re <= NEUTRAL;
    let is_stable = stay.len() <= family && stay.into_iter().all(is_zero);
    is_stable.then(|| place.iter().zip(&carried).map(|(left, carried)| left + carried).collect())
}

/// Returns Newton's step; for a singular matrix of a family of equilibria, the shortest one.
fn newton_step(
    mut slope: DMatrix<f64>,
    residual: DVector<f64>,
    family: usize,
) -> Option<DVector<f64>> {
    // A stiff law makes some columns much longer than others.
    let scale: Vec<f64> = slope.column_iter().map(|column| 1.0 / column.amax().max(1.0)).collect();
    for (mut column, scale) in slope.column_iter_mut().zip(&scale) {
        column *= *scale;
    }
    let decomposed = SVD::try_new(slope, true, true, f64::EPSILON, 10_000)?;
    let values = &decomposed.singular_values;
    let left_out = if family == 0 { 0.0 } else { *values.get(values.len() - family)? };
    let mut step = decomposed.solve(&residual, left_out).ok()?;
    step.iter_mut().zip(&scale).for_each(|(step, scale)| *step *= scale);
    Some(step)
}

/// Returns the number of independent displacements of bodies without any force, and of changes of speeds that no force and no other
/// rate notices; `None` if the displacement of some body hardly changes the forces.
fn family_dimension(
    view: &SystemView,
    variables: &[usize],
    slopes: &DMatrix<f64>,
) -> Option<[usize; 2]> {
    let velocities = &view.evaluator.graph().layout.velocities;
    let is_position =
        |column: &usize| !velocities.iter().any(|group| group.contains(&variables[*column]));
    let (places, speeds): (Vec<usize>, Vec<usize>) = (0..variables.len()).partition(is_position);
    let columns: Option<Vec<DVector<f64>>> = (places.iter())
        .map(|place| slopes.column(*place).into_owned().try_normalize(LEAST_FORCE))
        .collect();
    let speeds = speeds.iter().map(|place| slopes.column(*place).into_owned()).collect();
    Some([dependent(columns?, NO_FORCE)?, dependent(speeds, UNNOTICED)?])
}

/// Returns the number of singular values of columns up to a limit; `None` if they cannot be computed.
fn dependent(columns: Vec<DVector<f64>>, limit: f64) -> Option<usize> {
    if columns.is_empty() {
        return Some(0);
    }
    let columns = DMatrix::from_columns(&columns);
    let decomposed = SVD::try_new(columns, false, false, f64::EPSILON, 10_000)?;
    Some(decomposed.singular_values.iter().filter(|value| **value <= limit).count())
}
