//! Simulation of many runs in lockstep: a lane whose run has ended takes the next run.
//!
//! Two groups of lanes are advanced alternately, one with displacements (for Lyapunov exponents)
//! and one without, and runs move between them. A run does not depend on its lane or its
//! neighbours, so that the order of the work does not affect the results.

use std::collections::VecDeque;

use fearless_simd::Simd;

use super::balancer::{Prepared, other_number_of_balls};
use super::lane_run::{LaneRun, Next};
use super::one_by_one::one_by_one;
use super::outcome::{Evidence, Outcome};
use super::recorder::Recorder;
use crate::model::{Ball, Case, Model};
use crate::motion::lockstep::{Group, Happened, LANES, Room, Saved, advance};
use crate::motion::{SimdLevel, unwind_if_cancelled};

/// Source of runs and sink of outcomes.
pub trait Runs {
    /// Returns the next run to compute: its number, which identifies its outcome, and its case.
    fn next(&mut self) -> Option<(u64, Case)>;

    /// Called when a run has ended. Runs end in any order.
    fn ended(&mut self, number: u64, outcome: Outcome);

    /// Returns the recorder of the run, if there is a single run that is to be recorded.
    fn recorder(&mut self) -> Option<&mut Recorder> {
        None
    }
}

/// Simulates runs until there are none left, in lockstep if their models allow it (see
/// [`goes_in_lockstep`]). Each outcome is bit for bit that of [`super::simulate`].
pub fn simulate_in_lockstep(level: SimdLevel, runs: &mut dyn Runs) {
    let mut upcoming = runs.next();
    while let Some((number, case)) = upcoming.take() {
        upcoming = match lanes_for(&case) {
            0 => {
                let outcome = one_by_one(&case, runs.recorder());
                runs.ended(number, outcome);
                runs.next()
            }
            1 => at::<1>(level, runs, (number, case)),
            2 => at::<2>(level, runs, (number, case)),
            3 => at::<3>(level, runs, (number, case)),
            4 => at::<4>(level, runs, (number, case)),
            5 => at::<5>(level, runs, (number, case)),
            6 => at::<6>(level, runs, (number, case)),
            7 => at::<7>(level, runs, (number, case)),
            _ => at::<8>(level, runs, (number, case)),
        };
    }
}

/// Returns the number of balls of the lanes for a case; 0 if the case is computed alone.
fn lanes_for(case: &Case) -> usize {
    let sound = case.model.validate().is_ok() && goes_in_lockstep(&case.model);
    if sound { case.model.balls() } else { 0 }
}

/// Returns whether runs of this model are computed in lockstep: balancers whose friction is
/// independent of speed or proportional to it.
pub fn goes_in_lockstep(model: &Model) -> bool {
    let Model::BallBalancer(machine) = model else { return false };
    let is_linear = |ball: &Ball| machine.friction.is_linear(ball.friction_coefficient);
    machine.balls.iter().all(is_linear)
}

fn at<const N: usize>(
    level: SimdLevel,
    runs: &mut dyn Runs,
    first: (u64, Case),
) -> Option<(u64, Case)> {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = level.avx512() {
        return Lockstep::<_, N>::new(simd, runs, first).go();
    }
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = level.avx2() {
        return Lockstep::<_, N>::new(simd, runs, first).go();
    }
    #[cfg(target_arch = "aarch64")]
    if let Some(simd) = level.neon() {
        return Lockstep::<_, N>::new(simd, runs, first).go();
    }
    let (number, case) = first;
    let outcome = one_by_one(&case, runs.recorder());
    runs.ended(number, outcome);
    runs.next()
}

/// Runs with `N` balls in progress.
struct Lockstep<'a, S: Simd, const N: usize> {
    simd: S,
    runs: &'a mut dyn Runs,
    /// The next run, with this number of balls or another.
    upcoming: Option<(u64, Case)>,
    /// Without displacements and with them.
    teams: [Team<S, N>; 2],
    room: Box<Room<S, N>>,
    /// Whether steps are recorded.
    recorded: bool,
}

/// A group of lanes with the monitors of each run.
struct Team<S: Simd, const N: usize> {
    group: Box<Group<S, N>>,
    members: [Option<Box<LaneRun<N>>>; LANES],
    cases: [Option<Case>; LANES],
    waiting: VecDeque<Waiting<N>>,
}

/// A run that waits for a lane.
struct Waiting<const N: usize> {
    saved: Saved<N>,
    run: Box<LaneRun<N>>,
    case: Case,
}

