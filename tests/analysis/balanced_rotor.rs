//! A rotor without imbalance: no direction is distinguished, two equal balls balance opposite each other, and no
//! amplitude is relative to the machine without balls.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use stickslip::analysis::{
    Balance, FrictionlessKind as Kind, RestForm, Stability, amplitude_extremes,
    frictionless_equilibria, reference_amplitude,
};
use stickslip::engine::WorkerPool;
use stickslip::model::{Ball, Machine};
use stickslip::responses::{DesignToEvaluate, respond};
use stickslip::study::DesignValue;

use crate::support::parse;

fn rotor(balls: &[f64], damping_n_s_m: f64) -> Machine {
    let ball = |mass_kg| Ball { mass_kg, ..Ball::default() };
    Machine {
        imbalance_mass_kg: 0.0,
        balls: balls.iter().copied().map(ball).collect(),
        damping_n_s_m,
        ..Machine::default()
    }
}

/// Σ m e^{iβ} of the balls.
fn sum(machine: &Machine, beta: &[f64]) -> f64 {
    let part = |of: fn(f64) -> f64| -> f64 {
        machine.balls.iter().zip(beta).map(|(ball, beta)| ball.mass_kg * of(*beta)).sum()
    };
    part(f64::cos).hypot(part(f64::sin))
}

#[test]
fn equal_balls_balance_opposite_each_other() {
    for (balls, dimension) in [
        (vec![1.4e-4; 2], 1),
        (vec![1.4e-4; 3], 1),
        (vec![1.4e-4; 4], 2),
        (vec![1e-4, 2e-4, 2.5e-4], 1),
    ] {
        let machine = rotor(&balls, 1.28);
        machine.validate().expect("a balanced rotor is a machine");
        let form = RestForm::new(&machine).expect("a rotor with balls");
        let Balance::Family { example, dimension: found } = Balance::of(&form) else {
            panic!("{balls:?}: {:?}", Balance::of(&form))
        };
        assert_eq!(found, dimension, "{balls:?}");
        assert!(sum(&machine, &example) < 1e-15 * 1e-3, "{balls:?}: {example:?}");
        let found =
            frictionless_equilibria(&machine, 1e4).expect("a number of balls that has equilibria");
        let balanced =
            found.iter().find(|equilibrium| equilibrium.kind == Kind::B1).expect("balanced");
        assert_eq!(balanced.amplitude_m(), 0.0);
        // The example of four equal balls has all of them on one line, where the linearisation is marginal.
        if balls.len() < 4 {
            assert_eq!(balanced.stability, Stability::Stable, "above the natural frequency");
        }
    }
    for balls in [vec![1.4e-4], vec![1.4e-4, 1.5e-4], vec![1e-4, 1e-4, 3e-4]] {
        let form = RestForm::new(&rotor(&balls, 1.28)).expect("a rotor with balls");
        assert_eq!(Balance::of(&form), Balance::Nowhere, "{balls:?}");
    }
}

/// With damping, nothing holds unbalanced balls without friction. Without damping, one ball rests at any angle.
#[test]
fn lines_without_friction() {
    let none = frictionless_equilibria(&rotor(&[1.4e-4], 1.28), 1e4)
        .expect("a number of balls that has equilibria");
    assert!(none.is_empty(), "{none:?}");
    let found = frictionless_equilibria(&rotor(&[1.4e-4], 0.0), 1e4)
        .expect("a number of balls that has equilibria");
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].kind, found[0].family_dimension), (Kind::A1Plus, 1));
    // The table moves by g m, where g = ω² / (1 - ω²) and masses are over the whole mass.
    let machine = rotor(&[1.4e-4], 0.0);
    let speed = machine.speed_rad_s / machine.natural_frequency_rad_s();
    let mass = 1.4e-4 / machine.total_mass_kg();
    let expected = (speed * speed / (1.0 - speed * speed)).abs() * mass * machine.ring_radius_m;
    assert!((found[0].amplitude_m() / expected - 1.0).abs() < 1e-12);
}

/// Turning all balls together changes nothing: the set of one ball is the whole circle or empty, depending on whether
/// friction holds the ball at one angle.
#[test]
fn all_directions_are_equivalent() {
    for friction_coefficient in [1e-6, 2.75e-3, 1.0] {
        let mut machine = rotor(&[1.4e-4], 1.28);
        machine.balls[0].friction_coefficient = friction_coefficient;
        let form = RestForm::new(&machine).expect("a rotor with balls");
        let held = |angle: f64| form.at_rest(&[angle]).in_set();
        let angles: Vec<bool> = (0..8).map(|eighth| held(f64::from(eighth) * PI / 4.0)).collect();
        assert!(angles.iter().all(|held| *held == angles[0]), "{angles:?}");
        assert_eq!(amplitude_extremes(&form), [None, None]);
    }
    assert_eq!(reference_amplitude(&rotor(&[1.4e-4], 1.28)), Some(0.0));
}

/// A relative response has no value and says why; the absolute one has a value.
#[test]
fn relative_responses_are_null_with_a_reason() {
    let text = "
schema: 1
name: a
seed: 5
model: {kind: ball_balancer, parameters: {imbalance_mass_kg: 0}}
initial_conditions: {design: {monte_carlo: {samples: 4}}}
simulation: {end_time_s: 0.2, endings: rest}
responses:
  mean: {amplitude_mean: {}}
  relative: {amplitude_mean: {relative: true}}
  above: {amplitude_above: {limit: 1.0, relative: true}}
design: {speed_rad_s: {from: -220, to: -200}}
";
    let study = parse(text);
    let design = [DesignValue::Number(-210.0)];
    let set = study.set(&design).expect("a design");
    let stop = AtomicBool::new(false);
    let workers = WorkerPool::new(1).expect("a worker");
    let design = DesignToEvaluate { number: 0, values: &design, plans: vec![Cow::Owned(set)] };
    let answers = respond(&workers, study.responses(), design, &stop, &|_| {});
    let answers = answers.expect("not stopped");
    let [mean, relative, above] = &answers[0].estimates[..] else { panic!("{answers:?}") };
    assert!(mean.value.is_some_and(|value| value > 0.0), "{mean:?}");
    for estimate in [relative, above] {
        assert_eq!((estimate.value, estimate.low, estimate.high), (None, None, None));
        let reason = estimate.reason.as_deref().unwrap_or_default();
        assert!(reason.contains("without balls does not vibrate"), "{reason}");
    }
}
