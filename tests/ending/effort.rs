//! Runs that can never be brought to their end are given up soon, and say so.

use stickslip::ending::{Evidence, simulate};
use stickslip::model::{Block, Case, FrictionLaw, Machine, Model, Simulation, Start};

#[test]
fn hopeless_runs_are_given_up_soon() {
    let undamped = FrictionLaw::Viscous { viscous_coefficient_n_s_m: 0.0 };
    let slippery = FrictionLaw::Smooth { smoothing_speed: 1e200 };
    let swinging: Model = Block { friction: undamped, ..Block::on_spring() }.into();
    let stiff: Model =
        Block { friction: undamped, stiffness_n_m: 1e200, ..Block::on_spring() }.into();
    let turning: Model = Machine { friction: slippery, ..Machine::default() }.into();
    let block = Start(vec![0.01, 0.0]);
    let balls = Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0; 2], &[0.5, -0.3]);
    for (model, start, end_time_s) in
        [(swinging, &block, 1e12), (stiff, &block, 1.0), (turning, &balls, 1e12)]
    {
        let simulation = Simulation { end_time_s, ..Simulation::default() };
        let outcome = simulate(&Case { model, start: start.clone(), simulation });
        let effort = outcome.effort;
        let taken = effort.steps + effort.rejected_steps + effort.switches;
        assert_eq!(outcome.evidence.name(), "step_limit");
        assert!(matches!(outcome.evidence, Evidence::Failure(_)));
        assert!((1_000_000..1_200_000).contains(&taken), "{taken}");
    }
}
