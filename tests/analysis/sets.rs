//! Equilibrium sets: fractions and components of the thesis's figures 5.2 to 5.5, and the fast grid
//! against the model's closed forms.

use std::convert::Infallible;
use std::f64::consts::{PI, TAU};

use stickslip::analysis::{
    Balance, EquilibriumSet, Resolution, RestForm, frictionless_equilibria, set_fraction,
};
use stickslip::model::{Balancer, Ball, Machine};

use crate::support::{required_friction, rest_margin};

fn machine(speed_rad_s: f64, friction_coefficient: f64) -> Machine {
    let ball = Ball { friction_coefficient, ..Ball::default() };
    Machine { speed_rad_s, balls: vec![ball; 2], ..Machine::default() }
}

fn with_masses(masses_kg: &[f64]) -> Machine {
    let balls = masses_kg.iter().map(|&mass_kg| Ball { mass_kg, ..Ball::default() });
    Machine { balls: balls.collect(), ..Machine::default() }
}

fn set(machine: &Machine, points: usize) -> EquilibriumSet {
    EquilibriumSet::of(machine, Resolution::Grid(points)).unwrap()
}

/// The sets have the fractions and components of thesis section 5.2.1, figure 5.4 (four subsets
/// "with the symmetry properties" at the lowest friction, everything at the highest), and figure
/// 5.5 at -191.6372 rad/s, on any grid. The quick estimate is accurate to a thousandth.
#[test]
fn fractions_and_components_are_those_of_the_thesis() {
    for (speed, friction, fraction, torus, exchanged) in [
        (-216.3772, 2.75e-4, 0.0174, 6, 4),
        (-216.3772, 2.75e-3, 0.770, 1, 1),
        (-216.3772, 3.5e-3, 1.000, 1, 1),
        (-191.6372, 2.75e-3, 0.214, 2, 2),
    ] {
        for points in [128, 500, 2048] {
            let set = set(&machine(speed, friction), points);
            assert!((set.fraction - fraction).abs() < 1e-3, "{} {fraction}", set.fraction);
            let quick = set_fraction(&machine(speed, friction)).expect("two balls");
            assert!(points < 2048 || (quick - set.fraction).abs() < 1e-3, "{quick} {fraction}");
            assert_eq!(set.components, Some(torus), "{speed} {friction} {points}");
            assert_eq!(
                set.components_modulo_exchange,
                Some(exchanged),
                "{speed} {friction} {points}"
            );
        }
    }
}

/// The highest amplitude is that with both balls at the imbalance, and the balanced position is cos
/// β = -m_I e / (2 m L) (thesis section 5.2).
#[test]
fn amplitudes_and_balance_are_those_of_the_thesis() {
    let machine = machine(-216.3772, 2.75e-3);
    let set = set(&machine, 512);
    let (smallest, largest) = set.amplitude_m.unwrap();
    assert_eq!(smallest, 0.0);
    assert!((largest - 5.514e-5).abs() < 5e-9, "{largest}");
    let cosine = -machine.imbalance_mass_kg * machine.imbalance_radius_m
        / (2.0 * machine.balls[0].mass_kg * machine.ring_radius_m);
    let Balance::Position(beta) = set.balance else { panic!("{:?}", set.balance) };
    assert_eq!(set.min_amplitude_beta_rad.as_ref(), Some(&beta));
    assert!((beta[0] - cosine.acos()).abs() < 1e-12, "{beta:?}");
    assert!((beta[1] - (TAU - cosine.acos())).abs() < 1e-12, "{beta:?}");
    assert!((beta[0] - 2.270).abs() < 5e-4 && (beta[1] - 4.013).abs() < 5e-4);
    // Balls opposite each other cancel, except for their mass.
    let form = RestForm::new(&machine).unwrap();
    assert!((form.at_rest(&[1.0, 1.0 + PI]).amplitude_m - 2.159e-5).abs() < 5e-9);
}

