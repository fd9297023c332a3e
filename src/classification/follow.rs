//! Follows a run until it ends, and continues it to the later end time if the study extends it.
//!
//! A continued run gives bit for bit the outcome of a run with the later end time from the start.
//! Before the step that the end time may shorten, only the statistics over the last part of the
//! time depend on the end time. The whole run is therefore saved before that step and continued
//! from there, and the statistics are collected for both end times, each from its own start. The
//! effort limit is that of the longer run throughout.

use super::outcome::{Label, Outcome};
use super::recorder::Recorder;
use crate::model::{Extend, Simulation};

/// A run in progress.
pub(super) trait Run: Clone {
    /// How the run ended.
    type Ending;

    /// Returns whether the end time may shorten the next step.
    fn reaches_end(&self) -> bool;

    /// Advances by one step, at most to the end time. Returns the ending if the run has ended.
    fn advance(&mut self) -> Option<Self::Ending>;

    /// Replaces the end time by the later one.
    fn extend(&mut self);

    /// Returns the outcome of the ended run.
    fn outcome(&self, ending: Self::Ending) -> Outcome;

    /// Passes the latest step to a recorder.
    fn show(&mut self, recorder: &mut Recorder);

    /// Notifies a recorder that the run continues from its current state.
    fn goes_on(&self, recorder: &mut Recorder);
}

/// Follows a run until it ends; the recorder, if any, receives every step.
pub(super) fn follow<R: Run>(
    mut run: R,
    extend: Option<Extend>,
    mut recorder: Option<&mut Recorder>,
) -> Outcome {
    show(&mut run, &mut recorder);
    let Some(extend) = extend else { return to_the_end(run, &mut recorder) };
    while !run.reaches_end() {
        if let Some(ending) = advance(&mut run, &mut recorder) {
            return run.outcome(ending);
        }
    }
    let mut kept = run.clone();
    let outcome = to_the_end(run, &mut recorder);
    if !continues(extend, outcome.label()) {
        return outcome;
    }
    kept.extend();
    if let Some(recorder) = &mut recorder {
        kept.goes_on(recorder);
    }
    Outcome { extended: true, ..to_the_end(kept, &mut recorder) }
}

fn to_the_end<R: Run>(mut run: R, recorder: &mut Option<&mut Recorder>) -> Outcome {
    loop {
        if let Some(ending) = advance(&mut run, recorder) {
            return run.outcome(ending);
        }
    }
}

fn advance<R: Run>(run: &mut R, recorder: &mut Option<&mut Recorder>) -> Option<R::Ending> {
    let ending = run.advance();
    show(run, recorder);
    ending
}

fn show<R: Run>(run: &mut R, recorder: &mut Option<&mut Recorder>) {
    if let Some(recorder) = recorder {
        run.show(recorder);
    }
}

/// Returns whether a run with a label is continued.
pub(super) fn continues(extend: Extend, label: Label) -> bool {
    match label {
        Label::Undecided => extend.undecided,
        Label::Irregular => extend.irregular,
        Label::Equilibrium | Label::LimitCycle | Label::Failed => false,
    }
}

/// The end time of a run with its statistics over the last part of the time, and those of the later
/// end time to which it may be continued.
#[derive(Clone, Debug)]
pub(super) struct Horizons<W> {
    now: Horizon<W>,
    later: Option<Horizon<W>>,
}

#[derive(Clone, Debug)]
struct Horizon<W> {
    end: f64,
    window: W,
}

impl<W> Horizons<W> {
    /// Returns the end times of a simulation; `natural` converts time in s into non-dimensional
    /// time, and `window` creates the statistics for an end time.
    pub(super) fn new(simulation: &Simulation, natural: f64, window: impl Fn(f64) -> W) -> Self {
        let horizon = |end_time_s: f64| {
            let end = end_time_s * natural;
            Horizon { end, window: window(end) }
        };
        let [now, later] = simulation.end_times_s();
        Horizons { now: horizon(now), later: simulation.extend.map(|_| horizon(later)) }
    }

    /// Returns the end time, non-dimensional.
    pub(super) fn end(&self) -> f64 {
        self.now.end
    }

    /// Returns the latest end time, non-dimensional.
    pub(super) fn latest_end(&self) -> f64 {
        self.later.as_ref().map_or(self.now.end, |later| later.end)
    }

    /// Returns the statistics for the end time.
    pub(super) fn window(&self) -> &W {
        &self.now.window
    }

    /// Returns the statistics for the end time, mutably.
    pub(super) fn window_mut(&mut self) -> &mut W {
        &mut self.now.window
    }

    /// Returns the statistics for the later end time; `None` without one.
    pub(super) fn later_window(&self) -> Option<&W> {
        self.later.as_ref().map(|later| &later.window)
    }

    /// Returns the statistics for each end time.
    pub(super) fn windows(&mut self) -> impl Iterator<Item = &mut W> {
        std::iter::once(&mut self.now).chain(&mut self.later).map(|horizon| &mut horizon.window)
    }

    /// Replaces the end time by the later one.
    pub(super) fn extend(&mut self) {
        if let Some(later) = self.later.take() {
            self.now = later;
        }
    }
}
