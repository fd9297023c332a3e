//! Settled motion: convergence to a stable equilibrium at which some contact slips, has no dry friction, or is open, or to a steady
//! motion, in which a translation that no equation notices goes on at a constant speed.
//!
//! If friction cannot hold a body (viscous drag, a smooth law), a run approaches its equilibrium
//! asymptotically; so does a block that slides on a belt at a constant position, or a wheel that rolls at a constant speed. Other contacts
//! may hold bodies there. Such a run has settled if
//!
//! - everything but the translations is slow, and Newton's method finds an equilibrium, a state whose rates of change vanish but
//!   for the translations, within [`NEAR`];
//! - all eigenvalues of the equations linearised there (central differences) lie left of the
//!   imaginary axis, except for the zeros of a family of equilibria, as of three or more balls that
//!   can balance in many positions: one zero for each independent displacement of bodies without
//!   any force;
//! - friction holds there each contact that sticks, with a reserve.
//!
//! Bodies that touch move together and are one body here; the forces between them must press.

use nalgebra::{Complex, DMatrix, DVector, SVD, Schur};

use super::held_bodies::{friction_margin, held_margin};
use super::rest_in_touch::at_rest;
use super::system_view::SystemView;
use crate::model::{Components, Friction, Translations};
use crate::motion::{Phase, lies};

/// Largest component of the time derivative, non-dimensional, at which the motion is examined.
pub(super) const SLOW: f64 = 1e-6;
/// The time of the next examination, over the present one, of a motion whose speed is not yet that of the steady motion near it.
const SOON: f64 = 1.1;
/// Largest distance of the equilibrium, non-dimensional.
const NEAR: f64 = 1e-3;
/// Largest size of Newton's last step, non-dimensional.
const THERE: f64 = 1e-6;
/// Step of the central differences, non-dimensional.
const DIFFERENCE: f64 = 1e-5;
/// Step of the central differences for a speed, over the speed at which its friction law bends.
const SPEED_DIFFERENCE: f64 = 0.01;
/// Eigenvalues with a real part of at most this modulus count as zero: the accuracy of the
/// differences.
const NEUTRAL: f64 = 1e-9;
/// Threshold for a family of equilibria: the ratio of the force change by a combined displacement
/// to that by one body alone counts as zero below it; also the least non-dimensional force change
/// by one body that the differences resolve.
const NO_FORCE: f64 = 1e-6;
const LEAST_FORCE: f64 = 1e-5;
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
        let place = equilibrium(view, &at_rest(view, phases, state), state)?;
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

/// A system whose contacts keep their phases, with one variable for each independent component of the state.
struct ReducedCoordinates<'a> {
    view: &'a SystemView,
    phases: &'a [Phase],
    /// The components that are the variables.
    variables: Vec<usize>,
    /// The translations that move no contact that sticks. Their pivots are 0.
    translations: Translations,
    /// The components that keep their distance from another one: contacts that touch.
    following: Vec<(usize, usize, f64)>,
    /// The state, with the components that contacts hold.
    held: Vec<f64>,
}

impl<'a> ReducedCoordinates<'a> {
    fn new(view: &'a SystemView, phases: &'a [Phase], state: &[f64]) -> Self {
        let mut following = Vec::new();
        for (follower, leader) in view.followers(phases, None) {
            let (follower, leader) = (view.contacts[follower], view.contacts[leader]);
            let apart = state[follower.position] - state[leader.position];
            following.push((follower.position, leader.position, apart));
            if let (Some(follower), Some(leader)) = (follower.speed, leader.speed) {
                following.push((follower, leader, 0.0));
            }
        }
        let graph = view.evaluator.graph();
        let stuck = (0..view.contacts.len()).filter(|contact| phases[*contact] == Phase::Stick);
        let places =
            |contact: usize| [Some(view.contacts[contact].position), graph.held_component(contact)];
        let held: Vec<usize> = stuck.flat_map(places).flatten().collect();
        let translations = view.translations.without(|place| held.contains(&place));
        let is_free = |place: &usize| {
            let is_following = following.iter().any(|(follower, ..)| follower == place);
            !is_following && !held.contains(place) && !translations.has_pivot(*place)
        };
        let variables = (0..view.dimension()).filter(is_free).collect();
        let held = translations.all_remaining(state);
        ReducedCoordinates { view, phases, variables, translations, following, held }
    }

    /// Returns the variables of a state.
    fn of_state(&self, state: &[f64]) -> DVector<f64> {
        DVector::from_iterator(
            self.variables.len(),
            self.variables
                .iter()
                .map(|place| self.translations.remaining(|place| state[place], *place)),
        )
    }

    /// Returns the state with these variables.
    fn state(&self, variables: &DVector<f64>) -> Vec<f64> {
        let mut state = self.held.clone();
        for (place, value) in self.variables.iter().zip(variables.iter()) {
            state[*place] = *value;
        }
        for (follower, leader, apart) in &self.following {
            state[*follower] = state[*leader] + apart;
        }
        state
    }

    fn rate(&self, variables: &DVector<f64>) -> DVector<f64> {
        self.of_state(&self.view.evaluator.rates(self.phases, &self.state(variables)))
    }

