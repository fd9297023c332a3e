//! Studies that a test writes down, and the cases of their runs.

use stickslip::model::{Case, Machine};
use stickslip::study::Study;

use super::shipped;

/// Parses a study as if it stood beside those of the project, whose systems it may name.
#[track_caller]
pub fn parse(text: impl Into<String>) -> Study {
    let text = text.into();
    let study = Study::parse(&shipped("a.yaml"), text.clone());
    study.unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Returns the case of each run of a study.
pub fn cases_of(study: &Study) -> Vec<Case> {
    (0..study.run_count()).map(|run| study.planned_run(run).case.expect("a valid case")).collect()
}

/// Returns the beginning of a study of a balancer with two equal balls that is written as a file, without dimensions.
pub fn balancer_of_a_file(machine: &Machine) -> String {
    let (natural, ball) = (machine.natural_frequency_rad_s(), machine.balls[0]);
    let (mass, radius) = (machine.total_mass_kg(), machine.ring_radius_m);
    format!(
        "schema: 1\nname: a\nseed: 2003\nmodel:\n  system: systems/ball_balancer.yaml\n  parameters:\n    \
         omega: {}\n    m: {}\n    imbalance: {}\n    zeta: {}\n    d: {}\n    mu: {}\n",
        machine.speed_rad_s / natural,
        ball.mass_kg / mass,
        machine.imbalance_mass_kg * machine.imbalance_radius_m / (mass * radius),
        machine.damping_n_s_m / (2.0 * mass * natural),
        ball.diameter_m / radius,
        ball.friction_coefficient,
    )
}
