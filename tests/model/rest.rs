//! Rest points, residual amplitudes and required friction of the thesis.

use stickslip::model::{Balancer, Machine};

use crate::support::required_friction;

fn thesis(balls: usize) -> (Machine, f64) {
    let mut machine = Machine::default();
    machine.balls.truncate(balls);
    let radius = machine.ring_radius_m;
    (machine, radius)
}

/// Thesis sections 3.6 and 5.2: natural frequency and the amplitudes at -216.3772 rad/s.
#[test]
fn thesis_amplitudes_and_balancing_angles() {
    let (machine, radius) = thesis(2);
    assert!((machine.natural_frequency_rad_s() - 181.633).abs() < 5e-4);
    let balancer = Balancer::<2>::new(&machine).unwrap();
    let together = balancer.rest_amplitude(&[0.0, 0.0]) * radius;
    assert!((together - 5.514e-5).abs() < 5e-9, "{together}");

    // The balls' centrifugal forces cancel; their mass still counts.
    let opposite = balancer.rest_amplitude(&[1.0, 1.0 + std::f64::consts::PI]) * radius;
    assert!((opposite - 2.159e-5).abs() < 5e-9, "{opposite}");

    let cosine = -machine.imbalance_mass_kg * machine.imbalance_radius_m
        / (2.0 * machine.balls[0].mass_kg * radius);
    let angle = cosine.acos();
    assert!((angle - 2.270).abs() < 5e-4 && (std::f64::consts::TAU - angle - 4.013).abs() < 5e-4);
    assert!(balancer.rest_amplitude(&[angle, -angle]) < 1e-15);
    assert!(required_friction(&balancer, &[angle, -angle]) < 1e-14);
}

/// Thesis section 5.2.1: at 3.5e-3 every position of the balls is an equilibrium at -216 rad/s.
#[test]
fn whole_torus_is_equilibrium_above_3_5e_3() {
    let balancer = Balancer::<2>::new(&Machine::default()).unwrap();
    let mut most: f64 = 0.0;
    for i in 0..200 {
        for j in 0..200 {
            let beta = [f64::from(i), f64::from(j)].map(|k| k * std::f64::consts::TAU / 200.0);
            most = most.max(required_friction(&balancer, &beta));
        }
    }
    assert!(most < 3.5e-3 && most > 2.75e-3, "{most}");
}
