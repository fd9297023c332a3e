//! The joint decision for several contacts: it finds one phase for each contact, so that every phase meets its condition. The
//! method of the motion defines the conditions. The forces and rates of a system in one state for assumed phases are those that
//! such decisions need.

use smallvec::SmallVec;

use super::evaluator::{ContactForces, Forces};
use super::{Direction, Evaluator, Failure, Phase, Phases};
use crate::model::{Components, Dual};

/// A system in one state, for which the phases of its contacts are decided.
pub(super) trait ForceModel {
    /// Returns the static coefficient of friction of a contact.
    fn limit(&self, contact: usize) -> f64;
    /// Returns the sliding speed of a contact.
    fn speed(&self, contact: usize) -> f64;
    /// Returns the forces for assumed phases.
    fn forces(&self, phases: &[Phase]) -> Forces;
    /// Returns the time derivative of the state for assumed phases.
    fn rates(&self, phases: &[Phase]) -> Components;
    /// Returns the forces at the time [`AHEAD`] later, to first order, if the phases last.
    fn forces_ahead(&self, phases: &[Phase]) -> Forces;
    /// Returns the change of the sliding speed of a contact along a direction.
    fn speed_along(&self, contact: usize, direction: &[f64]) -> f64;
    /// Returns the forces with their changes along a direction.
    fn forces_along(&self, phases: &[Phase], direction: &[f64]) -> Forces<Dual>;
    /// Returns whether the phases are decided in exactly one way for any forces.
    fn has_one_solution(&self) -> bool;
    /// Returns the size of the forces, to which rounding errors are relative.
    fn force_scale(&self) -> f64;
}

/// Time interval for the rate of change of a condition, non-dimensional.
pub(super) const AHEAD: f64 = 1e-6;

/// A system in one state, by its recorded equations.
pub(super) struct RecordedForces<'a> {
    evaluator: &'a Evaluator,
    state: &'a [f64],
    speeds: SmallVec<[f64; 8]>,
}

impl<'a> RecordedForces<'a> {
    pub(super) fn new(evaluator: &'a Evaluator, state: &'a [f64]) -> Self {
        RecordedForces { evaluator, state, speeds: evaluator.speeds(state) }
    }
}

impl ForceModel for RecordedForces<'_> {
    fn limit(&self, contact: usize) -> f64 {
        self.evaluator.system().friction(contact).limit
    }

    fn speed(&self, contact: usize) -> f64 {
        self.speeds[contact]
    }

    fn forces(&self, phases: &[Phase]) -> Forces {
        self.evaluator.forces(phases, self.state)
    }

    fn rates(&self, phases: &[Phase]) -> Components {
        self.evaluator.rates(phases, self.state)
    }

    fn forces_ahead(&self, phases: &[Phase]) -> Forces {
        let rates = self.rates(phases);
        let ahead = self.state.iter().zip(&rates).map(|(value, rate)| value + AHEAD * rate);
        self.evaluator.forces(phases, &ahead.collect::<Components>())
    }

    fn speed_along(&self, contact: usize, direction: &[f64]) -> f64 {
        match self.evaluator.graph().speed_component(contact) {
            Some(component) => direction[component],
            // Sliding speeds do not depend on phases.
            None => {
                let phases = self.evaluator.no_phases();
                self.forces_along(&phases, direction)[contact].speed.slope
            }
        }
    }

    fn forces_along(&self, phases: &[Phase], direction: &[f64]) -> Forces<Dual> {
        self.evaluator.forces_along(phases, self.state, direction)
    }

    fn has_one_solution(&self) -> bool {
        let system = self.evaluator.system();
        system.surely_one_solution() || system.one_solution_at(self.state)
    }

    fn force_scale(&self) -> f64 {
        self.evaluator.system().force_scale()
    }
}

/// Which contacts' phases are open.
pub(super) type Open = SmallVec<[bool; 8]>;

