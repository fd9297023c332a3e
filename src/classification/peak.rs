//! The largest amplitude of the vibration, and when it occurs.

use super::lane_step::LaneStep;

/// Within a step, a maximum is located if a square near it is at least this part of the largest one so far: between two
/// of eight instants the square grows by less than that.
const NEAR: f64 = 0.8;

/// The largest amplitude so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Peak {
    /// Its square.
    pub(super) square: f64,
    /// Its time, non-dimensional.
    pub(super) time: f64,
}

impl Peak {
    /// Takes in the latest step.
    pub(super) fn take_in(&mut self, step: &LaneStep) {
        let (began, length) = (step.began(), step.time() - step.began());
        for (part, square) in step.group.largest_squares_within(step.lane, self.square, NEAR) {
            *self = self.or(Peak { square, time: began + part * length });
        }
    }

    /// Returns the larger of two.
    pub(super) fn or(self, other: Peak) -> Peak {
        if other.square > self.square { other } else { self }
    }
}
