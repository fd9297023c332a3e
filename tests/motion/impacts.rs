//! Impacts of balls that are at each other at the start: their energy, displacements, and impacts that are not decided.

use std::f64::consts::TAU;
use std::sync::Arc;

use stickslip::model::{Ball, BallContact, Components, Machine, Method, Model, Start, System};
use stickslip::motion::{Failure, Motion, Phase};

use super::samples::{Sampler, compare_displacements};
use crate::support::settings;

/// Returns a machine of balls with these masses and diameters, over those of the default.
fn machine(contact: BallContact, balls: &[[f64; 2]]) -> Machine {
    let ball = |[mass, diameter]: &[f64; 2]| Ball {
        mass_kg: mass * Ball::default().mass_kg,
        diameter_m: diameter * Ball::default().diameter_m,
        ..Ball::default()
    };
    let balls = balls.iter().map(ball).collect();
    Machine { contact: Some(contact), balls, ..Machine::default() }
}

/// Returns the system and a state in which all balls are at each other, in one row from the angle `first`.
fn in_a_row(machine: &Machine, first: f64, speeds: &[f64]) -> (Arc<dyn System>, Components) {
    let mut beta = vec![first];
    for pair in machine.balls.windows(2) {
        let angle = machine.contact_angle_rad(&pair[0], &pair[1]);
        beta.push(beta[beta.len() - 1] + angle);
    }
    let start = Start::of_balancer([0.0; 2], &beta, [0.0; 2], speeds);
    let model = Model::from(machine.clone());
    let system = model.system_for(&start).expect("a system");
    (system, model.start_state(&start).expect("a state"))
}

/// The kinetic energy in the turning frame, in which the disc does no work.
pub fn kinetic(machine: &Machine, state: &[f64]) -> f64 {
    let (number, x_dot, y_dot) = (machine.balls.len(), state[2], state[3]);
    let balls = machine.balls.iter().enumerate().map(|(i, ball)| {
        let ((s, c), speed) = (state[4 + i].sin_cos(), state[4 + number + i]);
        let of_ball = (c * y_dot - s * x_dot) * speed + 0.5 * 1.4 * speed * speed;
        ball.mass_kg / machine.total_mass_kg() * of_ball
    });
    0.5 * (x_dot * x_dot + y_dot * y_dot) + balls.sum::<f64>()
}

/// How many of some random impacts have happened, and in how many of them Newton's law would have added energy.
fn random_impacts(sampler: &mut Sampler, number: usize, balls: usize) -> [usize; 2] {
    let (mut happened, mut limited) = (0, 0);
    for _ in 0..number {
        let contact = BallContact {
            restitution: sampler.one_of(&[0.0, 0.36, 0.9, 1.0, 1.0]),
            friction_coefficient: sampler.one_of(&[0.0, 0.05, 0.1, 0.3, 0.6]),
        };
        let spread = sampler.one_of(&[1.0, 3.0, 10.0]);
        let bodies: Vec<[f64; 2]> = (0..balls)
            .map(|_| [sampler.between(1.0 / spread, spread), sampler.between(0.5, 1.5)])
            .collect();
        let machine = machine(contact, &bodies);
        let mut speeds: Vec<f64> = (0..balls).map(|_| sampler.between(-1.0, 1.0)).collect();
        if sampler.between(0.0, 1.0) < 0.7 {
            // All gaps close.
            speeds.sort_by(|a, b| b.total_cmp(a));
        }
        let (system, before) = in_a_row(&machine, sampler.between(0.0, TAU), &speeds);
        let motion = match Motion::new(&system, settings(Method::Switch, 1e-8), &before) {
            Ok(motion) => motion,
            // The impact is decided, but not what follows.
            Err(Failure::ContactLost { .. }) => continue,
            Err(other) => panic!("{other}: {machine:?} {speeds:?}"),
        };
        let after = motion.state();
        let [before, after] = [&before, &after].map(|state| kinetic(&machine, state));
        assert!(after <= before * (1.0 + 1e-9), "{after} > {before}: {machine:?} {speeds:?}");
        let state = motion.state();
        let opening: Vec<f64> =
            (1..balls).map(|i| state[4 + balls + i] - state[3 + balls + i]).collect();
        assert!(opening.iter().all(|opening| *opening > -1e-12), "{opening:?}: {machine:?}");
        let approach = speeds[0] - speeds[1];
        if balls == 2 && approach > 0.0 {
            // Newton's law, or less where it would add energy.
            let short = opening[0] < contact.restitution * approach - 1e-9;
            assert!(opening[0] <= contact.restitution * approach + 1e-9);
            assert!(!short || after > before * (1.0 - 1e-12));
            limited += usize::from(short);
        }
        happened += 1;
    }
    [happened, limited]
}