/// Decides the phases of the open contacts so that all conditions hold, in one state.
///
/// Returns what `then` returns for the corresponding forces; the other contacts are unchanged. `better` returns the
/// phase that a contact should have instead if the assumed one fails its condition.
///
/// The conditions are a linear complementarity problem. For light balls its matrix is nearly
/// diagonal; exchanging all failing phases simultaneously then solves it in one or two iterations.
/// If this does not converge, all `3^k` combinations of `choices` are tried. If the balls are so
/// heavy and the friction so large that several solutions may exist, all of them are computed, and
/// none is chosen silently ([`crate::model::ExistenceVerdict`]).
///
/// # Errors
/// [`Failure::NoSolution`] if no combination meets all conditions, or if several different ones do, and the errors of
/// `then`.
pub(super) fn resolve_modes<R>(
    system: &dyn ForceModel,
    phases: &mut Phases,
    open: &Open,
    choices: [Phase; 3],
    better: impl Fn(&Forces, &[Phase], usize) -> Option<Phase>,
    then: impl FnOnce(&Forces) -> Result<R, Failure>,
) -> Result<R, Failure> {
    if !system.has_one_solution() {
        return then(&unique_or_refused(system, phases, open, choices, better)?);
    }
    let contacts = || (0..open.len()).filter(|&contact| open[contact]);
    for _ in 0..phases.len() + 3 {
        let forces = system.forces(phases);
        let mut exchanged = phases.clone();
        for contact in contacts() {
            if let Some(phase) = better(&forces, phases, contact) {
                exchanged[contact] = phase;
            }
        }
        if exchanged == *phases {
            return then(&forces);
        }
        *phases = exchanged;
    }
    for candidate in combinations(&phases.clone(), open, choices)? {
        let forces = system.forces(&candidate);
        if contacts().all(|contact| better(&forces, &candidate, contact).is_none()) {
            *phases = candidate;
            return then(&forces);
        }
    }
    Err(Failure::NoSolution { solutions: 0 })
}

/// The largest number of open contacts for which all combinations are tried.
const MOST_OPEN: usize = 12;

/// Returns all combinations of choices for the open contacts, with the given phases of the others.
fn combinations(
    given: &Phases,
    open: &Open,
    choices: [Phase; 3],
) -> Result<impl Iterator<Item = Phases>, Failure> {
    let contacts = open.iter().filter(|open| **open).count();
    if contacts > MOST_OPEN {
        return Err(Failure::TooManyCombinations);
    }
    let combination = move |mut combination: usize| {
        let phase = |(open, given): (&bool, &Phase)| {
            if !open {
                return *given;
            }
            let choice = choices[combination % 3];
            combination /= 3;
            choice
        };
        open.iter().zip(given).map(phase).collect()
    };
    Ok((0..3_usize.pow(contacts as u32)).map(combination))
}

/// Accelerations that differ by no more than this, over 1 and the largest of them, are the same
/// motion: on the boundary between stick and transition both hold, to rounding or to the slack.
const SAME: f64 = 1e-6;

/// Decides the phases like [`resolve_modes`], by trying all `3^k` combinations of
/// the open contacts. The current phases are preferred if they are among the solutions.
fn unique_or_refused(
    system: &dyn ForceModel,
    phases: &mut Phases,
    open: &Open,
    choices: [Phase; 3],
    better: impl Fn(&Forces, &[Phase], usize) -> Option<Phase>,
) -> Result<Forces, Failure> {
    let given = phases.clone();
    let all = combinations(&given, open, choices)?;
    let others = all.filter(|other| *other != given);
    let all = std::iter::once(given.clone()).chain(others);
    let (decided, forces) = only_motion(all, |candidate| {
        let forces = system.forces(candidate);
        let fits = |contact: usize| !open[contact] || better(&forces, candidate, contact).is_none();
        let fit = !forces.iter().all(is_finite) || (0..candidate.len()).all(fits);
        fit.then_some(forces)
    })?;
    *phases = decided;
    Ok(forces)
}

