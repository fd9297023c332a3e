//! Simulation of many runs in lockstep: a lane whose run has ended takes the next run.
//!
//! Two groups of lanes are advanced alternately, one with perturbations (for Lyapunov exponents)
//! and one without, and runs move between them. A run does not depend on its lane or its
//! neighbours, so that the order of the work does not affect the results.

use std::collections::VecDeque;
use std::sync::Arc;

use super::lane_run::{LaneRun, NextAction};
use super::outcome::{Evidence, Outcome};
use super::run_recorder::RunRecorder;
use crate::model::{Case, Components, Recorded, Stage, System};
use crate::motion::lockstep::{LANES, LaneGroup, SavedRun, StepReport};
use crate::motion::{SimdLevel, unwind_if_cancelled};

/// Source of runs and sink of outcomes.
pub trait Runs {
    /// Returns the next run to compute: its number, which identifies its outcome, and its case.
    fn next(&mut self) -> Option<(u64, Case)>;

    /// Called when a run has ended. Runs end in any order.
    fn ended(&mut self, number: u64, outcome: Outcome);

    /// Returns the recorder of the run, if there is a single run that is to be recorded.
    fn recorder(&mut self) -> Option<&mut RunRecorder> {
        None
    }
}

/// Simulates runs in lockstep until there are none left. Each outcome is bit for bit that of
/// [`super::simulate()`].
pub fn simulate_in_lockstep(level: SimdLevel, runs: &mut dyn Runs) {
    simulate_with(KernelChoice::Fastest, level, runs);
}

/// Simulates runs like [`simulate_in_lockstep`] with the general kernel, also where a tuned one exists. Outcomes agree
/// within the tolerances.
pub fn simulate_by_recorded_equations_in_lockstep(level: SimdLevel, runs: &mut dyn Runs) {
    simulate_with(KernelChoice::General, level, runs);
}

/// Which kernel computes a run.
#[derive(Clone, Copy)]
pub(super) enum KernelChoice {
    /// The tuned one, if there is one for the system.
    Fastest,
    /// The general one.
    General,
}

/// Simulates runs in lockstep with kernels of this choice.
pub(super) fn simulate_with(kernel: KernelChoice, level: SimdLevel, runs: &mut dyn Runs) {
    let mut upcoming = next_sound(kernel, runs);
    while let Some(first) = upcoming {
        upcoming = Lockstep::new((kernel, level), runs, first).compute();
    }
}

/// The team of runs in a stage in which the speed of the disc changes or a motion of a table goes on.
const DRIVEN: usize = 2;

/// A run that has not begun.
struct Upcoming {
    number: u64,
    case: Case,
    stages: Vec<Stage>,
    start: Components,
}

impl Upcoming {
    /// Returns the system in the last stage, in which the run ends.
    fn system(&self) -> &Arc<dyn System> {
        &self.stages[self.stages.len() - 1].system
    }
}

/// Returns the next run that is physically valid; all others end at once.
fn next_sound(kernel: KernelChoice, runs: &mut dyn Runs) -> Option<Upcoming> {
    loop {
        let (number, case) = runs.next()?;
        unwind_if_cancelled();
        match prepared(&case) {
            Ok((mut stages, start)) => {
                if let KernelChoice::General = kernel {
                    for stage in &mut stages {
                        stage.system = Arc::new(Recorded(Arc::clone(&stage.system)));
                    }
                }
                return Some(Upcoming { number, case, stages, start });
            }
            Err(error) => {
                runs.ended(number, Outcome::of(Evidence::InvalidParameters(error)));
            }
        }
    }
}

/// Returns stages and start state of a case, or what is invalid about it.
fn prepared(case: &Case) -> Result<(Vec<Stage>, Components), String> {
    let Case { model, start, simulation } = case;
    model.validate().map_err(|invalid| invalid.to_string())?;
    let state = model.start_state(start).map_err(|other| other.to_string())?;
    let stages = model.stages(start, simulation.end_time_s);
    let stages = stages.filter(|stages| !stages.is_empty());
    Ok((stages.ok_or_else(|| format!("{} balls", model.balls()))?, state))
}

/// Runs in progress whose systems share lanes.
struct Lockstep<'a> {
    kernel: KernelChoice,
    runs: &'a mut dyn Runs,
    /// The next run, whose system may need other lanes.
    upcoming: Option<Upcoming>,
    /// Without perturbations and with them; at last for runs in a stage with a system of its own, because the speed of the
    /// disc changes.
    teams: [Team; 3],
    level: SimdLevel,
    /// Whether steps are recorded.
    recorded: bool,
    /// Whether lanes may be empty or runs may wait for the first time since the lanes were filled.
    moved: bool,
}

/// A group of lanes with the monitors of each run.
struct Team {
    /// `None` until a run needs these lanes.
    group: Option<Box<dyn LaneGroup>>,
    members: [Option<Box<LaneRun>>; LANES],
    waiting: VecDeque<Waiting>,
}

/// A run that waits for a lane.
struct Waiting {
    saved: SavedRun,
    run: Box<LaneRun>,
}

impl<'a> Lockstep<'a> {
    fn new(
        (kernel, level): (KernelChoice, SimdLevel),
        runs: &'a mut dyn Runs,
        first: Upcoming,
    ) -> Self {
        let team = |group| Team {
            group,
            members: std::array::from_fn(|_| None),
            waiting: VecDeque::new(),
        };
        let first_lanes = level.lanes(first.system());
        let teams = [team(Some(first_lanes)), team(None), team(None)];
        let recorded = runs.recorder().is_some();
        Lockstep { kernel, level, recorded, runs, upcoming: Some(first), teams, moved: true }
    }

