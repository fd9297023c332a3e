//! The conditions of gaps during a step: whether a closed one stays under pressure, and whether and when an open one closes.

use fearless_simd::prelude::*;
use smallvec::SmallVec;

use super::kernel::{Kernel, StepEnd};
use super::lane::Lane;
use super::lane_bounds::LaneBounds;
use super::root_isolation::Polynomial;
use super::vector::{Powers, TERMS, Vector};
use super::{Lanes, ORDER};
use crate::model::{Gap, TOUCHING};
use crate::motion::Phase;
use crate::motion::condition::Condition;

/// The condition that `weight λ + offset` is not negative, with the force `λ` in a gap. A gap without a force has the
/// weight 0.
#[derive(Clone, Copy)]
pub(super) struct Pressure<S: Vector> {
    pub(super) weight: Lanes<S>,
    pub(super) offset: Lanes<S>,
}

impl<S: Vector> Pressure<S> {
    /// No force.
    pub(super) fn none(simd: S) -> Self {
        Pressure { weight: Lanes::splat(simd, 0.0), offset: Lanes::splat(simd, 1.0) }
    }

    /// Forgets a lane.
    pub(super) fn clear(&mut self, lane: usize) {
        self.weight[lane] = 0.0;
        self.offset[lane] = 1.0;
    }

    /// Sets a lane from the phase of its gap. Between two contacts that stick no force is determined.
    pub(super) fn set(&mut self, lane: usize, run: &Lane, (gap, phase): (&Gap, Phase)) {
        let sticks = gap.contacts.iter().all(|contact| run.phases[*contact] == Phase::Stick);
        if phase == Phase::Closed && !sticks {
            self.weight[lane] = 1.0 / gap.reduced_mass();
            self.offset[lane] = run.margins.slack + 0.5 * run.width;
        } else {
            self.clear(lane);
        }
    }

    /// Returns the bounds of the condition from those of the force.
    #[inline(always)]
    pub(super) fn over(&self, force: &LaneBounds<S>) -> LaneBounds<S> {
        let [start, end] = force.values;
        let [first, last] = force.changes;
        let Pressure { weight, offset } = *self;
        LaneBounds {
            values: [weight * start + offset, weight * end + offset],
            changes: [weight * first, weight * last],
            bound: weight * force.bound,
        }
    }
}

/// Opening speeds up to this, non-dimensional, are those of a gap that has just opened.
const RELEASED: f64 = 1e-9;

/// A distance below all distances: a gap that is closed cannot close.
const NEVER: f64 = -1e3;

/// Where the lanes of a group have gaps.
pub(super) struct OpenGaps<S: Vector> {
    /// Bit mask of lanes with gaps.
    any: u64,
    /// Bit mask of lanes whose gaps are not those between each contact and the next one on a circle; in these the gaps are
    /// always examined.
    irregular: u64,
    /// The distance of a contact and the next one where they touch; [`NEVER`] while they do.
    distances: SmallVec<[Lanes<S>; 8]>,
    /// Bit mask of lanes in which a gap may close in the latest step.
    pub(super) lanes_to_examine: u64,
}

impl<S: Vector> OpenGaps<S> {
    pub(super) fn none(simd: S, contacts: usize) -> Self {
        let distances = SmallVec::from_elem(Lanes::splat(simd, 0.0), contacts);
        OpenGaps { any: 0, irregular: 0, distances, lanes_to_examine: 0 }
    }

    /// Sets a lane by the phases of its run.
    pub(super) fn set(&mut self, lane: usize, run: &Lane) {
        let bit = 1 << lane;
        self.any &= !bit;
        self.irregular &= !bit;
        if !run.has_gaps {
            return;
        }
        let Some(touching) = run.system.touching() else { return };
        let gaps = touching.gaps();
        let contacts = self.distances.len();
        self.any |= if gaps.is_empty() { 0 } else { bit };
        for (place, gap) in gaps.iter().enumerate() {
            if gaps.len() == contacts && gap.contacts == [place, (place + 1) % contacts] {
                let closed = run.phases[contacts + place] == Phase::Closed;
                self.distances[place][lane] = if closed { NEVER } else { gap.distance };
            } else {
                self.irregular |= bit;
            }
        }
    }

    /// Returns the lanes in which an open gap may close in a step of this length.
    #[inline(always)]
    pub(super) fn screen<K: Kernel<S>>(
        &mut self,
        (kernel, workspace, state): (&K, &K::Workspace, &K::LaneStates),
        alive: u64,
        length: Lanes<S>,
    ) -> u64 {
        if self.any & alive == 0 {
            self.lanes_to_examine = 0;
            return 0;
        }
        let simd = length.simd;
        let zero = Lanes::splat(simd, 0.0);
        let turn = Lanes::splat(simd, std::f64::consts::TAU);
        let contacts = kernel.contacts();
        let mut open = zero.simd_eq(zero);
        // The two gaps between two contacts close and open together.
        let pairs = if contacts == 2 { 1 } else { contacts };
        for place in 0..contacts {
            let next = (place + 1) % contacts;
            let apart = kernel.position(state, next) - kernel.position(state, place);
            let apart = apart.simd_lt(zero).select(apart + turn, apart);
            let width = apart - self.distances[place];
            let pair = [place % pairs, (place % pairs + 1) % contacts];
            open &= width.simd_gt(kernel.relative_travel(workspace, pair, length));
        }
        self.lanes_to_examine = (!open.to_bitmask() | self.irregular) & self.any & alive;
        self.lanes_to_examine
    }
}

/// Returns whether any contacts of a run are at each other, by their positions.
pub(super) fn any_touch(run: &Lane, position: impl Fn(usize) -> f64) -> bool {
    if !run.has_gaps {
        return false;
    }
    let gaps = run.system.touching().map_or(&[][..], |touching| touching.gaps());
    gaps.iter().any(|gap| gap.width(gap.contacts.map(&position)) <= TOUCHING)
}

/// Replaces the end of a step by the first closing of an open gap if that is earlier.
pub(super) fn first_closing<S: Vector, K: Kernel<S>>(
    (simd, kernel, workspace, states): (S, &K, &K::Workspace, &K::LaneStates),
    (lane, run): (usize, &Lane),
    length: f64,
    first: &mut StepEnd,
) {
    let Some(touching) = run.system.touching() else { return };
    let state = kernel.lane(states, lane);
    let aim = 0.5 * run.width;
    let contacts = kernel.contacts();
    for (index, gap) in touching.gaps().iter().enumerate() {
        if run.phases[contacts + index] != Phase::Open {
            continue;
        }
        let places = gap.contacts.map(|contact| kernel.coordinates(contact).0);
        // No maps: they would copy the arrays.
        let behind = kernel.component(workspace, lane, places[0], state[places[0]]);
        let mut powers: Powers = kernel.component(workspace, lane, places[1], state[places[1]]);
        for (power, behind) in powers.iter_mut().zip(&behind) {
            *power -= behind;
        }
        // A gap that has just opened without a speed has no width yet: it may be negative by rounding.
        let released = powers[1].abs() <= RELEASED;
        powers[0] = gap.width(places.map(|place| state[place])) + if released { aim } else { 0.0 };
        let mut coefficients = [0.0; ORDER + 1];
        coefficients.copy_from_slice(&powers[..=ORDER]);
        // The highest power counts in full at the end of the step.
        const { assert!(TERMS == ORDER + 2) };
        coefficients[ORDER] += powers[ORDER + 1] * length;
        first.or(simd, &Polynomial { coefficients, length }, None, Condition::Gap(index));
    }
}
