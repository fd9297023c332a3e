//! Equilibria without friction: the thesis's figure 5.1, a numerical search for equilibria that the
//! closed forms could miss, and the forces that must vanish.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use stickslip::analysis::{
    FrictionlessEquilibrium, FrictionlessKind as Kind, RestForm, SmallMotions, Stability,
    frictionless_equilibria, sorted_where_identical,
};
use stickslip::model::{Balancer, Ball, Machine};

use crate::support::angular_distance;

/// A high drag in the sense of the thesis.
const HIGH: f64 = 1e4;

fn at(machine: &Machine, drag: f64) -> Vec<FrictionlessEquilibrium> {
    frictionless_equilibria(machine, drag).unwrap()
}

fn thesis(speed_rad_s: f64) -> Machine {
    Machine { speed_rad_s, ..Machine::default() }
}

fn stable(found: &[FrictionlessEquilibrium]) -> Vec<Kind> {
    let stable = found.iter().filter(|equilibrium| equilibrium.stability == Stability::Stable);
    stable.map(|equilibrium| equilibrium.kind).collect()
}

/// Whether the thesis's condition for A1+ and A1- to vanish holds, two identical balls:
/// (1 - w²)² ≤ 4 ζ² w² ((2 m / (m_I e))² - 1), e over L.
fn vanished(machine: &Machine) -> bool {
    let natural = machine.natural_frequency_rad_s();
    let w = machine.speed_rad_s / natural;
    let zeta = machine.damping_n_s_m / (2.0 * machine.total_mass_kg() * natural);
    let imbalance = machine.imbalance_mass_kg * machine.imbalance_radius_m / machine.ring_radius_m;
    let ratio = 2.0 * machine.balls[0].mass_kg / imbalance;
    (1.0 - w * w).powi(2) <= 4.0 * zeta * zeta * w * w * (ratio * ratio - 1.0)
}

/// A1 vanishes in [179, 184] rad/s; below the natural frequency only one A1 is stable, if it
/// exists, and above it only B1 (thesis section 5.1, figure 5.1, appendix D).
#[test]
fn stability_is_that_of_figure_5_1() {
    for drag in [1e3, HIGH] {
        let mut gone = Vec::new();
        for step in 0..=1500 {
            let speed = -150.0 - 0.1 * f64::from(step);
            let machine = thesis(speed);
            let found = at(&machine, drag);
            let kinds: Vec<Kind> = found.iter().map(|equilibrium| equilibrium.kind).collect();
            if vanished(&machine) {
                assert_eq!(kinds, [Kind::A2, Kind::B1], "{speed}");
                gone.push(-speed);
            } else {
                assert_eq!(kinds, [Kind::A1Plus, Kind::A1Minus, Kind::A2, Kind::B1], "{speed}");
            }
            // Within 0.01 rad/s of the natural frequency, no drag is high enough.
            let above = -speed > machine.natural_frequency_rad_s();
            let expected = match (above, vanished(&machine)) {
                (true, _) => vec![Kind::B1],
                (false, true) => vec![],
                (false, false) => vec![Kind::A1Plus],
            };
            assert_eq!(stable(&found), expected, "{speed} {drag}");
        }
        let (first, last) = (gone[0], gone[gone.len() - 1]);
        assert!((first - 179.4).abs() < 0.11 && (last - 184.0).abs() < 0.11, "{first} {last}");
    }
}

/// The speed at which B1 becomes stable depends on the drag; for high drag it is the natural
/// frequency.
#[test]
fn b1_becomes_stable_at_the_natural_frequency_with_high_drag() {
    for (drag, unstable, then_stable) in [(1.0, 185.0, 186.0), (HIGH, 181.63, 181.64)] {
        assert_eq!(stable(&at(&thesis(-unstable), drag)), [], "{drag}");
        assert_eq!(stable(&at(&thesis(-then_stable), drag)), [Kind::B1], "{drag}");
    }
}

fn tangential<const N: usize>(machine: &Machine, beta: &[f64]) -> Vec<f64> {
    let beta: &[f64; N] = beta.try_into().unwrap();
    Balancer::<N>::new(machine).unwrap().rest_point(beta).friction.to_vec()
}

