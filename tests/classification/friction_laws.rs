//! The ball balancer under laws of friction other than Coulomb's.

use stickslip::classification::{Outcome, simulate};
use stickslip::model::{Balancer, Case, FrictionLaw, Machine, Method, Simulation, Start};

fn run(machine: &Machine, start: &Start, method: Method, end_time_s: f64) -> Outcome {
    let simulation = Simulation { method, end_time_s, ..Simulation::default() };
    simulate(&Case { model: machine.clone().into(), start: start.clone(), simulation })
}

fn with(friction: FrictionLaw) -> Machine {
    Machine { friction, ..Machine::default() }
}

/// Table and balls at rest, where Coulomb friction holds the balls with half of its limit.
fn at_rest() -> (Vec<f64>, Start) {
    let balancer = Balancer::<2>::new(&Machine::default()).expect("two balls");
    let beta = (0..1000)
        .map(|k| [1.5 + 1e-3 * f64::from(k), 4.4])
        .find(|beta| {
            let used = balancer.friction_use(&balancer.rest_point(beta), 0.0);
            (0.45..0.55).contains(&used)
        })
        .expect("somewhere");
    let [x, y] = balancer.rest_point(&beta).position;
    (beta.to_vec(), Start::of_balancer([x, y], &beta, [0.0; 2], &[0.0; 2]))
}

/// With a static coefficient above the kinetic one, balls stay where Coulomb friction with the
/// kinetic one would release them; with equal coefficients the law is Coulomb's, bit for bit.
#[test]
fn static_friction_holds_more() {
    let (_, start) = at_rest();
    let stribeck = |static_friction_coefficient, stribeck_speed, friction_coefficient| {
        let law = FrictionLaw::stribeck(static_friction_coefficient, stribeck_speed);
        let mut machine = with(law);
        for ball in &mut machine.balls {
            ball.friction_coefficient = friction_coefficient;
        }
        machine
    };
    let mut slippery = with(FrictionLaw::COULOMB);
    for ball in &mut slippery.balls {
        ball.friction_coefficient = 1e-3;
    }
    for method in [Method::Event, Method::Switch] {
        let left = run(&slippery, &start, method, 2.0);
        assert_ne!(left.time_to_rest_s(), Some(0.0));
        for speed in [0.0, 3.0] {
            let held = run(&stribeck(2.75e-3, speed, 1e-3), &start, method, 2.0);
            assert_eq!(held.evidence.name(), "rest_certified");
            assert_eq!(held.time_to_rest_s(), Some(0.0));
        }
        let moving = Start::of_balancer([0.03, -0.02], &[1.0, 5.0], [0.01, 0.04], &[0.5, -0.7]);
        for speed in [0.0, 3.0] {
            let equal = run(&stribeck(2.75e-3, speed, 2.75e-3), &moving, method, 5.0);
            assert_eq!(equal, run(&with(FrictionLaw::COULOMB), &moving, method, 5.0));
        }
    }
}
