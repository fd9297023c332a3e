//! The joint decision between stick and slip for several contacts.

use smallvec::SmallVec;

use super::evaluator::{ContactForces, Forces};
use super::{Direction, Evaluator, Failure, Phase, Phases, event_driven, switch_model};
use crate::model::{Components, Dual, Friction, Method};

/// A system in one state, for which the phases of its contacts are decided.
pub(super) trait InState {
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

/// Which contacts' phases are open.
pub(super) type Open = SmallVec<[bool; 8]>;

/// Returns the initial phases, from the friction laws and the sliding speeds alone.
pub(super) fn first_phases<'f>(
    method: Method,
    band: f64,
    contacts: impl Iterator<Item = (&'f Friction, f64)>,
) -> Phases {
    let first = |(friction, speed): (&Friction, f64)| match method {
        _ if !friction.can_stick() => Phase::Free,
        Method::Switch if speed.abs() > band => Phase::Slip(Direction::of(speed)),
        Method::Event if speed != 0.0 => Phase::Slip(Direction::of(speed)),
        _ => Phase::Stick,
    };
    contacts.map(first).collect()
}

/// Decides the phases of contacts at rest, or in the band. In the exact motion, the contacts `fixed` stay at rest.
pub(super) fn decide_at_rest(
    method: Method,
    system: &dyn InState,
    phases: &mut Phases,
    fixed: &[usize],
) -> Result<(), Failure> {
    match method {
        Method::Switch => switch_model::decide(system, phases, check_forces),
        Method::Event => {
            let is_open = |(contact, phase): (usize, &Phase)| {
                *phase == Phase::Stick && !fixed.contains(&contact)
            };
            let at_rest = phases.iter().enumerate().map(is_open).collect();
            event_driven::decide(system, phases, &at_rest, check_forces)
        }
    }
}

/// Decides stick or transition jointly for all contacts in the band of the switch model, in one state, and returns the
/// corresponding forces. Slipping contacts are unchanged.
///
/// # Errors
/// [`Failure::NoSolution`] if no combination meets all conditions, or if several different ones do.
pub fn decide(
    evaluator: &Evaluator,
    state: &[f64],
    phases: &mut Phases,
) -> Result<Forces, Failure> {
    switch_model::decide(&Evaluated::new(evaluator, state), phases, |forces| Ok(forces.clone()))
}

/// A system in one state, by its recorded equations.
pub(super) struct Evaluated<'a> {
    pub(super) evaluator: &'a Evaluator,
    pub(super) state: &'a [f64],
    pub(super) speeds: SmallVec<[f64; 8]>,
}

impl<'a> Evaluated<'a> {
    pub(super) fn new(evaluator: &'a Evaluator, state: &'a [f64]) -> Self {
        Evaluated { evaluator, state, speeds: evaluator.speeds(state) }
    }
}

impl InState for Evaluated<'_> {
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
    system: &dyn InState,
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
    for mut combination in 0..combinations(contacts().count())? {
        for contact in contacts() {
            phases[contact] = choices[combination % 3];
            combination /= 3;
        }
        let forces = system.forces(phases);
        if contacts().all(|contact| better(&forces, phases, contact).is_none()) {
            return then(&forces);
        }
    }
    Err(Failure::NoSolution { solutions: 0 })
}

/// The largest number of open contacts for which all combinations are tried.
const MOST_OPEN: usize = 12;

/// Returns the number of combinations of three phases.
fn combinations(contacts: usize) -> Result<usize, Failure> {
    let tried = contacts <= MOST_OPEN;
    tried.then(|| 3_usize.pow(contacts as u32)).ok_or(Failure::TooManyCombinations)
}

/// Accelerations that differ by no more than this, over 1 and the largest of them, are the same
/// motion: on the boundary between stick and transition both hold, to rounding or to the slack.
const SAME: f64 = 1e-6;

/// Decides the phases like [`resolve_modes`], by trying all `3^k` combinations of
/// the open contacts. The current phases are preferred if they are among the solutions.
fn unique_or_refused(
    system: &dyn InState,
    phases: &mut Phases,
    open: &Open,
    choices: [Phase; 3],
    better: impl Fn(&Forces, &[Phase], usize) -> Option<Phase>,
) -> Result<Forces, Failure> {
    let given = phases.clone();
    let number = open.iter().filter(|open| **open).count();
    let combination = |mut combination: usize| -> Phases {
        let phase = |(open, given): (&bool, &Phase)| {
            if !open {
                return *given;
            }
            let choice = choices[combination % 3];
            combination /= 3;
            choice
        };
        open.iter().zip(&given).map(phase).collect()
    };
    let all = (0..combinations(number)?).map(combination);
    let (decided, forces) = only_motion(&given, all, |candidate| {
        let forces = system.forces(candidate);
        let fits = |contact: usize| !open[contact] || better(&forces, candidate, contact).is_none();
        let fit = !forces.iter().all(is_finite) || (0..candidate.len()).all(fits);
        fit.then_some(forces)
    })?;
    *phases = decided;
    Ok(forces)
}

/// Returns the only motion among combinations of phases, with its forces. The combination `given` is tried first and
/// preferred to others with the same motion. `fitting` returns the forces of a combination if it meets all conditions, or
/// if its forces are not finite.
///
/// # Errors
/// [`Failure::NoSolution`] unless all combinations that meet the conditions, with every contact closed, have the same
/// accelerations. If all of them need a normal force that pulls, the first of them is returned: contact is lost.
pub(super) fn only_motion(
    given: &Phases,
    others: impl Iterator<Item = Phases>,
    mut fitting: impl FnMut(&Phases) -> Option<Forces>,
) -> Result<(Phases, Forces), Failure> {
    let mut solutions: Vec<(Phases, Forces)> = Vec::new();
    let mut unsound = None;
    let others = others.filter(|other| other != given);
    for candidate in std::iter::once(given.clone()).chain(others) {
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
fn same(one: &Forces, other: &Forces) -> bool {
    let pairs = || one.iter().zip(other).map(|(a, b)| (a.acceleration, b.acceleration));
    let scale = pairs().fold(1.0, |most: f64, (a, b)| most.max(a.abs()).max(b.abs()));
    pairs().all(|(a, b)| (a - b).abs() <= SAME * scale)
}

pub(super) fn is_finite(contact: &ContactForces) -> bool {
    contact.acceleration.is_finite() && contact.normal.is_finite()
}

/// Returns the remaining friction of a sticking contact, `μ_s f_n - |f_w|`.
pub(super) fn stick_reserve(system: &dyn InState, forces: &Forces, contact: usize) -> f64 {
    let ContactForces { normal, friction, .. } = forces[contact];
    system.limit(contact) * normal - friction.abs()
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

/// Returns the number of combinations that meet the conditions as the start of a message.
pub(super) fn combinations_meet(of: &str, solutions: usize) -> String {
    match solutions {
        0 => format!("no combination of {of} meets"),
        1 => format!("one combination of {of} meets"),
        _ => format!("{solutions} different combinations of {of} meet"),
    }
}
