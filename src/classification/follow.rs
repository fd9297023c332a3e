//! Follows a run until it ends, and a run that the study extends on to the later end time.
//!
//! What comes of a run that is continued is, to the last bit, what comes of the same run with the
//! later end time from the start. Up to the step that the end time may cut short, nothing but what
//! is gathered over the last part of the time depends on it. So the whole run is kept as it is
//! before that step and continued from there, and what depends on an end time is gathered for both,
//! each from its own start. The limit of effort is the longer run's all along.

use super::outcome::{Label, Outcome};
use super::recorder::Recorder;
use crate::model::{Extend, Simulation};

/// A run in progress.
pub(super) trait Run: Clone {
    /// How it came to its end.
    type Ending;

    /// Whether the end time may cut the next step short.
    fn reaches_end(&self) -> bool;

    /// Goes on by one step, to the end time at the latest, and says how the run has ended, if it
    /// has.
    fn advance(&mut self) -> Option<Self::Ending>;

    /// Takes the later end time for its own.
    fn extend(&mut self);

    /// What is known when it has ended.
    fn outcome(&self, ending: Self::Ending) -> Outcome;

    /// Shows the latest step to a recorder.
    fn show(&mut self, recorder: &mut Recorder);

    /// Tells a recorder that it goes on from here.
    fn goes_on(&self, recorder: &mut Recorder);
}

/// Follows a run until it ends; a recorder, if there is one, sees every step.
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

/// Whether a run with a label is continued.
pub(super) fn continues(extend: Extend, label: Label) -> bool {
    match label {
        Label::Undecided => extend.undecided,
        Label::Irregular => extend.irregular,
        Label::Equilibrium | Label::LimitCycle | Label::Failed => false,
    }
}

/// The end time of a run with what is gathered over the last part of the time, and the same for a
/// later end time that it may be continued to.
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
    /// The end times of a simulation, where `natural` turns time in s into non-dimensional time;
    /// `window` makes what is gathered for an end time.
    pub(super) fn new(simulation: &Simulation, natural: f64, window: impl Fn(f64) -> W) -> Self {
        let horizon = |end_time_s: f64| {
            let end = end_time_s * natural;
            Horizon { end, window: window(end) }
        };
        let [now, later] = simulation.end_times_s();
        Horizons { now: horizon(now), later: simulation.extend.map(|_| horizon(later)) }
    }

    /// The end time, non-dimensional.
    pub(super) fn end(&self) -> f64 {
        self.now.end
    }

    /// The latest end time, non-dimensional.
    pub(super) fn latest_end(&self) -> f64 {
        self.later.as_ref().map_or(self.now.end, |later| later.end)
    }

    /// What has been gathered for the end time.
    pub(super) fn window(&self) -> &W {
        &self.now.window
    }

    /// The same, to be added to.
    pub(super) fn window_mut(&mut self) -> &mut W {
        &mut self.now.window
    }

    /// What is to be gathered for the later end time, where there is one.
    pub(super) fn later_window(&self) -> Option<&W> {
        self.later.as_ref().map(|later| &later.window)
    }

    /// What is gathered for each end time.
    pub(super) fn windows(&mut self) -> impl Iterator<Item = &mut W> {
        std::iter::once(&mut self.now).chain(&mut self.later).map(|horizon| &mut horizon.window)
    }

    /// Takes the later end time for the end time.
    pub(super) fn extend(&mut self) {
        if let Some(later) = self.later.take() {
            self.now = later;
        }
    }
}
