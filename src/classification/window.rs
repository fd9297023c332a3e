//! Means over the last part of a run, from its exact start within a step and with the motion inside
//! of steps.

use super::lane_step::LaneStep;
use crate::motion::PerContact;

/// The part of the time at the end of a run over which means are taken.
pub(super) const WINDOW: f64 = 0.1;

/// Nodes and weights of the Gauss-Legendre rule of order 10 for the displacement in a part of a
/// step. In the longest steps the square of the displacement oscillates by 5 rad at its
/// highest frequency; there the rule is accurate to 4e-6, and to 2e-8 in steps of 3 rad.
pub(super) const NODES: [f64; 5] = [
    0.046_910_077_030_668_004,
    0.230_765_344_947_158_45,
    0.5,
    0.769_234_655_052_841_5,
    0.953_089_922_969_332,
];
pub(super) const WEIGHTS: [f64; 5] = [
    0.118_463_442_528_094_54,
    0.239_314_335_249_683_23,
    0.284_444_444_444_444_44,
    0.239_314_335_249_683_23,
    0.118_463_442_528_094_54,
];

/// Sums for the means.
#[derive(Clone, Debug)]
pub(super) struct Window {
    /// The start, non-dimensional.
    pub(super) start: f64,
    opened: Option<WindowSums>,
}

#[derive(Clone, Debug)]
struct WindowSums {
    time: f64,
    positions: PerContact,
    square_time: f64,
}

/// Means from the window's start to now, non-dimensional.
pub(super) struct Means {
    /// The distance that each contact has moved; for a ball, the angle that it has turned, rad.
    pub(super) moved: PerContact,
    /// Mean speed of each contact.
    pub(super) speed: PerContact,
    /// Root mean square of the displacement.
    pub(super) amplitude: f64,
}

impl Window {
    /// Creates a window that starts at a time.
    pub(super) fn new(start: f64) -> Self {
        Window { start, opened: None }
    }

    /// Adds the part of a step that lies in the window.
    pub(super) fn take_in(&mut self, step: &LaneStep) {
        let ended = step.time();
        if ended <= self.start {
            return;
        }
        let began = step.began();
        let from = self.start.max(began);
        if ended <= from {
            return;
        }
        let opened = self.opened.get_or_insert_with(|| {
            let positions = step.unwrapped_at(from);
            WindowSums { time: from, positions, square_time: 0.0 }
        });
        let length = ended - from;
        if step.view.vibration.is_none() {
            return;
        }
        let after = NODES.map(|node| from - began + node * length);
        let squares = step.group.squares_within(step.lane, after);
        let mean: f64 = squares.iter().zip(WEIGHTS).map(|(square, weight)| weight * square).sum();
        opened.square_time += length * mean;
    }

    /// Returns the means up to the end of the latest step; `None` before the start of the window.
    pub(super) fn means(&self, step: &LaneStep) -> Option<Means> {
        let opened = self.opened.as_ref()?;
        let span = step.time() - opened.time;
        let now = step.unwrapped();
        let moved: PerContact =
            now.iter().zip(&opened.positions).map(|(now, then)| now - then).collect();
        (span > 0.0).then(|| Means {
            speed: moved.iter().map(|distance| distance / span).collect(),
            moved,
            amplitude: (opened.square_time / span).sqrt(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{NODES, WEIGHTS};

    /// The rule is exact for polynomials of degree 9, and not for degree 10.
    #[test]
    fn the_rule_is_exact_up_to_degree_9() {
        for degree in 0..=10 {
            let sum: f64 =
                NODES.iter().zip(WEIGHTS).map(|(node, weight)| weight * node.powi(degree)).sum();
            let error = (sum - 1.0 / f64::from(degree + 1)).abs();
            assert_eq!(error < 1e-15, degree <= 9, "{degree}: {error:e}");
        }
    }
}
