//! Simulation of a case: the function from a case to its outcome.

use super::balancer::simulate_balancer;
use super::block::simulate_block;
use super::in_lockstep::{Runs, simulate_in_lockstep};
use super::outcome::{Evidence, Outcome};
use super::recorder::Recorder;
use crate::model::{Case, Machine, Model, Simulation, Start};
use crate::motion::SimdLevel;

/// The part of the time at the end of a run over which means are taken.
pub(super) const WINDOW: f64 = 0.1;

/// Simulates a case until its ending is known. This is a pure function: equal cases give equal
/// outcomes, also in [`super::simulate_in_lockstep`].
pub fn simulate(case: &Case) -> Outcome {
    single(case, None)
}

/// Simulates a case like [`simulate`], with bit for bit the same outcome, and records its motion.
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

/// Simulates a case with the one-by-one engine. It cross-checks the lockstep engine and computes
/// the models that lockstep does not support. Motions agree within their tolerances.
pub fn simulate_one_by_one(case: &Case) -> Outcome {
    one_by_one(case, None)
}

/// Simulates a case like [`simulate_one_by_one`]; the recorder, if any, is restarted.
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
