//! Equilibrium sets and equilibria without friction of any system, against the closed forms of the balancer.

use std::f64::consts::TAU;

use stickslip::analysis::{
    EquilibriumSet, REPLICATES, Resolution, RestForm, frictionless_equilibria,
};
use stickslip::check::{HeldSet, SteadySearch, SteadyValues};
use stickslip::model::Machine;

use crate::support::{angular_distance, balancer_of_a_file, parse};

const DESIGN: &str = "initial_conditions: {design: {monte_carlo: {samples: 2}}}\n";

/// Calls a function with the search in a balancer that is written as a file, at some speeds.
fn at_some_speeds(examine: impl Fn(&Machine, &SteadySearch<'_>)) {
    for speed_rad_s in [-160.8103, -179.2671, -185.0, -216.3772] {
        let machine = Machine { speed_rad_s, ..Machine::default() };
        let study = parse(balancer_of_a_file(&machine) + DESIGN);
        let ranges = study.point(0).start_ranges;
        examine(&machine, &SteadySearch::new(study.model(), &ranges).expect("it does not change"));
    }
}

/// Of the balancer, friction margins and the size of the equilibrium set have closed forms (thesis section 5.2).
#[test]
fn the_set_of_a_balancer_in_a_file_is_that_of_the_closed_form() {
    at_some_speeds(|machine, search| {
        let set = HeldSet::of(search, 256);
        let form = RestForm::new(machine).expect("two balls");
        assert_eq!(set.positions.len(), 256 * REPLICATES as usize);
        for position in &set.positions {
            let rest = form.at_rest(&position.coordinates[2..]);
            let margin = position.friction_margin.expect("the balls are pressed to the ring");
            assert!(
                (margin - rest.friction_margin()).abs() < 1e-8 * (1.0 + margin.abs()),
                "{margin}"
            );
            assert_eq!(position.is_held(), rest.in_set());
        }
        let closed =
            EquilibriumSet::of(machine, Resolution::Grid(512)).expect("two balls").fraction;
        let (fraction, (low, high)) = set.fraction.expect("balls stick");
        // The interval is one of 95 %; the width is doubled.
        let width = high - low;
        assert!((low - 0.5 * width..=high + 0.5 * width).contains(&closed), "{fraction}, {closed}");
        assert!(width < 0.03, "{width}");
    });
}

/// All equilibria without friction are found, with the eigenvalues of the linearised equations.
#[test]
fn equilibria_without_friction_are_those_of_the_closed_form() {
    let angles = |state: &SteadyValues| {
        let mut angles = [1, 2].map(|ball| state.coordinates[&format!("beta_{ball}_rad")]);
        angles.sort_by(f64::total_cmp);
        angles
    };
    let is_near = |left: &[f64], right: &[f64]| {
        let near = |(left, right): (&f64, &f64)| angular_distance(*left, *right) < 1e-7;
        left.iter().zip(right).all(near)
    };
    at_some_speeds(|machine, search| {
        let natural = machine.natural_frequency_rad_s();
        let found = search.without_dry_friction();
        let closed = frictionless_equilibria(machine, 0.0).expect("two balls");
        // The closed forms stand for their exchanges and mirror images.
        for closed in &closed {
            let beta = closed.beta_rad.as_ref().expect("a position");
            let found = found.iter().find(|state| is_near(&angles(state), beta)).expect("found");
            assert_eq!(found.family_dimension, 0);
            let eigenvalues = found.eigenvalues_1_s.iter().zip(&closed.eigenvalues_per_s);
            for (found, expected) in eigenvalues {
                // The file's time is without dimension. Double eigenvalues are accurate to half of the digits.
                let error = (found * natural - expected).norm();
                assert!(error < 1e-5 * natural, "{beta:?}: {found} {expected}");
            }
        }
        for state in &found {
            let [first, second] = angles(state);
            let mirrored = [TAU - second, TAU - first].map(|angle| angle.rem_euclid(TAU));
            let is_closed = closed.iter().any(|closed| {
                let beta = closed.beta_rad.as_ref().expect("a position");
                is_near(&[first, second], beta) || is_near(&mirrored, beta)
            });
            assert!(is_closed, "{state:?} {closed:?}");
        }
    });
}

/// A body without a spring has a family of equilibria without friction; one of them is reported.
#[test]
fn of_a_family_one_state_is_reported() {
    let study = parse(format!(
        "schema: 1\nname: a\nseed: 1\nmodel:\n  system:\n    system: a\n    parameters: {{k: 2, mu: 0.1}}\n    \
         coordinates: {{x: {{start: [-1, 1]}}, y: {{start: [-1, 1]}}}}\n    mass: {{x: {{x: 1}}, y: {{y: 1}}}}\n    \
         force: {{x: -k * (x - y^2), y: -y'}}\n    \
         contacts: {{ground: {{normal: 1, sliding: x', friction: {{coulomb: {{coefficient: mu}}}}}}}}\n{DESIGN}"
    ));
    let ranges = study.point(0).start_ranges;
    let search = SteadySearch::new(study.model(), &ranges).expect("it does not change");
    let [state] = &search.without_dry_friction()[..] else { panic!("one") };
    assert_eq!(state.family_dimension, 1);
    let [x, y] = ["x", "y"].map(|name| state.coordinates[name]);
    assert!((x - y * y).abs() < 1e-9, "{state:?}");
    let set = HeldSet::of(&search, 1024);
    // Friction holds `|x - y²| <= mu / k`: half of the mean length of this interval within [-1, 1].
    let edge = 0.95_f64.sqrt();
    let integral = |y: f64| 0.5 * (1.05 * y - y.powi(3) / 3.0);
    let exact = 0.05 * edge + integral(1.0) - integral(edge);
    let (fraction, _) = set.fraction.expect("it sticks");
    assert!((fraction - exact).abs() < 5e-3, "{fraction} {exact}");
}
