//! When friction no longer holds contacts that stick and touch.
//!
//! The forces in the gaps between them are not determined. At two instants the forces with the largest reserve are computed;
//! in between, forces that are linear in time prove that the contacts are held, as long as the conditions with these forces,
//! polynomials in time, are met. Where one is not, the next forces are computed.

use crate::model::{GapColumn, HeldContact, Holding, gap_columns};
use crate::motion::cluster::HeldCluster;
use crate::motion::lockstep::ORDER;
use crate::motion::lockstep::lane::Lane;
use crate::motion::lockstep::root_isolation::{ConditionFate, Polynomial};
use crate::motion::lockstep::vector::{Vector, vectorized};
use crate::motion::root::fall_through_zero;

/// The coefficients of a power series of time.
type Powers = [f64; ORDER + 1];

/// Width, over the length of the step, within which the end is located.
const WIDTH: f64 = 1e-13;
/// The most forces that are computed in a step.
const MOST: usize = 200;

/// Returns the part of a step from which on friction does not hold a set of contacts; `None` if it holds them throughout.
/// `series` returns the power series of normal and friction force of a contact, without forces in gaps.
pub(super) fn held_until<S: Vector>(
    simd: S,
    run: &Lane,
    cluster: &HeldCluster,
    series: impl Fn(usize) -> [Powers; 2],
    (length, slack): (f64, f64),
) -> Option<f64> {
    let forces: Vec<[Powers; 2]> = cluster.contacts.iter().map(|held| series(*held)).collect();
    let limit = |contact: usize| run.limits[contact];
    let place = |contact: usize| cluster.contacts.iter().position(|held| *held == contact);
    let at = |part: f64| -> Holding {
        let values = |contact: usize| {
            let powers = place(contact).map_or([[0.0; ORDER + 1]; 2], |place| forces[place]);
            powers.map(|powers| value(&powers, part * length))
        };
        cluster.holding(limit, values)
    };
    let contacts = cluster.held_contacts(limit, |_| [0.0; 2]);
    let reserve = |part: f64| at(part).reserve + slack;

    let mut from = 0.0;
    let mut now = at(from);
    if now.reserve < -slack {
        return Some(0.0);
    }
    let last = at(1.0);
    let (to, later, fails) = if last.reserve >= -slack {
        (1.0, last, false)
    } else {
        let ends = ((0.0, now.reserve + slack), (1.0, last.reserve + slack));
        let to = fall_through_zero(reserve, ends.0, ends.1, WIDTH);
        (to, at(to), true)
    };
    for _ in 0..MOST {
        let span = to - from;
        if span <= WIDTH {
            return fails.then_some(to);
        }
        let course = LinearGapForces { from: &now.forces, to: &later.forces, part: span };
        let fall = conditions(cluster, &contacts, &course)
            .filter_map(|condition| {
                let fate = vectorized!(simd, {
                    let moved = condition.of(&forces, (from * length, length, slack));
                    let scaled = Polynomial { coefficients: moved, length: span * length };
                    scaled.first_fall(&scaled.outline())
                });
                match fate {
                    ConditionFate::Holds => None,
                    ConditionFate::Fails(part) => Some(from + part * span),
                    ConditionFate::FailsAtOnce => Some(from),
                }
            })
            .fold(f64::INFINITY, f64::min);
        if fall >= to {
            return fails.then_some(to);
        }
        let next = at(fall);
        if next.reserve < -slack || fall - from <= WIDTH {
            return Some(fall);
        }
        (from, now) = (fall, next);
    }
    Some(from)
}

/// Forces in gaps that are linear in time.
struct LinearGapForces<'a> {
    from: &'a [[f64; 2]],
    to: &'a [[f64; 2]],
    /// The part of the step from the first to the last.
    part: f64,
}

/// A bound on the friction of a contact, in one direction.
struct HeldCondition {
    contact: usize,
    limit: f64,
    sign: f64,
    /// What the forces in gaps take up of the reserve, and its rate per part of the step.
    taken: f64,
    rate: f64,
}

/// Returns the conditions of all contacts.
fn conditions<'a>(
    cluster: &'a HeldCluster,
    contacts: &'a [HeldContact],
    course: &'a LinearGapForces<'a>,
) -> impl Iterator<Item = HeldCondition> + 'a {
    let columns: Vec<[GapColumn; 2]> =
        cluster.gaps.iter().map(|gap| gap_columns(gap, contacts)).collect();
    (0..2 * contacts.len()).map(move |row| {
        let taken = |forces: &[[f64; 2]]| -> f64 {
            let of_gap = |(columns, forces): (&[GapColumn; 2], &[f64; 2])| {
                columns[0][row] * forces[0] + columns[1][row] * forces[1]
            };
            columns.iter().zip(forces).map(of_gap).sum()
        };
        let first = taken(course.from);
        HeldCondition {
            contact: row / 2,
            limit: contacts[row / 2].limit,
            sign: if row % 2 == 0 { 1.0 } else { -1.0 },
            taken: first,
            rate: (taken(course.to) - first) / course.part,
        }
    })
}

impl HeldCondition {
    /// Returns the condition as a power series of the time since `start`.
    #[inline(always)]
    fn of(&self, forces: &[[Powers; 2]], (start, length, slack): (f64, f64, f64)) -> Powers {
        let [normal, friction] = &forces[self.contact];
        let mut held: Powers =
            std::array::from_fn(|k| self.limit * normal[k] - self.sign * friction[k]);
        // Taylor's shift, by Horner's scheme. A shift by 0 changes nothing.
        let shifted = if start == 0.0 { 0 } else { held.len() };
        for first in 0..shifted {
            for k in (first..held.len() - 1).rev() {
                held[k] = held[k + 1].mul_add(start, held[k]);
            }
        }
        held[0] += slack - self.taken;
        held[1] -= self.rate / length;
        held
    }
}

fn value(powers: &Powers, time: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum: f64, coefficient| sum.mul_add(time, *coefficient))
}
