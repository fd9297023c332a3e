//! Numbers from closed forms and equilibrium sets.

use std::fmt::Write;

use stickslip::analysis::{
    EquilibriumSet, FrictionlessKind, Resolution, Stability, frictionless_equilibria,
    reference_amplitude,
};
use stickslip::model::{Balancer, Machine};

fn machine(speed_rad_s: f64, friction_coefficient: f64) -> Machine {
    let mut machine = Machine { speed_rad_s, ..Machine::default() };
    for ball in &mut machine.balls {
        ball.friction_coefficient = friction_coefficient;
    }
    machine
}

pub fn closed_forms() -> String {
    let machine = Machine::default();
    let natural = machine.natural_frequency_rad_s();
    let balancer = Balancer::<2>::new(&machine).expect("two balls");
    let amplitude = |beta: [f64; 2]| balancer.rest_amplitude(&beta) * machine.ring_radius_m;
    let set = EquilibriumSet::of(&machine, Resolution::Grid(64)).expect("two balls");
    let balance = set.balance.position().expect("these balls can balance");
    let [low, high] = speeds_without_a1();
    format!(
        "\
| quantity | thesis | program |
|---|---|---|
| natural frequency | 182 rad/s, 28.9 Hz | {natural:.3} rad/s, {:.3} Hz |
| amplitude without balls, -216.3772 rad/s | 2.15e-5 m | {:.4e} m |
| amplitude with both balls opposite each other, -216.3772 rad/s | | {:.4e} m |
| amplitude with both balls at the imbalance, -216.3772 rad/s | 5.51e-5 m | {:.4e} m |
| balancing angles | 2.27, 4.01 rad | {:.4}, {:.4} rad |
| A1+ and A1- vanish for abs(ω) in | [179, 184] rad/s | [{low:.2}, {high:.2}] rad/s |
",
        natural / std::f64::consts::TAU,
        reference_amplitude(&machine).expect("a damped suspension"),
        amplitude([0.0, std::f64::consts::PI]),
        amplitude([0.0, 0.0]),
        balance[0],
        balance[1],
    )
}

/// The drag on the balls for the stability: high, as in the thesis.
const DRAG: f64 = 1e4;

fn kinds_at(speed_rad_s: f64) -> Vec<(FrictionlessKind, Stability)> {
    let machine = Machine { speed_rad_s, ..Machine::default() };
    let found = frictionless_equilibria(&machine, DRAG).expect("two balls");
    found.into_iter().map(|equilibrium| (equilibrium.kind, equilibrium.stability)).collect()
}

/// Returns the speeds at which the equilibria with both balls together vanish and reappear, by
/// bisection.
fn speeds_without_a1() -> [f64; 2] {
    let together =
        |speed: f64| kinds_at(-speed).iter().any(|(kind, _)| *kind == FrictionlessKind::A1Plus);
    [(150.0, 181.0), (300.0, 182.0)].map(|(mut there, mut gone)| {
        assert!(together(there) && !together(gone));
        while f64::abs(there - gone) > 1e-6 {
            let middle = 0.5 * (there + gone);
            if together(middle) { there = middle } else { gone = middle }
        }
        there
    })
}

pub fn frictionless() -> String {
    let mut text = "\
| speed [rad/s] | equilibria | stable |
|---|---|---|
"
    .to_owned();
    for speed in [-150.0, -170.0, -179.0, -181.0, -183.0, -185.0, -216.3772, -300.0] {
        let kinds = kinds_at(speed);
        let named = |stable_only: bool| {
            let names: Vec<&str> = kinds
                .iter()
                .filter(|(_, stability)| !stable_only || *stability == Stability::Stable)
                .map(|(kind, _)| kind.name())
                .collect();
            if names.is_empty() { "none".to_owned() } else { names.join(", ") }
        };
        let _ = writeln!(text, "| {speed} | {} | {} |", named(false), named(true));
    }
    text
}

pub fn equilibrium_sets() -> String {
    let mut text = "\
| speed [rad/s] | μ | fraction of all positions | components | components modulo exchange | smallest amplitude [m] | largest amplitude [m] |
|---|---|---|---|---|---|---|
"
    .to_owned();
    let points = [
        (-216.3772, 2.75e-4),
        (-216.3772, 2.75e-3),
        (-216.3772, 3.5e-3),
        (-191.6372, 2.75e-3),
        (-179.2671, 2.75e-3),
        (-173.1803, 2.75e-3),
        (-160.8103, 2.75e-3),
    ];
    for (speed, friction) in points {
        let set = EquilibriumSet::of(&machine(speed, friction), Resolution::Grid(2048))
            .expect("two balls");
        let (smallest, largest) = set.amplitude_m.expect("there is a set");
        let _ = writeln!(
            text,
            "| {speed} | {friction:e} | {:.4} | {} | {} | {smallest:.3e} | {largest:.3e} |",
            set.fraction,
            set.components.expect("a grid"),
            set.components_modulo_exchange.expect("a grid"),
        );
    }
    text
}

/// Returns the smallest principal minor of the contact matrix of the thesis's machine.
pub fn least_minor() -> String {
    format!("{:.8}", Machine::default().existence().least_minor())
}
