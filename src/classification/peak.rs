//! The largest amplitude of the vibration, and when it occurs.

use super::lane_step::LaneStep;
use super::window::NODES;

/// Within a step, a maximum is located if a value near it is at least this part of the largest one so far: between two
/// nodes the amplitude grows by less than that.
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
        let squares = step.group.squares_within(step.lane, NODES.map(|node| node * length));
        let [start, end] = [step.group.state_within(step.lane, 0.0), step.end()];
        let ends = [step.view.square(&start), step.view.square(&end)];
        let nodes = NODES.into_iter().zip(squares);
        let values = [(0.0, ends[0])].into_iter().chain(nodes).chain([(1.0, ends[1])]);
        let values: Vec<(f64, f64)> = values.collect();
        for (part, square) in &values {
            self.take_in_value(began + part * length, *square);
        }
        for two in values.windows(2) {
            let [(low, before), (high, after)] = [two[0], two[1]];
            if before.max(after) >= NEAR * self.square {
                let outward = |part: f64| {
                    step.view.outward(&step.group.state_within(step.lane, part * length))
                };
                let at = step.falls_between([low, high], outward);
                if let Some(part) = at {
                    let state = step.group.state_within(step.lane, part * length);
                    self.take_in_value(began + part * length, step.view.square(&state));
                }
            }
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
