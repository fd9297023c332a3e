//! The 2×2 form of the equations against the thesis's matrices, in all nine configurations.

use super::thesis_matrices::{Configuration, extended_lagrange};
use crate::support::TestRng;
use stickslip::model::{Balancer, Contact, Friction, Machine, NormalForce, State};

fn contact(configuration: Configuration, coefficient: f64) -> Contact {
    match configuration {
        Configuration::Stick => Contact::STICK,
        Configuration::Slip(sign) => Friction::coulomb(coefficient).slip(sign, 0.0),
    }
}

/// Accelerations, normal and friction forces agree with thesis equations 3.13-3.16 and appendix C
/// to 1e-12 of the largest force, on 2000 random states and machines, in every configuration.
#[test]
fn same_accelerations_and_forces_in_all_configurations() {
    let mut draws = TestRng::new(5);
    let kinds = [Configuration::Stick, Configuration::Slip(1.0), Configuration::Slip(-1.0)];
    for trial in 0..2000 {
        let mut machine = Machine { speed_rad_s: -400.0 * draws.uniform(), ..Machine::default() };
        machine.normal_force =
            if trial % 2 == 0 { NormalForce::Lagrange } else { NormalForce::Newton };
        for ball in &mut machine.balls {
            ball.mass_kg *= 0.1 + 20.0 * draws.uniform();
            ball.diameter_m *= 0.5 + draws.uniform();
            ball.friction_coefficient *= 100.0 * draws.uniform();
        }
        let balancer = Balancer::<2>::new(&machine).expect("two balls");
        let mut spread = |width: f64| width * (2.0 * draws.uniform() - 1.0);
        let state = State {
            position: [spread(0.1), spread(0.1)],
            velocity: [spread(0.1), spread(0.1)],
            beta: [spread(7.0), spread(7.0)],
            beta_dot: [spread(2.0), spread(2.0)],
        };
        for first in kinds {
            for second in kinds {
                let configurations = [first, second];
                let contacts = [0, 1]
                    .map(|i| contact(configurations[i], balancer.balls[i].friction.coefficient));
                let fast = balancer.forces(&state, &contacts);
                let thesis = extended_lagrange(&balancer, &state, configurations)
                    .expect("the thesis's matrices are regular");
                let flat = |f: &stickslip::model::Forces<2>| {
                    [f.table_acceleration, f.beta_ddot, f.normal, f.friction].concat()
                };
                let (fast, thesis) = (flat(&fast), flat(&thesis));
                let scale = thesis.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                for (a, b) in fast.iter().zip(&thesis) {
                    assert!((a - b).abs() <= 1e-12 * scale, "{configurations:?}: {a} {b}");
                }
            }
        }
    }
}
