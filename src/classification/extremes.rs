//! The least and the greatest position of a block after a given time.

use crate::model::{Slider, SliderState};
use crate::motion::Motion;

/// Extremes after a given time, which may lie within a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extremes {
    start: f64,
    range: Option<[f64; 2]>,
}

/// A step: the block's positions at selected times in it, including its turning points and its end.
pub(super) struct Passed {
    before: f64,
    points: [Option<(f64, f64)>; 3],
}

impl Passed {
    /// Evaluates the motion's latest step, which began at the time `before`, with the block `stuck`
    /// or not: it turns back only while it slides.
    pub(super) fn of(
        slider: &Slider,
        motion: &mut Motion<Slider, 1, 0>,
        before: f64,
        stuck: bool,
    ) -> Self {
        let [forward, backward] = [1.0, -1.0].map(|direction| {
            let velocity =
                |state: &SliderState| direction * (slider.belt_speed + state.beta_dot[0]);
            let turn = if stuck { None } else { motion.falls_through_zero(velocity) };
            turn.map(|(time, state)| (time, state.beta[0]))
        });
        let end = (motion.time(), motion.state().beta[0]);
        Passed { before, points: [forward, backward, Some(end)] }
    }
}

impl Extremes {
    /// Starts at a time.
    pub(super) fn from(start: f64) -> Self {
        Extremes { start, range: None }
    }

    /// Starts at a time and position.
    pub(super) fn from_place(start: f64, position: f64) -> Self {
        Extremes { start, range: Some([position; 2]) }
    }

    /// Adds the motion's latest step.
    pub(super) fn take_in(&mut self, passed: &Passed, motion: &mut Motion<Slider, 1, 0>) {
        if passed.before < self.start
            && let Some(state) = motion.within_last_step(self.start)
        {
            self.extend(state.beta[0]);
        }
        for (time, position) in passed.points.into_iter().flatten() {
            if time >= self.start {
                self.extend(position);
            }
        }
    }

    fn extend(&mut self, position: f64) {
        let [low, high] = self.range.get_or_insert([position; 2]);
        *low = low.min(position);
        *high = high.max(position);
    }

    /// Returns half of the distance between the extremes; `None` if no step was added.
    pub(super) fn amplitude(&self) -> Option<f64> {
        self.range.map(|[low, high]| 0.5 * (high - low))
    }
}
