//! Runs simulated one at a time: the cross-check of lockstep, and the only way for blocks.

use super::balancer::simulate_balancer;
use super::block::simulate_block;
use super::outcome::{Evidence, Outcome};
use super::recorder::Recorder;
use crate::model::{Case, Machine, Model, Simulation, Start};

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
