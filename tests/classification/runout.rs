//! Balls in a ring with runout: rests against the conditions of friction in complex numbers, and the vibration that free
//! balls leave.

use std::f64::consts::PI;

use nalgebra::Complex;
use stickslip::analysis::set_fraction;
use stickslip::classification::{Label, simulate, simulate_by_recorded_equations};
use stickslip::model::{Ball, BallContact, Case, Machine, Simulation, Start};

fn machine(speed_rad_s: f64, friction_coefficient: f64, ring_runout_m: f64) -> Machine {
    let ball = Ball { friction_coefficient, ..Ball::default() };
    Machine {
        speed_rad_s,
        balls: vec![ball; 2],
        ring_runout_m,
        ring_runout_angle_rad: 2.0,
        ..Machine::default()
    }
}

fn case(machine: &Machine, k: u32, end_time_s: f64) -> Case {
    let spread = |factor: f64| (f64::from(k) * factor + 0.3).sin();
    let start = Start::of_balancer(
        [0.01 * spread(1.1), 0.01 * spread(2.3)],
        &[3.0 + 3.0 * spread(3.1), 3.0 + 3.0 * spread(4.7)],
        [0.0; 2],
        &[0.3 * spread(8.9), 0.3 * spread(10.7)],
    );
    let simulation = Simulation { end_time_s, ..Simulation::default() };
    Case { model: machine.clone().into(), start, simulation }
}

/// Returns the amplitude of the table, m, and the friction coefficient that each ball needs, with the balls at rest: in
/// metres and kilograms, with the table as an oscillator that turning masses force.
fn at_rest(machine: &Machine, beta: &[f64]) -> (f64, Vec<f64>) {
    let square = machine.speed_rad_s * machine.speed_rad_s;
    let runout = Complex::from_polar(machine.ring_runout_m, machine.ring_runout_angle_rad);
    let outward: Vec<_> = beta.iter().map(|beta| Complex::from_polar(1.0, *beta)).collect();
    let places = outward.iter().map(|outward| runout + outward * machine.ring_radius_m);
    let balls = machine.balls.iter().zip(places).map(|(ball, place)| place * ball.mass_kg);
    let imbalance = Complex::from(machine.imbalance_mass_kg * machine.imbalance_radius_m);
    let unbalance = imbalance + balls.sum::<Complex<f64>>();
    let stiffness = Complex::new(
        machine.stiffness_n_m - machine.total_mass_kg() * square,
        machine.damping_n_s_m * machine.speed_rad_s,
    );
    let table = unbalance * square / stiffness;
    // A ball on a circle about the axis feels its distance from the axis.
    let needed = outward.iter().map(|outward| {
        let from_axis = (table + runout + outward * machine.ring_radius_m) * outward.conj();
        from_axis.im.abs() / from_axis.re
    });
    (table.norm(), needed.collect())
}

/// Balls rest where friction holds them in the eccentric ring, with the table's amplitude there, also where they touch;
/// many of these positions are none of a ring without runout, and the reverse.
#[test]
fn rests_are_those_of_the_eccentric_ring() {
    let mut counts = [0; 3];
    for (speed, runout_m) in [(-216.3772, 1.5e-5), (-160.8103, 2e-5), (-309.15, 2.5e-5)] {
        for contact in [None, Some(BallContact { restitution: 0.36, friction_coefficient: 0.0 })] {
            let machine = Machine { contact, ..machine(speed, 1.5e-3, runout_m) };
            let centred = Machine { ring_runout_m: 0.0, ..machine.clone() };
            for k in 0..12 {
                let outcome = simulate(&case(&machine, k, 20.0));
                if outcome.label() != Label::Equilibrium {
                    continue;
                }
                let beta = outcome.position.as_ref().expect("a place of rest");
                let (amplitude_m, needed) = at_rest(&machine, beta);
                let found_m = outcome.amplitude_m.expect("an amplitude");
                assert!((found_m - amplitude_m).abs() < 1e-9 * amplitude_m, "{speed} {k}");
                let apart = (beta[1] - beta[0]).sin().abs() > 0.3;
                let holds = |needed: &[f64]| needed.iter().all(|needed| *needed <= 1.5e-3 + 1e-9);
                assert!(holds(&needed) || !apart, "{speed} {k} {needed:?}");
                counts[0] += 1;
                counts[1] += usize::from(!holds(&at_rest(&centred, beta).1));
                counts[2] += usize::from(contact.is_some() && !apart);
            }
        }
    }
    let [rests, only_with_runout, touching] = counts;
    assert!(rests > 20 && only_with_runout > 5 && touching > 2, "{counts:?}");
}

/// Above the natural frequency free balls bring the ring's centre to the axis: the vibration that they leave is the runout,
/// up to the friction. Both kernels give the same.
#[test]
fn free_balls_leave_the_runout_as_vibration() {
    let (friction, mut crossed) = (1e-4, 0);
    for runout_m in [1e-5, 2e-5] {
        let machine = Machine { ring_runout_angle_rad: 0.5, ..machine(-250.0, friction, runout_m) };
        for simulate in [simulate, simulate_by_recorded_equations] {
            for k in 0..3 {
                let outcome = simulate(&case(&machine, k, 60.0));
                assert_eq!(outcome.label(), Label::Equilibrium, "{runout_m} {k}");
                let left_m = outcome.amplitude_m.expect("an amplitude");
                let beta = outcome.position.as_ref().expect("a place of rest");
                // Each ball holds the ring's centre near the axis along its own tangent.
                let crossing = (beta[1] - beta[0]).sin().abs();
                let most_m = 2.01 * friction / crossing * machine.ring_radius_m;
                assert!((left_m - runout_m).abs() < most_m, "{runout_m} {left_m} {beta:?}");
                crossed += u32::from(crossing > 0.2);
            }
        }
    }
    assert!(crossed > 4, "{crossed}");
}

/// Where the runout exceeds what friction holds, a ball rests only near the direction of the ring's centre from the axis or
/// opposite, in arcs of `2 asin(μ L / ε)`. The ring's centre is within a quarter of `ε`, because the balls are light.
#[test]
fn an_eccentric_ring_holds_balls_in_two_arcs() {
    let friction = 1.5e-3;
    let fraction = |runout_m| {
        set_fraction(&machine(-309.15, friction, runout_m)).expect("the fraction of two balls")
    };
    assert!(fraction(0.0) > fraction(1.5e-5) && fraction(1.5e-5) > fraction(1e-4));
    for runout_m in [1e-4, 1.5e-4] {
        let arcs = |from_axis: f64| {
            (2.0 / PI * (friction * machine(0.0, 0.0, 0.0).ring_radius_m / from_axis).asin())
                .powi(2)
        };
        let found = fraction(runout_m);
        assert!(arcs(1.25 * runout_m) < found && found < arcs(0.75 * runout_m), "{found}");
    }
}
