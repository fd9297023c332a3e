//! One of the runs in lockstep, with its monitors, step by step until its ending is known.
//!
//! A lane is inspected only after an event, a section crossing, near rest, or at a requested time.

use std::sync::Arc;

use super::ending::Ending;
use super::held_bodies::held_margin;
use super::horizons::{Horizons, TailStatistics, continues};
use super::lane_step::LaneStep;
use super::lyapunov;
use super::orbit::OrbitWatch;
use super::outcome::Outcome;
use super::run_recorder::RunRecorder;
use super::settled::{RestKind, SettledWatch};
use super::stages::Stages;
use super::step_limit::effort_limit;
use super::system_view::SystemView;
use crate::model::{Case, Components, Endings, Extend, Stage, Units};
use crate::motion::lockstep::{LaneGroup, SavedRun, StepReport};
use crate::motion::{Evaluator, Failure, Settings, all_stick};

/// Sizes of a perturbation that need no renormalisation.
const HANDY: std::ops::Range<f64> = 1e-99..1e99;

/// A run in a lane.
#[derive(Clone, Debug)]
pub(super) struct LaneRun {
    /// The run's number, which identifies it to the caller.
    pub(super) number: u64,
    pub(super) view: Arc<SystemView>,
    pub(super) units: Units,
    settings: Settings,
    endings: Endings,
    extend: Option<Extend>,
    pub(super) stages: Stages,
    pub(super) horizons: Horizons,
    pub(super) watch: Option<Box<OrbitWatch>>,
    pub(super) settled: SettledWatch,
    still: bool,
    /// The saved run before its end time had any effect, if the run may be continued.
    kept: Option<Box<(SavedRun, LaneRun)>>,
    pub(super) extended: bool,
}

/// The action on a run after a step.
pub(super) enum NextAction {
    /// The run stays in its lane.
    Stay,
    /// The run moves to other lanes: with perturbations or without.
    Move,
    /// The run enters its next stage from this saved state.
    Enter(Box<SavedRun>),
    /// The run continues later from this saved state.
    Continue(Box<(SavedRun, LaneRun)>),
    /// The run has ended.
    Done(Box<Outcome>),
}

impl LaneRun {
    /// Creates a run at its start, in the first of its stages. The endings are those of the last stage.
    pub(super) fn start(
        number: u64,
        case: &Case,
        stages: Vec<Stage>,
        state: &Components,
    ) -> Result<(SavedRun, Self), Failure> {
        let simulation = &case.simulation;
        let units = case.model.units();
        let (first, last) = (&stages[0], &stages[stages.len() - 1]);
        let view = view_of(first);
        let begin = last.begins_s * units.natural_rad_s;
        let last_view = if stages.len() == 1 { Arc::clone(&view) } else { view_of(last) };
        let late = |end: f64| TailStatistics::within([begin, end], simulation.endings, &last_view);
        let horizons = Horizons::new(simulation, units.natural_rad_s, late);
        let limit =
            |stage: &Stage| effort_limit(&case.model, stage.system.as_ref(), horizons.latest_end());
        let settings =
            Settings::new(simulation, stages.iter().map(limit).max().unwrap_or_default());
        let (state, lifted) = first.entered(None, state);
        let saved = SavedRun::start(&first.system, settings, &state)?;
        let watch = OrbitWatch::new(simulation.endings, &settings, &view);
        let run = LaneRun {
            number,
            watch: watch.filter(|_| stages.len() == 1),
            stages: Stages::new(stages, lifted),
            view,
            units,
            settings,
            endings: simulation.endings,
            extend: simulation.extend,
            horizons,
            settled: SettledWatch::default(),
            still: false,
            kept: None,
            extended: false,
        };
        Ok((saved, run))
    }

    /// Returns the end of the present stage.
    pub(super) fn end(&self) -> f64 {
        if self.stages.is_last() {
            self.horizons.now.end
        } else {
            self.stages.present().ends_s * self.units.natural_rad_s
        }
    }

    /// Returns whether the run needs a perturbation at a time.
    pub(super) fn is_perturbed(&self, time: f64) -> bool {
        let separation = &self.horizons.now.statistics.separation;
        separation.has_begun() && separation.follows(time)
    }

