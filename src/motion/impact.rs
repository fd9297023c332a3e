//! Impacts: contacts that meet in one or more gaps at the same instant.
//!
//! In each gap whose contacts touch, Newton's law and Coulomb's law hold for the impulses (J. J. Moreau, *Unilateral
//! contact and dry friction in finite freedom dynamics*, Springer 1988, doi:10.1007/978-3-7091-2624-0_1): an impulse `P ≥ 0`
//! acts only if the opening speed afterwards is `-e` times that before, which it is never below, and the friction impulse
//! `|Q| ≤ μ_b P` opposes the rolling speed afterwards. The friction of the ring is left out: a ball that sticks gets the
//! speed that the impact gives it, and stops again.
//!
//! With friction, Newton's law can add energy (T. R. Kane, *A dynamics puzzle*, Stanford Mechanics Alumni Club Newsletter 6,
//! 1984), and in several gaps Poisson's law can, too (C. Glocker, Multibody System Dynamics 29 (2013) 77 and 30 (2013) 445,
//! doi:10.1007/s11044-013-9387-2). The same laws with `e = 0` never do: with the mass matrix `M`, their impulses make
//! `v⁺ᵀ M (v⁺ - v⁻)` the work of friction on the speeds afterwards, which is not positive, so that the energy is at most that
//! before. Where Newton's impulses would add energy, the impulses that conserve it take their place, on the line from the
//! impulses with `e = 0` to Newton's (A. Chatterjee, A. Ruina, J. Appl. Mech. 65 (1998) 939, doi:10.1115/1.2791938): less of
//! the speed of approach is restored. The energy is a convex function on this line, so that there is exactly one such
//! point. `P ≥ 0` and `|Q| ≤ μ_b P` hold there, and no gap closes.

use smallvec::{SmallVec, smallvec};

use super::impulses::{Impulses, Meeting, Pairs};
use super::{Evaluator, Failure, Phase};
use crate::model::{Components, Dual, Elementary, Gap, Number, Touching};

/// Rounding tolerance of impulses and speeds, over the largest speed.
const ROUNDING: f64 = 1e-13;

/// Speeds of separation up to this, non-dimensional, cannot be resolved: the width of the gap stays below rounding.
const UNRESOLVED: f64 = 1e-9;

/// What an impact has done.
#[derive(Clone, Debug)]
pub(super) struct Impact {
    /// The state after the impact, with its change along a direction.
    pub(super) state: Vec<Dual>,
    /// The gaps whose contacts stay together.
    pub(super) together: SmallVec<[usize; 8]>,
    /// The gaps that were open and have closed.
    pub(super) hits: SmallVec<[Hit; 2]>,
    /// The contacts that the impulses lift off their support, which the model does not follow.
    pub(super) lifted: usize,
}

/// An impact in a gap that was open.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// The gap.
    pub(crate) gap: usize,
    /// The speed at which it opened just before.
    pub(crate) opening_speed: f64,
}

