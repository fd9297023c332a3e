//! The end time of a run, the later one to which it is continued if the study extends it, and the statistics before
//! both.
//!
//! A continued run gives bit for bit the outcome of a run with the later end time from the start. Before the step that
//! the end time may shorten, only the statistics over the last part of the time depend on the end time. The whole run
//! is therefore saved before that step, and before the statistics for the later end time begin, and continued from
//! there. The effort limit is that of the longer run throughout.

use super::lane_step::LaneStep;
use super::lyapunov::{SEPARATION_WINDOW, Separation};
use super::outcome::Label;
use super::output_watch::OutputWatch;
use super::system_view::SystemView;
use super::window::{WINDOW, Window};
use crate::model::{Endings, Extend, Simulation};

/// Returns whether a run with a label is continued.
pub(super) fn continues(extend: Extend, label: Label) -> bool {
    match label {
        Label::Undecided => extend.labels.undecided,
        Label::Irregular => extend.labels.irregular,
        Label::Equilibrium
        | Label::LimitCycle
        | Label::Periodic
        | Label::Creep
        | Label::QuasiPeriodic
        | Label::Failed => false,
    }
}

/// The end time of a run with its statistics over the last part of the time, and those of the later
/// end time to which it may be continued.
#[derive(Clone, Debug)]
pub(super) struct Horizons {
    pub(super) now: Horizon,
    pub(super) later: Option<Horizon>,
}

/// An end time, non-dimensional, with its statistics.
#[derive(Clone, Debug)]
pub(super) struct Horizon {
    pub(super) end: f64,
    pub(super) statistics: TailStatistics,
}

impl Horizons {
    /// Returns the end times of a simulation; `natural` converts time in s into non-dimensional
    /// time, and `statistics` creates the statistics for an end time.
    pub(super) fn new(
        simulation: &Simulation,
        natural: f64,
        statistics: impl Fn(f64) -> TailStatistics,
    ) -> Self {
        let horizon = |end_time_s: f64| {
            let end = end_time_s * natural;
            Horizon { end, statistics: statistics(end) }
        };
        let [now, later] = simulation.end_times_s();
        Horizons { now: horizon(now), later: simulation.extend.map(|_| horizon(later)) }
    }

    /// Returns the latest end time, non-dimensional.
    pub(super) fn latest_end(&self) -> f64 {
        self.later.as_ref().map_or(self.now.end, |later| later.end)
    }

    /// Replaces the end time by the later one.
    pub(super) fn extend(&mut self) {
        if let Some(later) = self.later.take() {
            self.now = later;
        }
    }
}

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
