//! Coulomb friction and viscous drag together: closed forms of blocks, and the two laws as limits.

use super::{METHODS, near, position};
use crate::support::{Block, Ground, spread_start};
use stickslip::classification::{Outcome, simulate, simulate_by_recorded_equations};
use stickslip::model::{
    BallContact, Case, FrictionLaw, Machine, Method, Model, Simulation, Start, Tolerance,
};

fn case(model: impl Into<Model>, start: Start, method: Method, end_time_s: f64) -> Case {
    let simulation = Simulation {
        method,
        end_time_s,
        tolerance: Tolerance { relative: 1e-12, absolute: 1e-14 },
        ..Simulation::default()
    };
    Case { model: model.into(), start, simulation }
}

fn run(block: &Block, start: [f64; 2], method: Method, end_time_s: f64) -> Outcome {
    simulate(&case(block.clone(), Start(start.to_vec()), method, end_time_s))
}

fn block(drag: f64) -> Block {
    Block { friction: FrictionLaw::coulomb_viscous(drag), ..Block::on_spring() }
}

/// A block with more than critical damping creeps to the edge of the rest set, which it never reaches: in the closed
/// form its distance from there decays exponentially. The run is an equilibrium.
#[test]
fn an_overdamped_block_creeps_to_the_edge_of_the_rest_set() {
    for drag in [25.0, 60.0, 300.0] {
        for (start, edge) in [(0.05, 0.01), (-0.3, -0.01)] {
            let block = block(drag);
            let half = 0.5 * drag;
            let slowest = half - (half * half - 100.0).sqrt();
            for method in METHODS {
                let soon = 0.5 / slowest;
                let exact = Block { friction: FrictionLaw::viscous(drag), ..block.clone() };
                let exact = exact.damped_oscillation(start - edge, 0.0, soon).expect("viscous");
                let outcome = run(&block, [start, 0.0], method, soon);
                assert_eq!(outcome.evidence.name(), "end_time", "{drag} {method:?}");
                near(position(&outcome), edge + exact[0], 1e-10);
                let outcome = run(&block, [start, 0.0], method, 30.0 / slowest);
                let name = outcome.evidence.name();
                println!("{drag} {start} {method:?}: {name} {:?}", outcome.effort);
                assert!(["rest_certified", "creep"].contains(&name), "{drag} {method:?} {name}");
                near(position(&outcome), edge, 1e-8);
            }
        }
    }
}

/// On a belt the oscillation decays to steady sliding, where the spring balances Coulomb friction and drag.
#[test]
fn a_block_on_a_belt_slides_steadily() {
    for (drag, speed_m_s) in [(0.5, 0.1), (3.0, 0.5), (50.0, 0.1)] {
        let block = Block { ground: Ground::Belt { speed_m_s }, ..block(drag) };
        for method in METHODS {
            for start in [[0.0, speed_m_s], [0.1, 0.0], [-0.2, -1.0]] {
                let outcome = run(&block, start, method, 400.0);
                assert_eq!(outcome.evidence.name(), "settled", "{drag} {start:?} {method:?}");
                near(position(&outcome), 0.01 + drag * speed_m_s / 100.0, 1e-6);
            }
        }
    }
}

fn machine(friction: FrictionLaw, friction_coefficient: f64, speed_rad_s: f64) -> Machine {
    let mut machine = Machine { friction, speed_rad_s, ..Machine::default() };
    for ball in &mut machine.balls {
        ball.friction_coefficient = friction_coefficient;
    }
    machine
}

type Simulate = fn(&Case) -> Outcome;
const KERNELS: [Simulate; 2] = [simulate, simulate_by_recorded_equations];

/// Without drag, the outcome is that of Coulomb friction to the last bit, in both kernels.
#[test]
fn without_drag_the_outcome_is_that_of_coulomb_friction() {
    for method in METHODS {
        for kernel in KERNELS {
            let outcome = |law, speed, k, contact| {
                let model = Machine { contact, ..machine(law, 2.75e-3, speed) };
                kernel(&case(model, spread_start(k), method, 3.0))
            };
            let contact = Some(BallContact { restitution: 0.36, friction_coefficient: 0.1 });
            for (speed, contact) in [(-160.8103, None), (-216.3772, None), (-173.1803, contact)] {
                for k in 0..2 {
                    let both = outcome(FrictionLaw::coulomb_viscous(0.0), speed, k, contact);
                    let dry = outcome(FrictionLaw::COULOMB, speed, k, contact);
                    assert_eq!(both, dry, "{method:?} {speed} {k}");
                }
            }
        }
        let start = [0.12, -0.4];
        let dry = run(&Block::on_spring(), start, method, 9.0);
        assert_eq!(run(&block(0.0), start, method, 9.0), dry);
    }
}

/// With the friction coefficient 0, the motion is that of viscous drag.
#[test]
fn without_dry_friction_the_motion_is_that_of_viscous_drag() {
    let drag = 5e-4;
    for method in METHODS {
        for kernel in KERNELS {
            for k in 0..3 {
                let at = |friction, end| {
                    kernel(&case(machine(friction, 0.0, -309.15), spread_start(k), method, end))
                };
                let [both, viscous] =
                    [FrictionLaw::coulomb_viscous(drag), FrictionLaw::viscous(drag)]
                        .map(|law| at(law, 0.2).position.expect("known"));
                for (both, viscous) in both.iter().zip(&viscous) {
                    assert!((both - viscous).abs() < 1e-12, "{both} {viscous}");
                }
            }
        }
    }
}
