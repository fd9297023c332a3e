//! Statistics over the last part of the time of a run.

use super::extremes::{Extremes, Passed};
use super::lane_step::LaneStep;
use super::lyapunov::{SEPARATION_WINDOW, Separation};
use super::output_watch::OutputWatch;
use super::system_view::SystemView;
use super::window::{WINDOW, Window};
use crate::model::Endings;

/// Statistics over the last part of the time.
#[derive(Clone, Debug)]
pub(super) struct Late {
    pub(super) vibration: Vibration,
    pub(super) outputs: OutputWatch,
    pub(super) separation: Separation,
}

/// What the amplitude is taken from.
#[derive(Clone, Debug)]
pub(super) enum Vibration {
    /// The displacement of the system, in the mean.
    Means(Window),
    /// The positions of the contacts, for a system without a displacement.
    Extremes(Extremes),
}

impl Late {
    /// Creates the statistics for the last stage of a run, between two times. A system with one position and its
    /// speed cannot move irregularly: nothing separates.
    pub(super) fn within([begin, end]: [f64; 2], endings: Endings, view: &SystemView) -> Self {
        let separates = endings == Endings::All && view.dimension() > 2;
        let before = |window: f64| begin + (1.0 - window) * (end - begin);
        let separation = if separates { before(SEPARATION_WINDOW) } else { f64::INFINITY };
        let start = before(WINDOW);
        let vibration = match view.vibration {
            Some(_) => Vibration::Means(Window::new(start)),
            None => Vibration::Extremes(Extremes::from(start)),
        };
        let outputs = OutputWatch::from(start);
        Late { vibration, outputs, separation: Separation::new(separation, end) }
    }

    /// Returns the earliest time at which the statistics begin.
    pub(super) fn start(&self) -> f64 {
        self.separation.start().min(self.vibration.start())
    }
}

impl Vibration {
    /// Returns the time from which on steps are added.
    pub(super) fn start(&self) -> f64 {
        match self {
            Vibration::Means(window) => window.start(),
            Vibration::Extremes(extremes) => extremes.start(),
        }
    }

    /// Adds the latest step, with its turning points if they are already known.
    pub(super) fn take_in(&mut self, step: &LaneStep, passed: Option<&Passed>) {
        if step.time() < self.start() {
            return;
        }
        match self {
            Vibration::Means(window) => window.take_in(step),
            Vibration::Extremes(extremes) => match passed {
                Some(passed) => extremes.take_in(step, passed),
                None => extremes.take_in(step, &Passed::of(step)),
            },
        }
    }
}