/// No impact of two to eight balls adds energy, with any restitution, friction and masses.
#[test]
fn impacts_add_no_energy() {
    let mut sampler = Sampler::new(9);
    for (balls, number) in [(2, 4000), (3, 3000), (4, 2000), (5, 1000), (6, 300), (7, 100), (8, 20)]
    {
        let [happened, limited] = random_impacts(&mut sampler, number, balls);
        assert!(happened > number * 8 / 10, "{happened} of {number} with {balls} balls");
        assert!(balls > 2 || limited > 50, "{limited}");
    }
}

/// Displacements pass through an impact in which Newton's law would add energy, against central differences.
#[test]
fn displacements_pass_through_impacts_that_conserve_energy() {
    let contact = BallContact { restitution: 1.0, friction_coefficient: 0.1 };
    let machine = machine(contact, &[[1.0, 1.0], [3.0, 1.0]]);
    let (system, mut state) = in_a_row(&machine, 1.0, &[1.0, -0.1]);
    state[5] += 0.05;
    let settings = settings(Method::Event, 1e-12);
    let places = [0, 1, 2, 3, 4, 5, 6, 7];
    let (motion, _) = compare_displacements(&system, settings, &state, &places, 0.1, [1e-6; 2]);
    let separation = motion.state()[7] - motion.state()[6];
    assert!(separation > 0.5 && separation < 1.09, "Newton's law would give 1.1: {separation}");
}

/// Displacements of a motion with impacts, and of one that ends in lasting contact, against central differences.
#[test]
fn displacements_pass_through_impacts_and_lasting_contact() {
    for (restitution, end, closes) in [(0.9, 12.0, false), (0.0, 6.0, true)] {
        let contact = Some(BallContact { restitution, friction_coefficient: 0.1 });
        let model = Model::from(Machine { contact, ..Machine::default() });
        let start = Start::of_balancer([0.01, 0.02], &[1.0, 1.45], [0.0; 2], &[0.35, 0.25]);
        let system = model.system_for(&start).expect("a system");
        let state = model.start_state(&start).expect("a state");
        let settings = settings(Method::Event, 1e-12);
        let places = [0, 1, 2, 3, 4, 5, 6, 7];
        let (motion, events) =
            compare_displacements(&system, settings, &state, &places, end, [1e-6, 1e-4]);
        assert!(events > 0);
        assert_eq!(motion.phases()[2..].contains(&Phase::Closed), closes);
    }
}

/// Large balls jam where their friction exceeds `tan(π/4 - Δ/4)`, here 0.66: the impact has two solutions, and none is
/// chosen.
#[test]
fn an_impact_with_several_solutions_is_refused() {
    for (friction_coefficient, solutions) in [(0.6, 1), (0.8, 2)] {
        let contact = BallContact { restitution: 0.36, friction_coefficient };
        let machine = machine(contact, &[[1.0, 2.9855]; 3]);
        let (system, state) = in_a_row(&machine, 1.0, &[0.9, 0.6, 0.5]);
        let started = Motion::new(&system, settings(Method::Switch, 1e-8), &state);
        match started {
            Ok(_) => assert_eq!(solutions, 1),
            Err(failure) => assert_eq!(failure, Failure::UndecidedImpact { solutions }),
        }
    }
    let message = Failure::UndecidedImpact { solutions: 2 }.to_string();
    assert_eq!(message, "2 different combinations of impulses meet all conditions of an impact");
}