    /// Returns whether the forces between contacts that touch press, and friction holds the contacts that stick.
    fn is_held(&self, variables: &DVector<f64>) -> bool {
        let state = self.state(variables);
        let margin = friction_margin(self.view, self.phases, &state);
        if margin.is_some_and(|margin| margin.is_nan() || margin <= RESERVE) {
            return false;
        }
        let (_, gaps) = self.view.evaluator.incremental_forces(&state).forces_and_gaps(self.phases);
        let closed = self.phases[self.view.contacts.len()..].iter().zip(&gaps);
        closed.filter(|(phase, _)| **phase == Phase::Closed).all(|(_, gap)| gap.force > 0.0)
    }
}

/// Returns the stable equilibrium near a state; `None` without one, or if that cannot be computed.
fn equilibrium(view: &SystemView, phases: &[Phase], state: &[f64]) -> Option<Components> {
    let reduced = ReducedCoordinates::new(view, phases, state);
    let rate = |point: &DVector<f64>| reduced.rate(point);
    let steps = steps(&reduced);
    let start = reduced.of_state(state);
    if start.is_empty() {
        return reduced.is_held(&start).then(|| Components::from(state));
    }
    let (mut equilibrium, mut last) = (start.clone(), f64::INFINITY);
    for _ in 0..5 {
        let slope = jacobian(rate, &equilibrium, &steps)?;
        let family = family_dimension(&reduced, &slope)?;
        let step = newton_step(slope, -rate(&equilibrium), family)?;
        last = step.amax();
        equilibrium += step;
        let is_near = (&equilibrium - &start).amax() <= NEAR;
        if !is_near {
            return None;
        }
    }
    let is_there = rate(&equilibrium).amax() <= 1e-3 * SLOW && last <= THERE;
    if !is_there || !reduced.is_held(&equilibrium) {
        return None;
    }
    let slope = jacobian(rate, &equilibrium, &steps)?;
    let family = family_dimension(&reduced, &slope)?;
    // A steep law makes eigenvalues so large that their rounding errors hide the sign of a small one. The sign of the
    // determinant tells whether their number right of the imaginary axis is odd.
    let is_odd = slope.nrows() % 2 == 1;
    if family == 0 && (slope.determinant() < 0.0) != is_odd {
        return None;
    }
    let eigenvalues = Schur::try_new(slope, f64::EPSILON, 10_000)?.complex_eigenvalues();
    let stay: Vec<_> = eigenvalues.iter().filter(|value| value.re >= -NEUTRAL).collect();
    let is_zero = |value: &Complex<f64>| value.norm() <= NEUTRAL.sqrt() && value.re <= NEUTRAL;
    let is_stable = stay.len() <= family && stay.into_iter().all(is_zero);
    // The pivots keep their places.
    let carried = |component: usize| {
        state[component] - reduced.translations.remaining(|place| state[place], component)
    };
    let place = reduced.state(&equilibrium).into_iter().zip(0..);
    is_stable.then(|| place.map(|(value, component)| value + carried(component)).collect())
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

/// Returns the number of independent displacements of bodies without any force; `None` if the
/// displacement of some body hardly changes the forces, so that differences cannot decide.
fn family_dimension(reduced: &ReducedCoordinates, slope: &DMatrix<f64>) -> Option<usize> {
    let velocities = &reduced.view.evaluator.graph().layout.velocities;
    let is_position = |column: &usize| {
        !velocities.iter().any(|group| group.contains(&reduced.variables[*column]))
    };
    let places = (0..reduced.variables.len()).filter(is_position);
    let columns: Option<Vec<DVector<f64>>> =
        places.map(|place| slope.column(place).into_owned().try_normalize(LEAST_FORCE)).collect();
    let columns = columns?;
    if columns.is_empty() {
        return Some(0);
    }
    let decomposed =
        SVD::try_new(DMatrix::from_columns(&columns), false, false, f64::EPSILON, 10_000)?;
    Some(decomposed.singular_values.iter().filter(|value| **value <= NO_FORCE).count())
}

/// Returns the derivative of the rate by central differences; `None` if it is not finite.
fn jacobian(
    rate: impl Fn(&DVector<f64>) -> DVector<f64>,
    at: &DVector<f64>,
    steps: &[f64],
) -> Option<DMatrix<f64>> {
    let columns: Vec<DVector<f64>> = steps
        .iter()
        .enumerate()
        .map(|(column, step)| {
            let shifted = |step: f64| {
                let mut point = at.clone();
                point[column] += step;
                rate(&point)
            };
            (shifted(*step) - shifted(-step)) / (2.0 * step)
        })
        .collect();
    let slope = DMatrix::from_columns(&columns);
    slope.iter().all(|entry| entry.is_finite()).then_some(slope)
}

/// Steps of the differences, one for each variable.
fn steps(reduced: &ReducedCoordinates) -> Vec<f64> {
    let speed = |friction: &Friction| match friction.speed_scale() {
        Some(scale) => DIFFERENCE.min(SPEED_DIFFERENCE * scale),
        None => DIFFERENCE,
    };
    let step = |place: &usize| {
        let mut contacts = reduced.view.contacts.iter().enumerate();
        let contact = contacts.find(|(_, contact)| contact.speed == Some(*place));
        contact.map_or(DIFFERENCE, |(index, _)| speed(reduced.view.system().friction(index)))
    };
    reduced.variables.iter().map(step).collect()
}
