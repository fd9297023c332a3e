//! Pinned effort of some runs: steps, rejected steps, switches, and endings.
//!
//! The pins do not assert that an effort is right. A change of the engine that changes the effort
//! or the ending of a run shows in `tests/data/effort.txt`, and thus in review. To renew it:
//! `STICKSLIP_PIN_EFFORT=1 cargo test --test tests effort_pinned`, and `git diff tests/data`.

use std::fmt::Write;
use std::path::Path;

use stickslip::classification::{Outcome, simulate, simulate_by_recorded_equations};
use stickslip::model::{Ball, Case, FrictionLaw, Machine, Method, Simulation, Start};

const VISCOUS: FrictionLaw = FrictionLaw::viscous(2e-4);

/// A run of the thesis's machine, with angles and speeds of the balls at the start.
struct Pinned {
    name: &'static str,
    method: Method,
    friction: FrictionLaw,
    friction_coefficient: f64,
    speed_rad_s: f64,
    relative_tolerance: f64,
    beta: &'static [f64],
    beta_dot: &'static [f64],
}

impl Pinned {
    const USUAL: Pinned = Pinned {
        name: "",
        method: Method::Switch,
        friction: FrictionLaw::COULOMB,
        friction_coefficient: 2.75e-3,
        speed_rad_s: -216.3772,
        relative_tolerance: 1e-8,
        beta: &[1.0, 4.0],
        beta_dot: &[0.5, -0.3],
    };

    fn case(&self) -> Case {
        let ball = Ball { friction_coefficient: self.friction_coefficient, ..Ball::default() };
        let machine = Machine {
            speed_rad_s: self.speed_rad_s,
            friction: self.friction,
            balls: vec![ball; self.beta.len()],
            ..Machine::default()
        };
        let simulation = Simulation {
            method: self.method,
            relative_tolerance: self.relative_tolerance,
            absolute_tolerance: self.relative_tolerance / 100.0,
            ..Simulation::default()
        };
        let start = Start::of_balancer([0.01, -0.02], self.beta, [0.0, 0.02], self.beta_dot);
        Case { model: machine.into(), start, simulation }
    }
}

const RUNS: [Pinned; 9] = [
    Pinned { name: "subcritical, switch", speed_rad_s: -160.8103, ..Pinned::USUAL },
    Pinned {
        name: "subcritical, event",
        method: Method::Event,
        speed_rad_s: -160.8103,
        ..Pinned::USUAL
    },
    Pinned { name: "W1's, switch", relative_tolerance: 1e-6, ..Pinned::USUAL },
    Pinned {
        name: "W1's, event",
        method: Method::Event,
        relative_tolerance: 1e-6,
        ..Pinned::USUAL
    },
    Pinned { name: "little friction", friction_coefficient: 2.75e-4, ..Pinned::USUAL },
    Pinned {
        name: "one ball",
        method: Method::Event,
        speed_rad_s: -191.6372,
        beta: &[1.0],
        beta_dot: &[0.5],
        ..Pinned::USUAL
    },
    Pinned {
        name: "three balls",
        speed_rad_s: -173.1803,
        beta: &[1.0, 2.5, 4.0],
        beta_dot: &[0.5, 0.0, -0.3],
        ..Pinned::USUAL
    },
    Pinned { name: "viscous", friction: VISCOUS, speed_rad_s: -309.15, ..Pinned::USUAL },
    Pinned {
        name: "viscous, three balls",
        method: Method::Event,
        friction: VISCOUS,
        speed_rad_s: -216.3772,
        beta: &[1.0, 2.5, 4.0],
        beta_dot: &[0.5, 0.0, -0.3],
        ..Pinned::USUAL
    },
];

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
    for pinned in &RUNS {
        let case = pinned.case();
        let general = simulate_by_recorded_equations(&case);
        found += &row(pinned.name, "tuned", &simulate(&case));
        found += &row(pinned.name, "general", &general);
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