    /// Computes runs until none is left that fits the lanes. Returns the next run after those.
    fn compute(mut self) -> Option<Upcoming> {
        let mut fullest = 0;
        loop {
            while std::mem::take(&mut self.moved) {
                for team in 0..self.teams.len() {
                    self.fill(team);
                }
                // Of equally full teams the last one, so that few runs wait.
                let runs = |team: &usize| self.teams[*team].runs();
                fullest = (0..self.teams.len()).max_by_key(runs).unwrap_or_default();
            }
            if self.teams[fullest].runs() == 0 {
                return self.upcoming;
            }
            self.step(fullest);
        }
    }

    /// Puts runs into empty lanes.
    fn fill(&mut self, team: usize) {
        while let Some(Waiting { saved, run }) = self.next_of(team) {
            let Team { group: Some(group), members, .. } = &mut self.teams[team] else { return };
            let Some(lane) = group.empty_lane() else { return };
            group.put(lane, &saved, run.end());
            if let Some(recorder) = self.runs.recorder() {
                run.record(recorder, group.as_ref(), lane);
            }
            let number = run.number;
            let (next, run) = run.begin(group.as_mut(), lane);
            members[lane] = run;
            self.apply(team, lane, number, next);
        }
    }

    /// Returns the next run for an empty lane of a team, if there are both. A team without runs gets lanes for the run.
    fn next_of(&mut self, team: usize) -> Option<Waiting> {
        let has_room =
            |team: &Team| team.group.as_ref().is_none_or(|group| group.empty_lane().is_some());
        if !has_room(&self.teams[team]) {
            return None;
        }
        let level = self.level;
        let Team { group, waiting, .. } = &mut self.teams[team];
        if let Some(next) = waiting.front() {
            let system = next.saved.system();
            let fits = group.as_ref().is_some_and(|group| group.fits(system));
            if !fits {
                if group.as_ref().is_some_and(|group| group.runs() > 0) {
                    return None;
                }
                *group = Some(level.lanes(system));
            }
            return waiting.pop_front();
        }
        // A run with many stages needs much memory, so that few of them wait.
        if team != 0 || self.teams[DRIVEN].waiting.len() >= LANES {
            return None;
        }
        let next = self.start_next()?;
        match team_of(&next.saved, &next.run) {
            0 => Some(next),
            other => {
                self.teams[other].waiting.push_back(next);
                self.moved = true;
                None
            }
        }
    }

    /// Returns the next run that fits the lanes and can be started.
    fn start_next(&mut self) -> Option<Waiting> {
        loop {
            let group = self.teams[0].group.as_ref();
            let fits = |next: &mut Upcoming| group.is_some_and(|group| group.fits(next.system()));
            let Upcoming { number, case, stages, start } = self.upcoming.take_if(fits)?;
            self.upcoming = next_sound(self.kernel, self.runs);
            match LaneRun::start(number, &case, stages, &start) {
                Ok((saved, run)) => return Some(Waiting { saved, run: Box::new(run) }),
                Err(failure) => self.runs.ended(number, Outcome::of(Evidence::Failure(failure))),
            }
        }
    }

    /// Takes a step in all lanes of a team.
    fn step(&mut self, team: usize) {
        unwind_if_cancelled();
        let Some(group) = &mut self.teams[team].group else { return };
        let report = group.advance(team % 2 == 1);
        if self.recorded {
            self.record(team, &report);
        }
        let mut lanes = report.any();
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let Team { group: Some(group), members, .. } = &mut self.teams[team] else { return };
            let Some(run) = &mut members[lane] else { continue };
            let number = run.number;
            let next = run.examine(group.as_mut(), lane, &report);
            self.apply(team, lane, number, next);
        }
    }

    /// Passes the latest step to the recorder.
    #[inline(never)]
    fn record(&mut self, team: usize, report: &StepReport) {
        let Team { group: Some(group), members, .. } = &self.teams[team] else { return };
        let Some(recorder) = self.runs.recorder() else { return };
        for (lane, run) in members.iter().enumerate() {
            if let Some(run) = run
                && report.taken & 1 << lane != 0
            {
                run.record(recorder, group.as_ref(), lane);
            }
        }
    }

    /// Continues, moves or ends a run in a lane.
    fn apply(&mut self, team: usize, lane: usize, number: u64, next: NextAction) {
        if matches!(next, NextAction::Stay) {
            return;
        }
        self.moved = true;
        let Team { group: Some(group), members, .. } = &mut self.teams[team] else { return };
        let left = group.take(lane);
        let run = members[lane].take();
        let (saved, run) = match next {
            NextAction::Stay => return,
            NextAction::Done(outcome) => return self.runs.ended(number, *outcome),
            NextAction::Move => (left, run),
            NextAction::Enter(saved) => (Some(*saved), run),
            NextAction::Continue(kept) => (Some(kept.0), Some(Box::new(kept.1))),
        };
        if let (Some(saved), Some(run)) = (saved, run) {
            if let Some(recorder) = self.runs.recorder() {
                recorder.rewind(saved.time, saved.effort());
            }
            self.teams[team_of(&saved, &run)].waiting.push_back(Waiting { saved, run });
        }
    }
}

impl Team {
    /// Returns the number of runs in the lanes.
    fn runs(&self) -> u32 {
        self.group.as_ref().map_or(0, |group| group.runs())
    }
}

/// Returns the team that a run belongs to.
fn team_of(saved: &SavedRun, run: &LaneRun) -> usize {
    if run.stages.present().is_driven {
        return DRIVEN;
    }
    usize::from(run.is_perturbed(saved.time))
}
