//! The jump of neighbouring motions where a condition of a phase fails.
//!
//! In a smooth phase a small perturbation follows the linearised equations. At a switch, which a neighbour meets
//! slightly earlier or later, it jumps by the saltation matrix
//!
//! ```text
//! S = 1 + (f⁺ - f⁻) ∇hᵀ / (∇hᵀ f⁻)
//! ```
//!
//! with the time derivatives `f⁻`, `f⁺` before and after and the condition `h` that fails (M. A.
//! Aizerman, F. R. Gantmakher, Quart. J. Mech. Appl. Math. 11 (1958) 433,
//! doi:10.1093/qjmam/11.4.433; R. I. Leine, H. Nijmeijer, *Dynamics and Bifurcations of Non-Smooth
//! Mechanical Systems*, Springer 2004, chapter 7, doi:10.1007/978-3-540-44398-8). A ball that comes
//! to rest thereby loses its speed in every direction; where it breaks loose against friction that
//! does not jump, nothing happens.
//!
//! Where an event resets the state to `R(x)`, a perturbation `δ` becomes
//!
//! ```text
//! ∇R (δ + f⁻ τ) - f⁺ τ,    τ = -∇hᵀ δ / (∇hᵀ f⁻)
//! ```
//!
//! with the guard `h` of the event: a neighbour meets it by `τ` later.
//!
//! If the conditions of several contacts fail at the same instant (blocks that move together), neighbours meet them one after
//! another, in any order: the jumps follow each other. If the result depends on the order by more than 1 %, or if impacts one after
//! another end in another state than those at once, neighbours' motions differ by more than first order, as at a condition that is
//! met by grazing.

use smallvec::{SmallVec, smallvec};

use super::impulse_response::ImpactPlace;
use super::joint_decision::{ForceModel, stick_reserve};
use super::touching_system::TouchingSystem;
use super::{Evaluator, Phase, Phases};
use crate::model::{Components, Dual};

/// A condition whose rate is below this fraction of the largest possible rate is grazed: there the
/// neighbours' motions differ by more than first order.
const GRAZING: f64 = 1e-12;

/// Jumps of the rate of change up to this, over the size of the forces, count as zero: a ball
/// breaks loose against friction that does not jump, within the width in which the instant is
/// located.
const NO_JUMP: f64 = 1e-8;

/// The largest difference between the jumps of two orders of switches, over the result, with which neighbours' motions count as alike.
/// The orders of balls that are light against their machine differ by less.
const SAME_RESULT: f64 = 1e-2;
/// The largest difference, non-dimensional, between the states after impacts one after another and at once.
const SAME_STATE: f64 = 1e-6;

/// Propagates a perturbation over a switch at which the phases `before` ended because a condition of a contact
/// failed and the phases `after` began. Returns whether the switch was met by grazing, or whether neighbours' motions depend on the
/// order in which their contacts switch.
pub(super) fn saltation(
    system: &dyn ForceModel,
    [before, after]: [&[Phase]; 2],
    failed: (usize, usize),
    direction: &mut [f64],
) -> bool {
    let mut switches: SmallVec<[(usize, usize); 2]> = smallvec![failed];
    let others = (0..after.len()).filter(|contact| *contact != failed.0);
    switches.extend(others.filter_map(|contact| {
        let which = fails_itself(system, [before, after], contact)?;
        Some((contact, which))
    }));
    if switches.len() == 1 {
        return saltation_of(system, [before, after], failed, direction);
    }
    let pass = |order: &mut dyn Iterator<Item = &(usize, usize)>, direction: &mut [f64]| {
        let (mut now, mut grazes) = (Phases::from(before), false);
        for (number, switch) in order.enumerate() {
            // What a contact does because of others comes with the last switch.
            let mut next = now.clone();
            match number + 1 == switches.len() {
                true => next.copy_from_slice(after),
                false => next[switch.0] = after[switch.0],
            }
            grazes |= saltation_of(system, [&now, &next], *switch, direction);
            now = next;
        }
        grazes
    };
    in_any_order(&switches, pass, direction)
}

