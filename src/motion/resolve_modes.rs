//! Which contacts stick and which slip: the modes of all contacts, resolved together.
//!
//! Where stick and slip may have several solutions, or none, all combinations are tried, and a motion continues
//! only if all combinations that meet the conditions give the same accelerations.

use super::Failure;
use super::contact::{Phase, forces};
use crate::model::{Forces, State, System};

/// Decides the phases of the `open` contacts jointly (thesis section 4.3, appendix C) and returns
/// the corresponding forces; the other contacts are unchanged. `better` returns the phase that a
/// contact should have instead if the assumed one fails its condition.
///
/// The conditions are a linear complementarity problem. For light balls its matrix is nearly
/// diagonal; exchanging all failing phases simultaneously then solves it in one or two iterations.
/// If this does not converge, all `3^k` combinations of `choices` are tried. If the balls are so
/// heavy and the friction so large that several solutions may exist, all of them are computed, and
/// none is chosen silently ([`crate::model::ExistenceVerdict`]).
///
/// # Errors
/// [`Failure::NoSolution`] if no combination meets all conditions, or if several different ones do.
pub(super) fn resolve_modes<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    state: &State<N, f64, FREE>,
    phases: &mut [Phase; N],
    open: [bool; N],
    choices: [Phase; 3],
    better: impl Fn(&Forces<N, f64, FREE>, &[Phase; N], usize) -> Option<Phase>,
) -> Result<Forces<N, f64, FREE>, Failure> {
    if !system.surely_one_solution() && !system.one_solution_at(state) {
        return unique_or_refused(system, state, phases, open, choices, better);
    }
    for _ in 0..N + 3 {
        let forces = forces(system, phases, state);
        let before = *phases;
        for ball in (0..N).filter(|&ball| open[ball]) {
            if let Some(other) = better(&forces, &before, ball) {
                phases[ball] = other;
            }
        }
        if *phases == before {
            return Ok(forces);
        }
    }
    let open: Vec<usize> = (0..N).filter(|&ball| open[ball]).collect();
    for combination in 0..3_usize.pow(open.len() as u32) {
        let mut rest = combination;
        for &ball in &open {
            phases[ball] = choices[rest % 3];
            rest /= 3;
        }
        let forces = forces(system, phases, state);
        if open.iter().all(|&ball| better(&forces, phases, ball).is_none()) {
            return Ok(forces);
        }
    }
    Err(Failure::NoSolution { solutions: 0 })
}

/// Accelerations that differ by no more than this, over 1 and the largest of them, are the same
/// motion: on the boundary between stick and transition both hold, to rounding or to the slack.
const SAME: f64 = 1e-6;

/// Decides the phases like [`resolve_modes`], by trying all `3^k` combinations of
/// the open contacts. The current phases are preferred if they are among the solutions.
///
/// # Errors
/// [`Failure::NoSolution`] unless all combinations that meet the conditions, with every ball
/// pressed to the ring, have the same accelerations. If all of them need a normal force that pulls,
/// they are returned unchanged: contact is lost.
pub(super) fn unique_or_refused<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    state: &State<N, f64, FREE>,
    phases: &mut [Phase; N],
    open: [bool; N],
    choices: [Phase; 3],
    better: impl Fn(&Forces<N, f64, FREE>, &[Phase; N], usize) -> Option<Phase>,
) -> Result<Forces<N, f64, FREE>, Failure> {
    let mut solutions: Vec<([Phase; N], Forces<N, f64, FREE>)> = Vec::new();
    let mut unsound = None;
    for candidate in combinations(phases, open, choices) {
        let forces = forces(system, &candidate, state);
        let finite = forces.beta_ddot.iter().chain(&forces.normal).all(|force| force.is_finite());
        let fits = |ball: usize| !open[ball] || better(&forces, &candidate, ball).is_none();
        if finite && !(0..N).all(fits) {
            continue;
        }
        if !finite || forces.normal.iter().any(|&normal| normal <= 0.0) {
            unsound.get_or_insert((candidate, forces));
        } else if !solutions.iter().any(|(_, other)| same(other, &forces)) {
            solutions.push((candidate, forces));
        }
    }
    let (decided, forces) = match (solutions.as_slice(), unsound) {
        ([solution], _) => *solution,
        ([], Some(unsound)) => unsound,
        (several, _) => return Err(Failure::NoSolution { solutions: several.len() }),
    };
    *phases = decided;
    Ok(forces)
}

/// Returns the current phases, then every combination for the open contacts.
fn combinations<const N: usize>(
    phases: &[Phase; N],
    open: [bool; N],
    choices: [Phase; 3],
) -> impl Iterator<Item = [Phase; N]> {
    let given = *phases;
    let number = open.iter().filter(|open| **open).count();
    let all = (0..3_usize.pow(number as u32)).map(move |mut combination| {
        std::array::from_fn(|ball| {
            if !open[ball] {
                return given[ball];
            }
            let choice = combination % 3;
            combination /= 3;
            choices[choice]
        })
    });
    std::iter::once(given).chain(all)
}

/// Returns whether two solutions are the same motion.
fn same<const N: usize, const FREE: usize>(
    one: &Forces<N, f64, FREE>,
    other: &Forces<N, f64, FREE>,
) -> bool {
    let pairs = || one.beta_ddot.iter().zip(&other.beta_ddot);
    let scale = pairs().fold(1.0, |most: f64, (a, b)| most.max(a.abs()).max(b.abs()));
    pairs().all(|(a, b)| (a - b).abs() <= SAME * scale)
}

/// Returns the number of combinations that meet the conditions as the start of a message.
pub(super) fn combinations_meet(solutions: usize) -> String {
    match solutions {
        0 => "no combination of stick and slip meets".to_owned(),
        1 => "one combination of stick and slip meets".to_owned(),
        _ => format!("{solutions} different combinations of stick and slip meet"),
    }
}