fn tangential_forces(machine: &Machine, beta: &[f64]) -> Vec<f64> {
    match beta.len() {
        1 => tangential::<1>(machine, beta),
        2 => tangential::<2>(machine, beta),
        3 => tangential::<3>(machine, beta),
        _ => tangential::<4>(machine, beta),
    }
}

fn machines() -> Vec<Machine> {
    let masses: [&[f64]; 9] = [
        &[1.4e-4],
        &[3.0e-4],
        &[1.4e-4, 1.4e-4],
        &[1.4e-4, 0.9e-4],
        &[3.0e-4, 1.0e-4],
        &[1.4e-4, 1.4e-4, 1.4e-4],
        &[0.5e-4, 1.4e-4, 1.4e-4],
        &[0.2e-4, 0.3e-4, 0.5e-4],
        &[0.2e-4, 0.3e-4, 0.4e-4, 0.6e-4],
    ];
    let ball = |&mass_kg: &f64| Ball { mass_kg, ..Ball::default() };
    let machine = |masses: &&[f64], speed_rad_s| Machine {
        balls: masses.iter().map(ball).collect(),
        speed_rad_s,
        ..Machine::default()
    };
    let speeds = [-150.0, -178.0, -183.0, -216.3772, 300.0];
    let round = speeds.iter().flat_map(|&speed| masses.iter().map(move |m| machine(m, speed)));
    // The same in a ring with runout, which is more or less than the balls' reach.
    let in_ring_with_runout = |speed, ring_runout_m| {
        let with_runout =
            move |machine| Machine { ring_runout_m, ring_runout_angle_rad: 2.0, ..machine };
        masses.iter().map(move |m| with_runout(machine(m, speed)))
    };
    round
        .chain(in_ring_with_runout(-150.0, 5e-6))
        .chain(in_ring_with_runout(-216.3772, 4e-5))
        .collect()
}

#[test]
fn tangential_forces_vanish_at_equilibria() {
    for machine in machines() {
        for equilibrium in at(&machine, 1.0) {
            let beta = equilibrium.beta_rad.clone().expect("angles");
            for force in tangential_forces(&machine, &beta) {
                assert!(force.abs() < 1e-14, "{equilibrium:?}");
            }
            let rest = RestForm::new(&machine).unwrap().at_rest(&beta);
            assert!(rest.required_friction < 1e-14);
            assert!((rest.amplitude_m - equilibrium.amplitude_m()).abs() < 1e-15);
        }
    }
}

/// Newton's method on the tangential forces, from a start, with finite differences as slopes.
fn newton(machine: &Machine, start: Vec<f64>) -> Option<Vec<f64>> {
    let n = start.len();
    let mut beta = DVector::from_vec(start);
    let force =
        |beta: &DVector<f64>| DVector::from_vec(tangential_forces(machine, beta.as_slice())) * 1e3;
    for _ in 0..60 {
        let mut slope = DMatrix::zeros(n, n);
        for ball in 0..n {
            let (mut more, mut less) = (beta.clone(), beta.clone());
            more[ball] += 1e-5;
            less[ball] -= 1e-5;
            slope.set_column(ball, &((force(&more) - force(&less)) / 2e-5));
        }
        let step = slope.lu().solve(&force(&beta))?;
        let length = step.norm();
        beta -= step * (0.5 / length).min(1.0);
        if length < 1e-11 {
            let wrapped = beta.iter().map(|beta| beta.rem_euclid(TAU)).collect();
            return (force(&beta).norm() < 1e-10).then_some(wrapped);
        }
    }
    None
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| angular_distance(*a, *b)).fold(0.0, f64::max)
}