/// Returns which condition of a contact fails by itself where it switches from one phase to another, not only because another
/// contact switches.
fn fails_itself(
    system: &dyn ForceModel,
    [before, after]: [&[Phase]; 2],
    contact: usize,
) -> Option<usize> {
    let small = NO_JUMP * system.force_scale();
    match (before[contact], after[contact]) {
        (before, after) if before == after => None,
        (Phase::Slip(_), Phase::Stick | Phase::Transition(_) | Phase::Slip(_))
        | (Phase::Transition(_), Phase::Slip(_)) => Some(0),
        (Phase::Transition(_), Phase::Stick) => {
            (system.forces(before)[contact].acceleration.abs() <= small).then_some(1)
        }
        (Phase::Stick, Phase::Slip(_) | Phase::Transition(_)) => {
            let forces = system.forces(before);
            let is_at_limit = stick_reserve(system, &forces, contact) <= small;
            is_at_limit.then_some(if forces[contact].friction > 0.0 { 0 } else { 1 })
        }
        _ => None,
    }
}

/// Propagates a perturbation over the switch of one contact like [`saltation`].
fn saltation_of(
    system: &dyn ForceModel,
    [before, after]: [&[Phase]; 2],
    (contact, which): (usize, usize),
    direction: &mut [f64],
) -> bool {
    let rate_before = system.rates(before);
    let mut jump = system.rates(after);
    jump.iter_mut().zip(&rate_before).for_each(|(jump, before)| *jump -= before);
    let largest = jump.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    if largest <= NO_JUMP * system.force_scale() {
        return false;
    }
    let change = |direction: &[f64]| {
        match (before[contact], which) {
            (Phase::Slip(sign), 0) => return sign * system.speed_along(contact, direction),
            (Phase::Transition(sign), 0) => {
                return -(sign * system.speed_along(contact, direction));
            }
            _ => {}
        }
        let forces = system.forces_along(before, direction)[contact];
        match (before[contact], which) {
            (Phase::Transition(sign), 1) => sign * forces.acceleration.slope,
            (Phase::Stick, which @ (0 | 1)) => {
                let sign = if which == 0 { 1.0 } else { -1.0 };
                let limit = system.limit(contact);
                limit * forces.normal.slope - sign * forces.friction.slope
            }
            _ => forces.normal.slope,
        }
    };
    let rate = change(&rate_before);
    let factor = change(direction) / rate;
    direction.iter_mut().zip(&jump).for_each(|(value, jump)| *value += factor * jump);
    rate.is_nan() || rate.abs() <= GRAZING * system.force_scale()
}

/// Propagates a perturbation over an impact that a gap or a landing contact begins, like [`saltation_at_reset`]. Contacts that meet at
/// the same instant do so one after another in neighbours' motions.
pub(super) fn saltation_at_impact(
    in_touch: &TouchingSystem,
    sides: [(&[Phase], &[f64]); 2],
    begins: ImpactPlace,
    direction: &mut [f64],
) -> bool {
    let [(phases, state), (_, after)] = sides;
    let mut places: SmallVec<[ImpactPlace; 2]> = smallvec![begins];
    places.extend(in_touch.meeting(phases, state).into_iter().filter(|place| *place != begins));
    if places.len() == 1 {
        return saltation_at_meeting(in_touch, sides, |_| true, begins, direction);
    }
    let pass = |order: &mut dyn Iterator<Item = &ImpactPlace>, direction: &mut [f64]| {
        let (mut now, mut at, mut grazes) = (Phases::from(phases), Components::from(state), false);
        for place in order {
            let (before, before_at) = (now.clone(), at.clone());
            let only = |other: ImpactPlace| other == *place;
            let met = in_touch.collide(&mut at, &mut now, only, None);
            grazes |= met.is_err() || in_touch.decide(&at, &mut now, &[], None).is_err();
            let sides: [(&[Phase], &[f64]); 2] = [(&before, &before_at), (&now, &at)];
            grazes |= saltation_at_meeting(in_touch, sides, only, *place, direction);
        }
        // Impacts one after another may end in another way than those at once.
        grazes || largest_difference(&at, after) > SAME_STATE
    };
    in_any_order(&places, pass, direction)
}

