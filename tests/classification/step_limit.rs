//! Runs that cannot reach their end are given up early, with a message.

use stickslip::classification::{most_steps_of_a_run, seconds_per_step, simulate};
use stickslip::model::{Ball, Case, FrictionLaw, Machine, Model, Simulation, Start};

#[test]
fn runs_with_too_many_steps_are_abandoned_soon() {
    let slippery = FrictionLaw::smooth(1e200);
    let turning = Machine { friction: slippery, ..Machine::default() };
    let stiff = Machine { stiffness_n_m: 1e40, ..turning.clone() };
    let turning = Machine { speed_rad_s: -160.0, ..turning };
    let balls = Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0; 2], &[0.5, -0.3]);
    for (machine, end_time_s) in [(stiff, 1.0), (turning, 1e12)] {
        let (model, start): (Model, _) = (machine.into(), &balls);
        let simulation = Simulation { end_time_s, ..Simulation::default() };
        let a_second = (1.0 / seconds_per_step(&model)) as u64;
        let bound = most_steps_of_a_run(&model, &simulation).unwrap();
        let outcome = simulate(&Case { model, start: start.clone(), simulation });
        let taken = outcome.effort.total();
        assert_eq!(outcome.evidence.name(), "step_limit");
        assert!((a_second..a_second + 200_000).contains(&taken), "{taken}");
        assert!(taken <= bound, "{taken} of {bound}");
    }
}

/// With extremely heavy balls, the steps of a ball that nearly turns about its own contact shrink
/// without bound, and many switches follow one another at once. The run is given up by the limit
/// for these, not by the limit for its end time.
#[test]
fn a_run_that_hardly_moves_on_is_given_up_soon() {
    let mut machine = Machine::default();
    machine.balls = machine.balls.iter().map(|ball| Ball { diameter_m: 1e9, ..*ball }).collect();
    let start = Start::of_balancer(
        [-0.033501848875864326, 0.029011800723974107],
        &[1.1455820313090386, 3.13650404136001],
        [-0.0280229741264605, 0.013159808339493165],
        &[0.3892099166674974, 0.9082387402643326],
    );
    let simulation = Simulation { end_time_s: 1e4, ..Simulation::default() };
    let outcome = simulate(&Case { model: machine.into(), start, simulation });
    assert_eq!(outcome.evidence.name(), "step_limit");
    let taken = outcome.effort.total();
    assert!((10_000..20_000).contains(&taken), "{taken}");
}