/// Every grid point agrees with the model's closed forms, which the simulation uses, for different
/// balls on both sides of the resonance.
#[test]
fn every_grid_point_agrees_with_the_model() {
    for (speed_rad_s, ring_runout_m) in
        [(-160.0, 0.0), (177.0, 0.0), (-216.3772, 0.0), (500.0, 0.0), (-216.3772, 1e-5)]
    {
        let mut machine = machine(speed_rad_s, 1.5e-3);
        (machine.ring_runout_m, machine.ring_runout_angle_rad) = (ring_runout_m, 2.0);
        machine.balls[1] =
            Ball { mass_kg: 2.0e-4, friction_coefficient: 1.0e-3, ..machine.balls[1] };
        let balancer = Balancer::<2>::new(&machine).unwrap();
        let form = RestForm::new(&machine).unwrap();
        let (mut inside, mut all) = (0_u32, 0_u32);
        let shown = Resolution::Grid(90).visit(&form, |beta, rest| -> Result<(), Infallible> {
            let beta: &[f64; 2] = beta.try_into().unwrap();
            let row = (beta[0] / TAU * 90.0).round() * 90.0 + (beta[1] / TAU * 90.0).round();
            assert_eq!(row, f64::from(all));
            let amplitude = balancer.rest_amplitude(beta) * machine.ring_radius_m;
            let near = |found: f64, expected: f64| {
                (found - expected).abs() < 1e-11 * (1.0 + expected.abs())
            };
            assert!((rest.amplitude_m - amplitude).abs() < 1e-15, "{beta:?}");
            assert!(near(rest.required_friction, required_friction(&balancer, beta)), "{beta:?}");
            assert!(near(rest.friction_margin(), rest_margin(&balancer, beta)), "{beta:?}");
            let general = form.at_rest(beta);
            assert!(near(rest.friction_used, general.friction_used), "{beta:?}");
            inside += u32::from(rest.in_set());
            all += 1;
            Ok(())
        });
        assert_eq!((shown, all), (Ok(()), 8100));
        let fraction = f64::from(inside) / f64::from(all);
        assert_eq!(set(&machine, 90).fraction, fraction);
        assert!(fraction > 0.0 && fraction < 1.0, "{fraction}");
    }
}

/// Fraction and extremes for one ball agree with the model's condition on a fine scan of the
/// circle, independent of the grid.
#[test]
fn the_set_of_one_ball_agrees_with_a_fine_scan() {
    for (speed, friction, ring_runout_m) in [
        (-216.3772, 1.0e-3, 0.0),
        (-179.2671, 2.75e-3, 0.0),
        (-150.0, 1.0e-3, 0.0),
        (-216.3772, 1.0e-3, 1e-5),
        (-160.8103, 1.0e-3, 1e-5),
        (-216.3772, 1.0, 1e-5),
    ] {
        let mut machine = machine(speed, friction);
        (machine.ring_runout_m, machine.ring_runout_angle_rad) = (ring_runout_m, 2.0);
        machine.balls.truncate(1);
        let balancer = Balancer::<1>::new(&machine).unwrap();
        let fine = 1_000_000;
        let held = (0..fine)
            .map(|i| [f64::from(i) * TAU / f64::from(fine)])
            .filter(|beta| required_friction(&balancer, beta) <= friction);
        let amplitudes: Vec<f64> =
            held.map(|beta| balancer.rest_amplitude(&beta) * machine.ring_radius_m).collect();
        let fraction = amplitudes.len() as f64 / f64::from(fine);
        for points in [1, 512] {
            let found = set(&machine, points);
            assert!(
                (found.fraction - fraction).abs() < 4.0 / f64::from(fine),
                "{} {fraction}",
                found.fraction
            );
            let (smallest, largest) = found.amplitude_m.unwrap();
            let rounding = 1e-12 * largest;
            let scanned =
                amplitudes.iter().fold((f64::INFINITY, 0.0), |(low, high), &amplitude| {
                    (f64::min(low, amplitude), f64::max(high, amplitude))
                });
            let [below, above] = [scanned.0 - smallest, largest - scanned.1];
            assert!(-rounding <= below && below < 1e-5 * largest, "{smallest} {scanned:?}");
            assert!(-rounding <= above && above < 1e-5 * largest, "{largest} {scanned:?}");
        }
        assert_eq!(set_fraction(&machine), Some(set(&machine, 512).fraction));
    }
    let mut slow = machine(-179.2671, 2.75e-3);
    slow.balls.truncate(1);
    assert!((set(&slow, 512).fraction - 0.128_98).abs() < 5e-6);
    // Two arcs, about the two equilibria without friction, until they meet.
    let mut slippery = machine(-216.3772, 1.0e-4);
    slippery.balls.truncate(1);
    let arcs = set(&slippery, 10_000);
    assert_eq!((arcs.components, arcs.components_modulo_exchange), (Some(2), Some(2)));
    assert_eq!(arcs.balance, Balance::Nowhere);
}

