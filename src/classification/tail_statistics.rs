//! Statistics over the last part of the time of a run.

use super::lane_step::LaneStep;
use super::lyapunov::{SEPARATION_WINDOW, Separation};
use super::output_watch::OutputWatch;
use super::system_view::SystemView;
use super::window::{WINDOW, Window};
use crate::model::Endings;

/// Statistics over the last part of the time.
#[derive(Clone, Debug)]
pub(super) struct TailStatistics {
    pub(super) window: Window,
    pub(super) outputs: OutputWatch,
    pub(super) separation: Separation,
}

impl TailStatistics {
    /// Creates the statistics for the last stage of a run, between two times. A system with one position and its
    /// speed cannot move irregularly: nothing separates.
    pub(super) fn within([begin, end]: [f64; 2], endings: Endings, view: &SystemView) -> Self {
        let separates = endings == Endings::All && view.dimension() > 2;
        let before = |window: f64| begin + (1.0 - window) * (end - begin);
        let separation = if separates { before(SEPARATION_WINDOW) } else { f64::INFINITY };
        let start = before(WINDOW);
        TailStatistics {
            window: Window::new(start),
            outputs: OutputWatch::from(start),
            separation: Separation::new(separation, end),
        }
    }

    /// Returns the earliest time at which the statistics begin.
    pub(super) fn start(&self) -> f64 {
        self.separation.start.min(self.window.start)
    }

    /// Adds the latest step to the means.
    pub(super) fn take_in(&mut self, step: &LaneStep) {
        self.window.take_in(step);
        self.outputs.take_in(step);
    }
}
