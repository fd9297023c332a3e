//! The one arrow of this room: a case goes in, an outcome comes out.

use super::balancer::simulate_balancer;
use super::block::simulate_block;
use super::in_lockstep::{Runs, simulate_in_lockstep};
use super::outcome::{Evidence, Outcome};
use super::recorder::Recorder;
use crate::model::{Case, Machine, Model, Simulation, Start};
use crate::motion::SimdLevel;

/// The part of the time at the end of a run over which means are taken.
pub(super) const WINDOW: f64 = 0.1;

/// Simulates a case until its ending is known. A pure function: equal cases give equal outcomes, here
/// and among others in [`super::simulate_in_lockstep`].
pub fn simulate(case: &Case) -> Outcome {
    single(case, None)
}

/// The same, to the last bit, with its motion recorded.
pub fn simulate_recorded(case: &Case, recorder: &mut Recorder) -> Outcome {
    recorder.restart();
    single(case, Some(recorder))
}

fn single(case: &Case, recorder: Option<&mut Recorder>) -> Outcome {
    let mut runs = Single { case: Some(case.clone()), outcome: None, recorder };
    simulate_in_lockstep(SimdLevel::best(), &mut runs);
    let Single { outcome, recorder, .. } = runs;
    outcome.unwrap_or_else(|| one_by_one(case, recorder))
}

struct Single<'a> {
    case: Option<Case>,
    outcome: Option<Outcome>,
    recorder: Option<&'a mut Recorder>,
}

impl Runs for Single<'_> {
    fn next(&mut self) -> Option<(u64, Case)> {
        self.case.take().map(|case| (0, case))
    }

    fn ended(&mut self, _: u64, outcome: Outcome) {
        self.outcome = Some(outcome);
    }

    fn recorder(&mut self) -> Option<&mut Recorder> {
        self.recorder.as_deref_mut()
    }
}

/// Simulates a case by itself, with other code than in lockstep: the cross-check of that, and for models
/// that it does not know. Motions agree within their tolerances.
pub fn simulate_one_by_one(case: &Case) -> Outcome {
    one_by_one(case, None)
}

/// The same; a recorder, if there is one, begins anew.
pub(super) fn one_by_one(case: &Case, mut recorder: Option<&mut Recorder>) -> Outcome {
    if let Some(recorder) = &mut recorder {
        recorder.restart();
    }
    if let Err(invalid) = case.model.validate() {
        return Outcome::failed(Evidence::InvalidParameters, invalid.to_string());
    }
    match &case.model {
        Model::BallBalancer(machine) => {
            simulate_balls(machine, &case.start, &case.simulation, recorder)
        }
        Model::Block(block) => simulate_block(block, &case.start, &case.simulation, recorder),
    }
}

fn simulate_balls(
    machine: &Machine,
    start: &Start,
    simulation: &Simulation,
    recorder: Option<&mut Recorder>,
) -> Outcome {
    let run = match machine.balls.len() {
        1 => simulate_balancer::<1>,
        2 => simulate_balancer::<2>,
        3 => simulate_balancer::<3>,
        4 => simulate_balancer::<4>,
        5 => simulate_balancer::<5>,
        6 => simulate_balancer::<6>,
        7 => simulate_balancer::<7>,
        8 => simulate_balancer::<8>,
        other => {
            return Outcome::failed(Evidence::InvalidParameters, format!("{other} balls"));
        }
    };
    run(machine, start, simulation, recorder)
}
