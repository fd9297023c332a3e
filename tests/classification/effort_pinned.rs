//! Pinned effort of some runs: steps, rejected steps, switches, and endings.
//!
//! The pins do not assert that an effort is right. A change of the engine that changes the effort
//! or the ending of a run shows in `tests/data/effort.txt`, and thus in review. To renew it:
//! `STICKSLIP_PIN_EFFORT=1 cargo test --test tests effort_pinned`, and `git diff tests/data`.

use std::fmt::Write;
use std::path::Path;

use stickslip::classification::{Outcome, simulate, simulate_by_recorded_equations};
use stickslip::model::{Ball, Case, FrictionLaw, Machine, Method, Simulation, Start, Tolerance};

use crate::support::cases;

/// Runs of the thesis's machine: the name, the method, the drag (none: dry friction), the friction coefficient, the speed of the
/// disc, the tolerance, and angles and speeds of the balls at the start.
const RUNS: &str = "subcritical, switch ¦ switch ¦  ¦ 2.75e-3 ¦ -160.8103 ¦ 1e-8 ¦ 1 4 ¦ 0.5 -0.3
subcritical, event ¦ event ¦  ¦ 2.75e-3 ¦ -160.8103 ¦ 1e-8 ¦ 1 4 ¦ 0.5 -0.3
W1's, switch ¦ switch ¦  ¦ 2.75e-3 ¦ -216.3772 ¦ 1e-6 ¦ 1 4 ¦ 0.5 -0.3
W1's, event ¦ event ¦  ¦ 2.75e-3 ¦ -216.3772 ¦ 1e-6 ¦ 1 4 ¦ 0.5 -0.3
little friction ¦ switch ¦  ¦ 2.75e-4 ¦ -216.3772 ¦ 1e-8 ¦ 1 4 ¦ 0.5 -0.3
one ball ¦ event ¦  ¦ 2.75e-3 ¦ -191.6372 ¦ 1e-8 ¦ 1 ¦ 0.5
three balls ¦ switch ¦  ¦ 2.75e-3 ¦ -173.1803 ¦ 1e-8 ¦ 1 2.5 4 ¦ 0.5 0 -0.3
viscous ¦ switch ¦ 2e-4 ¦ 2.75e-3 ¦ -309.15 ¦ 1e-8 ¦ 1 4 ¦ 0.5 -0.3
viscous, three balls ¦ event ¦ 2e-4 ¦ 2.75e-3 ¦ -216.3772 ¦ 1e-8 ¦ 1 2.5 4 ¦ 0.5 0 -0.3";

fn case([_, method, drag, coefficient, speed, tolerance, beta, beta_dot]: &[String; 8]) -> Case {
    let numbers = |text: &str| -> Vec<f64> {
        text.split_whitespace().map(|number| number.parse().expect("a number")).collect()
    };
    let [friction_coefficient, speed_rad_s, relative_tolerance] =
        [coefficient, speed, tolerance].map(|text| numbers(text)[0]);
    let beta = numbers(beta);
    let machine = Machine {
        speed_rad_s,
        friction: numbers(drag)
            .first()
            .map_or(FrictionLaw::COULOMB, |drag| FrictionLaw::viscous(*drag)),
        balls: vec![Ball { friction_coefficient, ..Ball::default() }; beta.len()],
        ..Machine::default()
    };
    let simulation = Simulation {
        method: if method == "event" { Method::Event } else { Method::Switch },
        tolerance: Tolerance { relative: relative_tolerance, absolute: relative_tolerance / 100.0 },
        ..Simulation::default()
    };
    let start = Start::of_balancer([0.01, -0.02], &beta, [0.0, 0.02], &numbers(beta_dot));
    Case { model: machine.into(), start, simulation }
}

fn row(name: &str, kernel: &str, outcome: &Outcome) -> String {
    let effort = outcome.effort;
    format!(
        "{name:<20}  {kernel:<7}  {:>6}  {:>9}  {:>8}  {:<11}  {}\n",
        effort.steps,
        effort.rejected_steps,
        effort.switches,
        outcome.label().name(),
        outcome.evidence.name()
    )
}

#[test]
fn efforts_are_those_pinned() {
    let mut found = String::new();
    writeln!(
        found,
        "{:<20}  {:<7}  {:>6}  {:>9}  {:>8}  {:<11}  evidence",
        "run", "kernel", "steps", "not taken", "switches", "label"
    )
    .unwrap();
    for run in cases(RUNS) {
        let case = case(&run);
        found += &row(&run[0], "tuned", &simulate(&case));
        found += &row(&run[0], "general", &simulate_by_recorded_equations(&case));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/effort.txt");
    if std::env::var_os("STICKSLIP_PIN_EFFORT").is_some() {
        std::fs::write(path, found).expect("the table can be written");
        return;
    }
    let pinned = std::fs::read_to_string(path).expect("the pinned table");
    assert!(
        found == pinned,
        "costs have changed; see the head of this file. Pinned:\n{pinned}\nNow:\n{found}"
    );
}