#[test]
fn balanced_positions_close_the_polygon() {
    // The imbalance as a mass on the ring.
    let imbalance_kg = 5.6e-5 * 3.7e-2 / 1.15e-2;
    for (masses, expected) in [
        (vec![imbalance_kg], "position"),
        (vec![imbalance_kg * 1.01], "nowhere"),
        (vec![1.4e-4, 2.0e-4], "position"),
        (vec![1.4e-4, 1.4e-4 + imbalance_kg], "position"),
        (vec![1.4e-4, 3.3e-4], "nowhere"),
        (vec![0.8e-4, 0.9e-4], "nowhere"),
        (vec![1.4e-4; 3], "family"),
        (vec![0.7e-4, 5.0e-4, 2.5e-4], "family"),
        (vec![0.7e-4, 5.0e-4, 2.4e-4], "nowhere"),
        (vec![1.4e-4; 4], "family"),
        (vec![1.0e-3, 1.0e-3, 1.0e-3, 1.0e-3, 1.0e-3], "family"),
        (vec![1.0e-5, 2.0e-5, 3.0e-5, 4.0e-5, 5.0e-5, 6.0e-5, 7.0e-5, 8.0e-5], "family"),
        (vec![2.0e-5; 8], "nowhere"),
        (vec![3.0e-5; 8], "family"),
    ] {
        let machine = with_masses(&masses);
        let form = RestForm::new(&machine).unwrap();
        let balance = Balance::of(&form);
        assert_eq!(balance.name(), expected, "{masses:?}");
        let Some(beta) = balance.position() else { continue };
        assert!(beta.iter().all(|beta| (0.0..TAU).contains(beta)), "{beta:?}");
        let left = form.imbalance_at(beta).norm() / form.imbalance.norm();
        // For a degenerate polygon, a rounding error of 1e-16 is an angle of 1e-8.
        assert!(left < 1e-7, "{masses:?} {left}");
        if let Balance::Family { dimension, .. } = balance {
            assert_eq!(dimension, masses.len() - 2);
        }
    }
}

/// A third ball of almost no mass and with ample friction does not affect the first two, so that
/// the sampled fraction agrees with the grid's.
#[test]
fn samples_agree_with_the_grid() {
    let two = machine(-216.3772, 2.0e-3);
    let mut three = two.clone();
    three.balls.push(Ball { mass_kg: 1e-15, friction_coefficient: 1.0, ..Ball::default() });
    let exact = set(&two, 2048).fraction;
    let sampled = EquilibriumSet::of(&three, Resolution::Samples(4096)).unwrap();
    assert!((set_fraction(&three).unwrap() - exact).abs() < 0.005);
    let (low, high) = sampled.fraction_interval.unwrap();
    assert!(low < exact && exact < high, "{exact} {low} {high}");
    // As many independent samples would give 0.0076.
    assert!(high - low < 0.003, "{low} {high}");
    assert_eq!((sampled.components, sampled.components_modulo_exchange), (None, None));
    assert_eq!(sampled.balance.name(), "family");
    let (_, largest) = sampled.amplitude_m.unwrap();
    assert!((largest - set(&two, 512).amplitude_m.unwrap().1).abs() < 1e-12);
}

/// At standstill every position is in the set; without friction only isolated positions are, which
/// no grid point meets; at the resonance of an undamped suspension nothing rests.
#[test]
fn sets_without_forces_friction_or_damping() {
    let still = set(&machine(0.0, 0.0), 64);
    assert_eq!(
        (still.fraction, still.components, still.amplitude_m),
        (1.0, Some(1), Some((0.0, 0.0)))
    );
    let smooth = set(&machine(-216.3772, 0.0), 64);
    assert_eq!((smooth.fraction, smooth.components), (0.0, Some(0)));
    // The set then consists of the equilibria without friction; the balanced one has the smallest
    // amplitude.
    let equilibria = frictionless_equilibria(&machine(-216.3772, 0.0), 1.0).unwrap();
    let most = equilibria.iter().map(|equilibrium| equilibrium.amplitude_m()).fold(0.0, f64::max);
    let (smallest, largest) = smooth.amplitude_m.unwrap();
    assert!(smallest == 0.0 && (largest / most - 1.0).abs() < 1e-9, "{largest} {most}");
    assert!(smooth.min_amplitude_beta_rad.is_some());
    let mut resonant = Machine { damping_n_s_m: 0.0, ..machine(0.0, 1.0) };
    resonant.speed_rad_s = resonant.natural_frequency_rad_s();
    let resonant = set(&resonant, 64);
    assert_eq!((resonant.fraction, resonant.components), (0.0, Some(0)));
    let none = Machine { balls: vec![], ..Machine::default() };
    assert_eq!(EquilibriumSet::of(&none, Resolution::Grid(64)), None);
    assert_eq!(EquilibriumSet::of(&with_masses(&[1.0e-4; 3]), Resolution::Grid(64)), None);
}
