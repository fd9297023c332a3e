//! The condition that a closed gap is under pressure.

use fearless_simd::SimdBase;

use super::Lanes;
use super::lane::Lane;
use super::lane_bounds::LaneBounds;
use crate::model::Gap;
use crate::motion::Phase;
use crate::motion::lockstep::vector::Vector;

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
