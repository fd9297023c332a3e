//! When friction no longer holds contacts that stick and touch.
//!
//! The forces in the gaps between them are not determined. At two instants the forces with the largest reserve are computed;
//! in between, forces that are linear in time prove that the contacts are held, as long as the conditions with these forces,
//! polynomials in time, are met. Where one is not, the next forces are computed.

use crate::model::{GapColumn, Holding, gap_columns};
use crate::motion::cluster::HeldCluster;
use crate::motion::condition::Condition;
use crate::motion::lockstep::ORDER;
use crate::motion::lockstep::kernel::StepEnd;
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

impl StepEnd {
    /// Replaces this end by the part of the step from which on friction does not hold contacts that stick and touch, if that is
    /// earlier. Of contacts that are not doubtful, friction holds each alone. `series` are those of [`held_until`].
    pub(super) fn or_released<S: Vector>(
        &mut self,
        simd: S,
        run: &Lane,
        (is_doubtful, series): (impl Fn(&usize) -> bool, impl Fn(usize) -> [Powers; 2]),
        (length, slack): (f64, f64),
        ignored: &[Condition],
    ) {
        for cluster in &run.held {
            let failed = Condition::Held(cluster.contacts[0]);
            if !cluster.contacts.iter().any(&is_doubtful) || ignored.contains(&failed) {
                continue;
            }
            match held_until(simd, run, cluster, &series, (length, slack)) {
                Some(0.0) => *self = StepEnd::AtOnce(failed),
                Some(part) => self.earlier(part, failed),
                None => {}
            }
        }
    }
}

/// Returns the part of a step from which on friction does not hold a set of contacts; `None` if it holds them throughout.
/// `series` returns the power series of normal and friction force of a contact, without forces in gaps.
fn held_until<S: Vector>(
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
    let columns: Vec<[GapColumn; 2]> =
        cluster.gaps.iter().map(|gap| gap_columns(gap, &contacts)).collect();
    // What forces in gaps take up of the reserve of a contact in one direction.
    let taken = |row: usize, forces: &[[f64; 2]]| -> f64 {
        let of_gap = |(columns, forces): (&[GapColumn; 2], &[f64; 2])| {
            columns[0][row] * forces[0] + columns[1][row] * forces[1]
        };
        columns.iter().zip(forces).map(of_gap).sum()
    };
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
        let fall = (0..2 * contacts.len())
            .filter_map(|row| {
                // Forces in gaps that are linear in time.
                let [first, last] = [&now, &later].map(|held| taken(row, &held.forces));
                let rate = (last - first) / span / length;
                let sign = if row % 2 == 0 { 1.0 } else { -1.0 };
                let limit = contacts[row / 2].limit;
                let fate = vectorized!(simd, {
                    let mut left = friction_left(&forces[row / 2], (limit, sign), from * length);
                    left[0] += slack - first;
                    left[1] -= rate;
                    let scaled = Polynomial { coefficients: left, length: span * length };
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

/// Returns what is left of the friction of a contact in one direction, as a power series of the time since `start`.
#[inline(always)]
fn friction_left(
    [normal, friction]: &[Powers; 2],
    (limit, sign): (f64, f64),
    start: f64,
) -> Powers {
    let mut left: Powers = std::array::from_fn(|k| limit * normal[k] - sign * friction[k]);
    // Taylor's shift, by Horner's scheme. A shift by 0 changes nothing.
    let shifted = if start == 0.0 { 0 } else { left.len() };
    for first in 0..shifted {
        for k in (first..left.len() - 1).rev() {
            left[k] = left[k + 1].mul_add(start, left[k]);
        }
    }
    left
}

fn value(powers: &Powers, time: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum: f64, coefficient| sum.mul_add(time, *coefficient))
}
