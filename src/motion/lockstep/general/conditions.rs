//! The conditions of the phases ([`crate::motion::condition`]) as power series over a step.
//!
//! The guard of an event is a condition, too, and so is the pressure in a closed gap. Contacts that stick and touch are held
//! together ([`crate::motion::lockstep::held_until`]).
//!
//! For all lanes it is first shown which conditions certainly hold ([`super::series::Screen`]); the remaining lanes are examined
//! one at a time.

use super::compiled::Compiled;
use super::series::{ConditionBound, Programs};
use super::workspace::RecordedWorkspace;
use crate::motion::Phase;
use crate::motion::condition::{Condition, Margins};
use crate::motion::lockstep::ORDER;
use crate::motion::lockstep::gap_conditions::Pressure;
use crate::motion::lockstep::kernel::StepEnd;
use crate::motion::lockstep::lane::Lane;
use crate::motion::lockstep::root_isolation::{ConditionFate, Polynomial};
use crate::motion::lockstep::vector::Vector;

/// Bodies that touch have landed where their gap has become smaller by this, non-dimensional.
const SUNK: f64 = 1e-13;

/// Returns the numbers of a contact's conditions ([`super::operations::ContactCell`]), in their order. A condition is
/// satisfied while it is not negative, and counts as failed if it is negative by `aim`.
pub(super) fn of_contact(phase: Phase, limit: f64, (margins, aim): (&Margins, f64)) -> [f64; 6] {
    let [sign, offset, stuck] = margins.first_condition(phase, aim);
    // The gap of a contact that is apart closes where it is zero.
    let aim = if phase == Phase::Apart { 0.0 } else { aim };
    [sign, offset, stuck, limit, margins.slack + aim, aim]
}

/// Returns the end of a step of one lane.
#[inline(never)]
pub(super) fn first_event<S: Vector>(
    simd: S,
    workspace: &RecordedWorkspace<S>,
    program: &Compiled,
    (run, lane, length): (&Lane, usize, f64),
    pressures: &[Pressure<S>],
    ignored: &[Condition],
) -> StepEnd {
    let mut first = StepEnd::Nothing;
    let band = run.margins.band;
    let aim = 0.5 * run.width;
    let slack = run.margins.slack + aim;
    let series = workspace.series();
    let Compiled { operations, programs: Programs { screen, exact_screen, .. }, .. } = program;
    let (_, screen) = exact_screen.as_ref().filter(|_| workspace.is_exact).unwrap_or(screen);
    let (of_contacts, others) = workspace.lanes_to_examine.split_at(operations.contacts.len());
    let (of_events, of_gaps) = others.split_at(operations.guards.len());
    for (gap, (force, pressure)) in operations.gaps.iter().zip(pressures).enumerate() {
        let failed = Condition::Pressed(gap);
        if of_gaps[gap] & 1 << lane != 0 && !ignored.contains(&failed) {
            let (weight, offset) = (pressure.weight[lane], pressure.offset[lane]);
            let force = |k: usize| weight * series.of(*force)[k][lane];
            first.or(simd, &Polynomial::of(length, offset, ORDER - 1, force), None, failed);
        }
    }
    let is_doubtful = |contact: &usize| of_contacts[*contact] & 1 << lane != 0;
    let if_stuck = |contact: usize| {
        let [_, _, normal, friction] = operations.contacts[contact];
        [normal, friction].map(|slot| {
            std::array::from_fn(|k| if k < ORDER { series.of(slot)[k][lane] } else { 0.0 })
        })
    };
    first.or_released(simd, run, (is_doubtful, if_stuck), (length, slack), ignored);
    for (contact, slots) in operations.contacts.iter().enumerate() {
        if of_contacts[contact] & 1 << lane == 0 {
            continue;
        }
        let [speed, acceleration, normal, friction] =
            slots.map(|slot| move |k: usize| series.of(slot)[k][lane]);
        let mut examine =
            |bound: ConditionBound, which: usize, condition: &dyn Fn() -> Polynomial| {
                let failed = Condition::Contact { contact, which };
                if workspace.may_fail(&screen.contacts[contact], bound, lane)
                    && !ignored.contains(&failed)
                {
                    first.or(simd, &condition(), None, failed);
                }
            };
        match run.phases[contact] {
            Phase::Slip(direction) => {
                let slips = |k| direction * speed(k);
                examine(ConditionBound::Slips, 0, &|| {
                    Polynomial::of(length, aim - band, ORDER, slips)
                });
            }
            Phase::Transition(direction) => {
                let inside = |k| -(direction * speed(k));
                examine(ConditionBound::Slips, 0, &|| {
                    Polynomial::of(length, aim + band, ORDER, inside)
                });
                let forwards = |k| direction * acceleration(k);
                examine(ConditionBound::Slips, 1, &|| {
                    Polynomial::of(length, slack, ORDER - 1, forwards)
                });
            }
            // Contacts that touch are held together.
            Phase::Stick if run.is_held(contact) => {}
            Phase::Stick => {
                let limit = run.limits[contact];
                let held = |sign: f64| move |k| limit * normal(k) - sign * friction(k);
                for (which, bound, sign) in
                    [(0, ConditionBound::Forward, 1.0), (1, ConditionBound::Backward, -1.0)]
                {
                    examine(bound, which, &|| Polynomial::of(length, slack, ORDER - 1, held(sign)));
                }
            }
            Phase::Free | Phase::Apart | Phase::Open | Phase::Closed => {}
        }
        if run.phases[contact] == Phase::Apart {
            let failed = Condition::Landing(contact);
            let gap = |offset: f64| Polynomial::of(length, offset, ORDER - 1, normal);
            // Bodies that touch and move with each other, or stick, do not land: their gap is negative by rounding.
            let lands_at_once = normal(0) <= 0.0 && {
                let gap = gap(0.0);
                gap.first_fall(&gap.outline()) == ConditionFate::FailsAtOnce
            };
            let offset = if lands_at_once { SUNK - normal(0) } else { 0.0 };
            first.or(simd, &gap(offset), None, failed);
        } else {
            examine(ConditionBound::Closed, 2, &|| Polynomial::of(length, aim, ORDER - 1, normal));
        }
    }
    for (event, guard) in operations.guards.iter().enumerate() {
        if of_events[event] & 1 << lane != 0 {
            let guard = Polynomial::of(length, 0.0, ORDER - 1, |k| series.of(*guard)[k][lane]);
            first.or(simd, &guard, None, Condition::Event(event));
        }
    }
    first
}