/// The closed forms are complete: a search from hundreds of starts finds all of them, and in
/// addition only balanced positions of three or more balls, which form families.
#[test]
fn a_numerical_search_finds_the_same_equilibria() {
    for machine in machines() {
        let n = machine.balls.len();
        let form = RestForm::new(&machine).unwrap();
        let known = at(&machine, 1.0);
        let mut met = vec![false; known.len()];
        let per_axis: usize = [40, 24, 10, 6][n - 1];
        for start in 0..per_axis.pow(n as u32) {
            let angle = |axis: usize| {
                let place = start / per_axis.pow(axis as u32) % per_axis;
                (place as f64 + 0.3 + 0.1 * axis as f64) / per_axis as f64 * TAU
            };
            let Some(beta) = newton(&machine, (0..n).map(angle).collect()) else { continue };
            if n > 2 && form.imbalance_at(&beta).norm() < 1e-6 * form.imbalance.norm() {
                let family = known.iter().position(|equilibrium| equilibrium.kind == Kind::B1);
                met[family.expect("a family of balanced positions")] = true;
                continue;
            }
            let same = known.iter().position(|equilibrium| {
                let exchanged = sorted_where_identical(&beta, &machine.balls);
                let angles = equilibrium.beta_rad.as_ref().expect("angles");
                distance(&exchanged, &sorted_where_identical(angles, &machine.balls)) < 1e-6
            });
            met[same.unwrap_or_else(|| panic!("{beta:?} of {machine:?} is not in {known:?}"))] =
                true;
        }
        for (equilibrium, met) in known.iter().zip(met) {
            assert!(
                met || equilibrium.family_dimension > 0,
                "{equilibrium:?} of {machine:?} has not been found"
            );
        }
    }
}

#[test]
fn three_balls_balance_in_a_family() {
    let balls = vec![Ball::default(); 3];
    let above = at(&Machine { balls: balls.clone(), ..thesis(-216.3772) }, HIGH);
    let family = above.iter().find(|equilibrium| equilibrium.kind == Kind::B1).expect("a family");
    assert_eq!(family.family_dimension, 1);
    assert_eq!(stable(&above), [Kind::B1]);
    let zeros = family.eigenvalues_per_s.iter().filter(|value| value.norm() < 1e-6).count();
    assert_eq!(zeros, 1, "{:?}", family.eigenvalues_per_s);
    // The stability is constant along the family: the third ball anywhere, the others balance it.
    let form = RestForm::new(&Machine { balls: balls.clone(), ..thesis(-216.3772) }).unwrap();
    let slow = RestForm::new(&Machine { balls: balls.clone(), ..thesis(-160.0) }).unwrap();
    for step in 0..48 {
        let third = f64::from(step) / 48.0 * TAU;
        let held = form.imbalance + nalgebra::Complex::from_polar(form.mass[0], third);
        if held.norm() > 2.0 * form.mass[0] {
            continue;
        }
        let (middle, half) = ((-held).arg(), (held.norm() / (2.0 * form.mass[0])).acos());
        let beta = [middle + half, middle - half, third];
        assert!(form.imbalance_at(&beta).norm() < 1e-15);
        let stability = |form| SmallMotions::about(form, &beta, HIGH, 1).stability;
        assert_eq!(stability(&form), Stability::Stable, "{beta:?}");
        assert_eq!(stability(&slow), Stability::Unstable, "{beta:?}");
    }
    assert_eq!(stable(&at(&Machine { balls, ..thesis(-160.0) }, HIGH)), [Kind::A1Plus]);
}

#[test]
fn special_machines_have_the_expected_equilibria() {
    let still = at(&thesis(0.0), 1.0);
    assert_eq!((still.len(), still[0].kind), (1, Kind::Everywhere));
    assert_eq!((still[0].family_dimension, still[0].beta_rad.as_ref()), (2, None));
    // Without damping at resonance, the table can rest only if the total imbalance is zero.
    let mut resonant = Machine { damping_n_s_m: 0.0, ..Machine::default() };
    resonant.speed_rad_s = resonant.natural_frequency_rad_s();
    let kinds: Vec<Kind> = at(&resonant, 1.0).iter().map(|equilibrium| equilibrium.kind).collect();
    assert_eq!(kinds, [Kind::B1]);
    // Eight different balls: two sides for each, two branches, minus impossible combinations.
    let ball = |i: u32| Ball { mass_kg: 2.0e-5 * f64::from(i + 1).sqrt(), ..Ball::default() };
    let eight = Machine { balls: (0..8).map(ball).collect(), ..thesis(-100.0) };
    assert_eq!(at(&eight, 1.0).len(), 256 + 1);
}