impl<'a, S: Simd, const N: usize> Lockstep<'a, S, N> {
    fn new(simd: S, runs: &'a mut dyn Runs, first: (u64, Case)) -> Self {
        let team = || Team {
            group: Box::new(Group::new(simd)),
            members: std::array::from_fn(|_| None),
            cases: std::array::from_fn(|_| None),
            waiting: VecDeque::new(),
        };
        Lockstep {
            simd,
            recorded: runs.recorder().is_some(),
            runs,
            upcoming: Some(first),
            teams: [team(), team()],
            room: Box::new(Room::new(simd)),
        }
    }

    /// Computes runs until none with this number of balls is left. Returns the next run after
    /// those.
    fn go(mut self) -> Option<(u64, Case)> {
        loop {
            self.fill(0);
            self.fill(1);
            let [plain, displaced] = self.teams.each_ref().map(|team| team.group.runs());
            if plain + displaced == 0 {
                return self.upcoming;
            }
            self.step(usize::from(displaced >= plain));
        }
    }

    /// Puts runs into empty lanes.
    fn fill(&mut self, team: usize) {
        while let Some(lane) = self.teams[team].group.empty_lane() {
            let next = self.teams[team].waiting.pop_front();
            let next = if team == 0 { next.or_else(|| self.start_next()) } else { next };
            let Some(Waiting { saved, run, case }) = next else { return };
            let Team { group, members, cases, .. } = &mut self.teams[team];
            group.put(lane, &saved, run.end());
            if let Some(recorder) = self.runs.recorder() {
                run.show_start(recorder, group, lane);
            }
            let number = run.number;
            let (next, run) = run.begins(group, lane);
            (members[lane], cases[lane]) = (run, Some(case));
            self.goes_on(team, lane, number, next);
        }
    }

    /// Returns the next run of this number of balls that can be started.
    fn start_next(&mut self) -> Option<Waiting<N>> {
        loop {
            let (number, case) = self.upcoming.take()?;
            if lanes_for(&case) != N {
                self.upcoming = Some((number, case));
                return None;
            }
            self.upcoming = self.runs.next();
            let Model::BallBalancer(machine) = &case.model else { continue };
            let Some(prepared) = Prepared::<N>::new(machine, &case.start, &case.simulation) else {
                self.runs.ended(number, other_number_of_balls());
                continue;
            };
            match LaneRun::start(number, prepared, &case.simulation) {
                Ok((saved, run)) => return Some(Waiting { saved, run: Box::new(run), case }),
                Err(failure) => {
                    let evidence = Evidence::Failure(failure);
                    self.runs.ended(number, Outcome::failed(evidence, failure.to_string()));
                }
            }
        }
    }

    /// Takes a step in all lanes of a team.
    fn step(&mut self, team: usize) {
        unwind_if_cancelled();
        let group = &mut self.teams[team].group;
        let happened = advance(self.simd, group, &mut self.room, team == 1);
        if self.recorded {
            self.record(team, &happened);
        }
        let mut lanes = happened.any();
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let Team { group, members, .. } = &mut self.teams[team];
            let Some(run) = &mut members[lane] else { continue };
            let number = run.number;
            let next = run.look(group, &self.room, lane, &happened);
            self.goes_on(team, lane, number, next);
        }
    }

    /// Passes the latest step to the recorder.
    #[inline(never)]
    fn record(&mut self, team: usize, happened: &Happened) {
        let Team { group, members, .. } = &self.teams[team];
        let Some(recorder) = self.runs.recorder() else { return };
        for (lane, run) in members.iter().enumerate() {
            let bit = 1 << lane;
            if let Some(run) = run
                && happened.taken & bit != 0
            {
                run.show(recorder, group, &self.room, lane, happened.event & bit != 0);
            }
        }
    }

    /// Continues, moves or ends a run in a lane.
    fn goes_on(&mut self, team: usize, lane: usize, number: u64, next: Next<N>) {
        if matches!(next, Next::Stay) {
            return;
        }
        let Team { group, members, cases, .. } = &mut self.teams[team];
        let saved = group.take(lane);
        let (run, case) = (members[lane].take(), cases[lane].take());
        match (next, case) {
            (Next::Done(outcome), _) => self.runs.ended(number, *outcome),
            (Next::Continue(kept), Some(case)) => {
                let (saved, run) = *kept;
                if let Some(recorder) = self.runs.recorder() {
                    recorder.rewind(saved.time(), saved.effort());
                }
                let team = usize::from(run.is_displaced(saved.time()));
                let waiting = Waiting { saved, run: Box::new(run), case };
                self.teams[team].waiting.push_back(waiting);
            }
            (Next::Move, Some(case)) => {
                if let (Some(saved), Some(run)) = (saved, run) {
                    self.teams[1 - team].waiting.push_back(Waiting { saved, run, case });
                }
            }
            (_, Some(case)) => {
                let outcome = one_by_one(&case, self.runs.recorder());
                self.runs.ended(number, outcome);
            }
            (_, None) => {}
        }
    }
}
