//! The largest amplitude of the vibration, and when it occurs.

use super::lane_step::LaneStep;

/// Within a step, a maximum is located if a square near it is at least this part of the largest one so far: between two
/// of eight instants the square grows by less than that.
const NEAR: f64 = 0.8;

/// The largest amplitude so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Peak {
    square: f64,
    time: f64,
}

impl Peak {
    /// Takes in the latest step.
    pub(super) fn take_in(&mut self, step: &LaneStep) {
        let (began, length) = (step.began(), step.time() - step.began());
        for (part, square) in step.group.largest_squares_within(step.lane, self.square, NEAR) {
            self.take_in_value(began + part * length, square);
        }
    }

    fn take_in_value(&mut self, time: f64, square: f64) {
        if square > self.square {
            *self = Peak { square, time };
        }
    }

    /// Returns the square of the amplitude.
    pub(super) fn square(self) -> f64 {
        self.square
    }

    /// Returns the larger of two.
    pub(super) fn or(self, other: Peak) -> Peak {
        if other.square > self.square { other } else { self }
    }

    /// Returns the amplitude, over the unit of length, and its non-dimensional time.
    pub(super) fn amplitude_and_time(self) -> [f64; 2] {
        [self.square.sqrt(), self.time]
    }
}