/// Returns the only motion among combinations of phases, with its forces. Of combinations with the same motion, the first one is
/// preferred. `fitting` returns the forces of a combination if it meets all conditions, or
/// if its forces are not finite.
///
/// # Errors
/// [`Failure::NoSolution`] unless all combinations that meet the conditions, with every contact closed, have the same
/// accelerations. If all of them need a normal force that pulls, the first of them is returned: contact is lost.
pub(super) fn only_motion(
    candidates: impl Iterator<Item = Phases>,
    mut fitting: impl FnMut(&Phases) -> Option<Forces>,
) -> Result<(Phases, Forces), Failure> {
    let mut solutions: Vec<(Phases, Forces)> = Vec::new();
    let mut unsound = None;
    for candidate in candidates {
        let Some(forces) = fitting(&candidate) else { continue };
        if forces.iter().any(|contact| !is_finite(contact) || contact.normal <= 0.0) {
            unsound.get_or_insert((candidate, forces));
        } else if !solutions.iter().any(|(_, other)| same(other, &forces)) {
            solutions.push((candidate, forces));
        }
    }
    match (solutions.len(), unsound) {
        (1, _) => Ok(solutions.swap_remove(0)),
        (0, Some(unsound)) => Ok(unsound),
        (several, _) => Err(Failure::NoSolution { solutions: several }),
    }
}

/// Returns whether two solutions are the same motion.
fn same(left: &Forces, right: &Forces) -> bool {
    let pairs = || left.iter().zip(right).map(|(a, b)| (a.acceleration, b.acceleration));
    let scale = pairs().fold(1.0, |most: f64, (a, b)| most.max(a.abs()).max(b.abs()));
    pairs().all(|(a, b)| (a - b).abs() <= SAME * scale)
}

pub(super) fn is_finite(contact: &ContactForces) -> bool {
    contact.acceleration.is_finite() && contact.normal.is_finite()
}

/// The largest acceleration of bodies that do not move, over 1 and the largest acceleration.
pub(super) const AGREE: f64 = 1e-6;

/// Returns the remaining friction of a sticking contact, `μ_s f_n - |f_w|`; none where it accelerates all the same. Where equations are
/// dependent, no force holds a contact whose sliding speed vanishes with its factor, as that of a piston at its dead centre.
pub(super) fn stick_reserve(system: &dyn ForceModel, forces: &Forces, contact: usize) -> f64 {
    let ContactForces { normal, friction, acceleration, speed } = forces[contact];
    let excess = acceleration.abs() - speed.abs();
    // Nearly always, a contact that sticks does not accelerate at all.
    if excess > AGREE && excess > AGREE * largest_acceleration(forces) {
        return f64::NEG_INFINITY;
    }
    system.limit(contact) * normal - friction.abs()
}

#[cold]
fn largest_acceleration(forces: &Forces) -> f64 {
    forces.iter().fold(0.0, |most: f64, of| most.max(of.acceleration.abs()))
}

/// Returns the direction in which a contact sets off that does not stick with these forces.
pub(super) fn sets_off(system: &dyn ForceModel, forces: &Forces, contact: usize) -> Direction {
    let ContactForces { normal, friction, acceleration, .. } = forces[contact];
    let is_overcome = friction.abs() >= system.limit(contact) * normal;
    Direction::of(if is_overcome { friction } else { acceleration })
}

/// Returns an error for forces that are not finite and for normal forces that pull.
pub(super) fn check_forces(forces: &Forces) -> Result<(), Failure> {
    if !forces.iter().all(is_finite) {
        return Err(Failure::NotFinite);
    }
    match forces.iter().position(|contact| contact.normal <= 0.0) {
        Some(contact) => Err(Failure::ContactLost { ball: contact + 1 }),
        None => Ok(()),
    }
}