    /// Must be called when the run has been put into a lane: it may be at rest already.
    pub(super) fn begin(
        mut self: Box<Self>,
        group: &mut dyn LaneGroup,
        lane: usize,
    ) -> (NextAction, Option<Box<Self>>) {
        if self.stages.is_last() && self.rests(group, lane) {
            return (self.end_with(group, lane, Ending::Rest), None);
        }
        group.set_reporting(lane, self.watch.is_some());
        self.stages.watch(group, lane);
        self.schedule_inspection(group, lane);
        (NextAction::Stay, Some(self))
    }

    /// Passes the latest step, or the start of a stage, to a recorder.
    pub(super) fn record(&self, recorder: &mut RunRecorder, group: &dyn LaneGroup, lane: usize) {
        let step = LaneStep { group, lane, view: &self.view };
        recorder.take_in(&step);
        if !self.stages.is_last() && step.time() >= self.end() {
            recorder.leaves(&step);
        }
    }

    /// Evaluates the latest step.
    pub(super) fn examine(
        &mut self,
        group: &mut dyn LaneGroup,
        lane: usize,
        report: &StepReport,
    ) -> NextAction {
        let bit = 1 << lane;
        if let Some(failure) = report.failure(lane) {
            return self.end_with(group, lane, Ending::Failure(failure));
        }
        let time = group.time(lane);
        if report.larger & bit != 0 {
            self.stages.take_in(&LaneStep { group: &*group, lane, view: &self.view });
            self.stages.watch(group, lane);
        }
        if !self.stages.is_last() {
            if time >= self.end() {
                return self.enter_next_stage(group, lane);
            }
            return NextAction::Stay;
        }
        let perturbed = self.is_perturbed(time);
        self.measure(&*group, lane);
        let separation = &mut self.horizons.now.statistics.separation;
        if perturbed {
            self.track_separation(group, lane, time, report.attention & bit != 0);
        } else if separation.follows(time) && !separation.has_begun() {
            let mut perturbation = lyapunov::perturbation(&self.view);
            self.view.keep_together(group.phases(lane), &mut perturbation);
            group.perturb(lane, &perturbation);
            separation.mark(time, lyapunov::progress(&LaneStep { group, lane, view: &self.view }));
        }
        let still = report.still & bit != 0;
        if still || self.still {
            self.still = still;
            let since = if still { group.time_before(lane) } else { time };
            let at = (group.phases(lane), &*group.state(lane));
            let settled = self.settled.look(&self.view, at, [since, time, self.horizons.now.end]);
            if let Some(at_rest) = settled {
                let ending = match at_rest {
                    RestKind::Settled(place) => Ending::Settled(place),
                    RestKind::Held => Ending::Rest,
                };
                return self.end_with(group, lane, ending);
            }
        }
        let may_close = (report.event | report.round | report.turned) & bit != 0;
        if may_close || self.sees_each_step() {
            let step = LaneStep { group: &*group, lane, view: &self.view };
            let orbit = self.watch.as_mut().and_then(|watch| watch.closes(&self.settings, &step));
            if let Some(orbit) = orbit {
                return self.end_with(group, lane, Ending::Orbit(Box::new(orbit)));
            }
        }
        if time >= self.horizons.now.end {
            return self.end_or_extend(group, lane);
        }
        if report.rest & bit != 0 && self.rests(group, lane) {
            return self.end_with(group, lane, Ending::Rest);
        }
        self.schedule_inspection(group, lane);
        if self.is_perturbed(time) == perturbed { NextAction::Stay } else { NextAction::Move }
    }

    /// Goes on to the next stage.
    fn enter_next_stage(&mut self, group: &dyn LaneGroup, lane: usize) -> NextAction {
        let (Some(saved), Some(stage)) = (group.copy(lane), self.stages.upcoming()) else {
            return NextAction::Stay;
        };
        let (state, lifted) = stage.entered(Some(self.stages.present()), &saved.state);
        let saved = match saved.enters(&stage.system, &state, lifted) {
            Ok(saved) => saved,
            Err(failure) => return self.end_with(group, lane, Ending::Failure(failure)),
        };
        let view = view_of(stage);
        let ended =
            || self.stages.outcome(&LaneStep { group, lane, view: &self.view }, &self.units);
        let ended = (!stage.continues).then(ended);
        self.stages.next(ended, lifted);
        self.view = view;
        if self.stages.is_last() {
            self.watch = OrbitWatch::new(self.endings, &self.settings, &self.view);
        }
        NextAction::Enter(Box::new(saved))
    }