/// Propagates a perturbation in both orders of simultaneous changes, from the first to the last and reversed; `pass` does so in one order
/// and returns whether it grazes. Returns whether the results differ or an order grazes.
fn in_any_order<T>(
    changes: &[T],
    pass: impl Fn(&mut dyn Iterator<Item = &T>, &mut [f64]) -> bool,
    direction: &mut [f64],
) -> bool {
    let mut reversed = Components::from(&*direction);
    let grazes =
        pass(&mut changes.iter(), direction) | pass(&mut changes.iter().rev(), &mut reversed);
    let size = direction.iter().fold(0.0, |most: f64, of| most.max(of.abs()));
    grazes || largest_difference(direction, &reversed) > SAME_RESULT * size
}

fn largest_difference(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).fold(0.0, |most: f64, (left, right)| most.max((left - right).abs()))
}

/// Propagates a perturbation over an impact in which the contacts meet that `meets` says, at the instant at which those at a place do.
fn saltation_at_meeting(
    in_touch: &TouchingSystem,
    sides: [(&[Phase], &[f64]); 2],
    meets: impl Fn(ImpactPlace) -> bool + Copy,
    place: ImpactPlace,
    direction: &mut [f64],
) -> bool {
    let evaluator = in_touch.evaluator;
    let (phases, state) = sides[0];
    let guard = |direction: &[f64]| match place {
        ImpactPlace::Gap(gap) => {
            let contacts = in_touch.gaps[gap].contacts;
            let [behind, ahead] =
                contacts.map(|contact| evaluator.graph().layout.contacts[contact].position);
            direction[ahead] - direction[behind]
        }
        ImpactPlace::Opening(opening) => {
            let along = |place: usize| Dual { value: state[place], slope: direction[place] };
            evaluator.openings(along)[opening][0].slope
        }
    };
    let reset = |direction: &[f64]| {
        let mut after = Components::from(direction);
        let (mut state, mut phases) = (Components::from(state), Phases::from(phases));
        match in_touch.collide(&mut state, &mut phases, meets, Some(&mut after)) {
            Ok(_) => after,
            Err(_) => smallvec![f64::NAN; direction.len()],
        }
    };
    saltation_at_reset(evaluator, sides, guard, reset, direction)
}

/// Propagates a perturbation over an event that resets a state. `before` and `after` are the phases and the states on
/// both sides. `guard` and `reset` return the change of the guard, and that of the state after the event, along a direction.
/// Returns whether the event was met by grazing.
pub(super) fn saltation_at_reset(
    evaluator: &Evaluator,
    [before, after]: [(&[Phase], &[f64]); 2],
    guard: impl Fn(&[f64]) -> f64,
    reset: impl Fn(&[f64]) -> Components,
    direction: &mut [f64],
) -> bool {
    let flow = evaluator.rates(before.0, before.1);
    let rate = guard(&flow);
    let later = -guard(direction) / rate;
    let at_event: Components =
        direction.iter().zip(&flow).map(|(value, flow)| value + flow * later).collect();
    let reset = reset(&at_event);
    let flow_after = evaluator.rates(after.0, after.1);
    for (value, (reset, flow)) in direction.iter_mut().zip(reset.iter().zip(&flow_after)) {
        *value = reset - flow * later;
    }
    rate.is_nan() || rate.abs() <= GRAZING * evaluator.system().force_scale()
}
