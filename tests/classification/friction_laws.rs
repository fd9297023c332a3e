//! The ball balancer under laws of friction other than Coulomb's.

use stickslip::classification::{Outcome, simulate};
use stickslip::model::{Balancer, Case, FrictionLaw, Machine, Method, Simulation, Start};

use crate::support::angular_distance;

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

/// Smoothed friction cannot hold a ball (thesis section 3.3.1): from a state in which Coulomb
/// friction holds both balls, they creep towards the balancing angles, more slowly for steeper
/// laws.
#[test]
fn smooth_friction_lets_resting_balls_creep() {
    let (beta, start) = at_rest();
    for method in [Method::Event, Method::Switch] {
        let held = run(&with(FrictionLaw::COULOMB), &start, method, 20.0);
        assert_eq!(held.evidence.name(), "rest_certified");
        assert_eq!(held.time_to_rest_s(), Some(0.0));
        let mut crept = Vec::new();
        for smoothing_speed in [1e-3, 1e-2] {
            let machine = with(FrictionLaw::smooth(smoothing_speed));
            let outcome = run(&machine, &start, method, 20.0);
            assert_ne!(outcome.evidence.name(), "rest_certified");
            let end = outcome.position.expect("known");
            let moved =
                |end: &[f64]| (0..2).map(|i| angular_distance(end[i], beta[i])).fold(0.0, f64::max);
            crept.push(moved(&end));
        }
        // A ball held with a fraction `s` of the limit creeps with `v_0 tan(π s / 2)`, here with 45
        // to 55 %: about 2 hundredths of a radian in 20 s, and for ten times the speed nearly ten
        // times that, because the tangential force decreases on the way.
        let fraction = |s: f64| 0.02 * (std::f64::consts::FRAC_PI_2 * s).tan();
        assert!((fraction(0.45)..fraction(0.56)).contains(&crept[0]), "{crept:?}");
        assert!((7.0..10.0).contains(&(crept[1] / crept[0])), "{crept:?}");
    }
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