    /// Adds the latest step to the statistics that have begun.
    fn measure(&mut self, group: &dyn LaneGroup, lane: usize) {
        let step = LaneStep { group, lane, view: &self.view };
        self.horizons.now.statistics.take_in(&step);
    }

    /// Records the growth of the perturbation when that is due or its size is out of range. Other
    /// inspections of the run do not affect the result.
    fn track_separation(&mut self, group: &mut dyn LaneGroup, lane: usize, time: f64, asked: bool) {
        if !asked {
            return;
        }
        let (mut perturbation, grazed) = group.perturbation(lane);
        let size = lyapunov::size(&self.view, &perturbation);
        let due = time >= self.horizons.now.statistics.separation.next_mark();
        if !due && HANDY.contains(&size) {
            return;
        }
        perturbation.iter_mut().for_each(|component| *component *= 1.0 / size);
        group.perturb(lane, &perturbation);
        let progress = lyapunov::progress(&LaneStep { group, lane, view: &self.view });
        self.horizons.now.statistics.separation.grow(time, size, grazed, progress);
    }

    /// Returns whether the search for a closed orbit examines each step.
    fn sees_each_step(&self) -> bool {
        self.watch.as_ref().is_some_and(|watch| watch.sees_each_step())
    }

    /// Returns whether all contacts stick and can never break loose again.
    fn rests(&self, group: &dyn LaneGroup, lane: usize) -> bool {
        let (phases, state) = (group.phases(lane), group.state(lane));
        all_stick(phases)
            && (self.view.rest_forms().is_some_and(|forms| forms.surely_rests(&state))
                || held_margin(&self.view, phases, &state).is_some())
    }

    /// Schedules the next inspection of the run, and saves the run if its end time may affect the
    /// next step.
    fn schedule_inspection(&mut self, group: &mut dyn LaneGroup, lane: usize) {
        if !self.stages.is_last() {
            return;
        }
        let TailStatistics { window, separation, .. } = &self.horizons.now.statistics;
        let mut attention = if self.sees_each_step() { 0.0 } else { window.start };
        if !separation.has_begun() {
            attention = attention.min(separation.start);
        } else if self.is_perturbed(group.time(lane)) {
            attention = attention.min(separation.next_mark());
        }
        if let Some(later) = self.horizons.later.as_ref().map(|later| &later.statistics)
            && self.kept.is_none()
        {
            let depends = later.start().min(self.horizons.now.end);
            if group.reaches(lane, depends) {
                let run = self.clone();
                self.kept = group.copy(lane).map(|saved| Box::new((saved, run)));
            } else {
                attention = attention.min(depends - 1.01 * group.longest(lane));
            }
        }
        group.set_attention(lane, attention);
    }

    /// Ends the run at its end time, or continues it to the later one.
    fn end_or_extend(&mut self, group: &dyn LaneGroup, lane: usize) -> NextAction {
        let forms = || self.view.rest_forms();
        let rests = all_stick(group.phases(lane))
            && forms().is_some_and(|forms| forms.rests(&group.state(lane)));
        let closes = || {
            let steps = group.effort(lane).total();
            let watch = self.watch.as_ref()?;
            watch.closes_at_end(&self.settings, group.last_switches(lane), steps)
        };
        let ending = if rests { Ending::Rest } else { closes().unwrap_or(Ending::EndTime) };
        let outcome = self.outcome(group, lane, ending);
        if let (Some(extend), Some(mut kept)) = (self.extend, self.kept.take())
            && continues(extend, outcome.label())
        {
            kept.1.horizons.extend();
            kept.1.extended = true;
            return NextAction::Continue(kept);
        }
        NextAction::Done(Box::new(outcome))
    }

    fn end_with(&self, group: &dyn LaneGroup, lane: usize, ending: Ending) -> NextAction {
        NextAction::Done(Box::new(self.outcome(group, lane, ending)))
    }
}

/// Returns the view of the system in a stage.
fn view_of(stage: &Stage) -> Arc<SystemView> {
    Arc::new(SystemView::new(Evaluator::new(Arc::clone(&stage.system))))
}