/// Returns the state after an impact in the gaps `touching`, whose contacts are at each other, with the phases of all gaps
/// before it. `speeds` are the components that are the speeds of the contacts.
///
/// # Errors
/// As [`Meeting::impulses`].
pub(super) fn impact(
    evaluator: &Evaluator,
    system: &dyn Touching,
    speeds: &[usize],
    state: &[Dual],
    touching: &[usize],
    phases: &[Phase],
) -> Result<Impact, Failure> {
    let gaps: SmallVec<[&Gap; 8]> = touching.iter().map(|gap| &system.gaps()[*gap]).collect();
    let fastest = speeds.iter().fold(1.0, |most: f64, speed| most.max(state[*speed].value.abs()));
    let relative = |gap: &Gap, of: &[Dual]| {
        let [behind, ahead] = gap.contacts.map(|contact| of[speeds[contact]]);
        [ahead - behind, ahead + behind]
    };
    let before: Pairs<Dual> = gaps.iter().flat_map(|gap| relative(gap, state)).collect();
    let restitution = before.iter().step_by(2).map(|opening| {
        let lasts = -opening.value < system.lasting_approach() && system.restitution() < 1.0;
        if lasts || opening.value >= 0.0 { 0.0 } else { system.restitution() }
    });
    let responses = evaluator.responses(state, touching);
    let by_each = || responses.iter().flatten();
    let rows = gaps.iter().flat_map(|gap| [0, 1].map(|speed| (gap, speed)));
    let meeting = Meeting {
        restitution: restitution.collect(),
        answers: rows
            .flat_map(|(gap, speed)| by_each().map(move |by| relative(gap, by)[speed]))
            .collect(),
        fastest: before.iter().map(|speed| speed.value.abs()).fold(0.0, f64::max),
        heaviest: gaps.iter().flat_map(|gap| gap.masses).fold(0.0, f64::max),
        tolerance: ROUNDING * fastest,
        before,
        gaps,
    };
    let Impulses { impulses, after } = passive(&meeting)?;

    let mut changed = state.to_vec();
    let mut pressed: Components = smallvec![0.0; speeds.len()];
    for (place, (impulse, response)) in impulses.iter().zip(by_each()).enumerate() {
        changed.iter_mut().zip(response).for_each(|(to, by)| *to = *to + *impulse * *by);
        let gap = meeting.gaps[place / 2];
        for (contact, [_, outward]) in gap.contacts.into_iter().zip(gap.pushes()[place % 2]) {
            pressed[contact] += outward * impulse.value;
        }
    }
    // Contacts that separate more slowly than after the slowest impact that is resolved stay together.
    let slow = match system.restitution() {
        restitution if restitution < 1.0 => {
            0.99 * restitution.max(0.01) * system.lasting_approach()
        }
        _ => UNRESOLVED,
    };
    let together = touching.iter().zip(after.iter().step_by(2));
    let together = together.filter(|(_, opening)| opening.value <= slow).map(|(gap, _)| *gap);
    let together: SmallVec<[usize; 8]> = together.collect();
    let hits = touching.iter().zip(meeting.before.iter().step_by(2));
    let hits = hits.filter(|(gap, opening)| {
        let closes = opening.value < -meeting.tolerance || together.contains(gap);
        phases[**gap] == Phase::Open && closes
    });
    let hits = hits.map(|(gap, opening)| Hit { gap: *gap, opening_speed: opening.value });
    Ok(Impact {
        hits: hits.collect(),
        together,
        lifted: pressed.iter().filter(|force| **force < 0.0).count(),
        state: changed,
    })
}

/// Returns the impulses of both laws or, where these would add energy, those that conserve it. There are none unless
/// contacts approach each other.
///
/// # Errors
/// As [`Meeting::impulses`].
fn passive(meeting: &Meeting<'_>) -> Result<Impulses, Failure> {
    let Meeting { gaps, before, tolerance, .. } = meeting;
    if before.iter().step_by(2).all(|opening| opening.value >= -tolerance) {
        let impulses = smallvec![Dual::constant(0.0); before.len()];
        return Ok(Impulses { impulses, after: before.clone() });
    }
    let sum = |one: &Pairs<Dual>, factor: Dual, other: &Pairs<Dual>| -> Pairs<Dual> {
        one.iter().zip(other).map(|(one, other)| *one + factor * *other).collect()
    };
    // Twice the work of impulses at these speeds. The friction impulse acts on both bodies against their rolling.
    let work = |impulses: &Pairs<Dual>, speeds: &Pairs<Dual>| {
        let arms = gaps.iter().flat_map(|gap| [1.0, -gap.lever]);
        let all = arms.zip(impulses).zip(speeds);
        all.fold(Dual::constant(0.0), |sum, ((arm, impulse), speed)| {
            sum + Dual::constant(arm) * *impulse * *speed
        })
    };
    let one = Dual::constant(1.0);
    let added = |by: &Impulses| work(&by.impulses, &sum(before, one, &by.after));
    let newton = meeting.impulses()?;
    let rounding: f64 = newton.impulses.iter().map(|impulse| tolerance * impulse.value.abs()).sum();
    let is_inelastic = meeting.restitution.iter().all(|restitution| *restitution == 0.0);
    if is_inelastic || added(&newton).value <= rounding {
        return Ok(newton);
    }
    let restitution = smallvec![0.0; gaps.len()];
    let inelastic = Meeting { restitution, ..meeting.clone() }.impulses()?;
    let impulses = sum(&newton.impulses, -one, &inelastic.impulses);
    let after = sum(&newton.after, -one, &inelastic.after);
    // Twice the added energy as a polynomial of the share of the difference.
    let (constant, square) = (added(&inelastic), work(&impulses, &after));
    let linear = added(&newton) - constant - square;
    let root = (linear * linear - Dual::constant(4.0) * square * constant).sqrt();
    let share = (root - linear) * (Dual::constant(2.0) * square).reciprocal();
    Ok(Impulses {
        impulses: sum(&inelastic.impulses, share, &impulses),
        after: sum(&inelastic.after, share, &after),
    })
}
