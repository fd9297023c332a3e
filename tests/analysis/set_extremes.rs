//! Extreme amplitudes of equilibrium sets against random searches and closed forms.

use std::convert::Infallible;

use crate::support::TestRng;
use stickslip::analysis::{
    Balance, Resolution, RestForm, amplitude_extremes, frictionless_equilibria,
};
use stickslip::model::{Ball, Machine};

fn form(speed_rad_s: f64, balls: &[(f64, f64)], imbalance: f64) -> RestForm {
    let ball = |&(mass_kg, friction_coefficient): &(f64, f64)| Ball {
        mass_kg,
        friction_coefficient,
        ..Ball::default()
    };
    let mut machine = Machine { speed_rad_s, ..Machine::default() };
    machine.balls = balls.iter().map(ball).collect();
    machine.imbalance_mass_kg *= imbalance;
    RestForm::new(&machine).unwrap()
}

/// Returns the largest (`sign` 1) or smallest (-1) amplitude, m, that small random moves within
/// the set reach from samples of the set, the best ones and others.
fn climbed(form: &RestForm, sign: f64) -> f64 {
    let amplitude = |beta: &[f64]| form.at_rest(beta).amplitude_m;
    let mut samples: Vec<Vec<f64>> = Vec::new();
    let visited: Result<(), Infallible> = Resolution::Samples(4096).visit(form, |beta, rest| {
        samples.extend(rest.in_set().then(|| beta.to_vec()));
        Ok(())
    });
    visited.unwrap();
    samples.sort_by(|a, b| (sign * amplitude(b)).total_cmp(&(sign * amplitude(a))));
    assert!(samples.len() > 20, "{}", samples.len());
    let others = samples.iter().step_by(samples.len() / 10);
    let mut draws = TestRng::new(3);
    let climb = |start: &Vec<f64>| {
        let (mut beta, mut best, mut reach) = (start.clone(), amplitude(start), 0.3);
        for _ in 0..20_000 {
            let near: Vec<f64> =
                beta.iter().map(|beta| beta + reach * (draws.uniform() - 0.5)).collect();
            let rest = form.at_rest(&near);
            if rest.in_set() && sign * (rest.amplitude_m - best) > 0.0 {
                (beta, best) = (near, rest.amplitude_m);
            } else {
                reach = (reach * 0.999).max(1e-6);
            }
        }
        best
    };
    let ends: Vec<f64> = samples.iter().take(10).chain(others).map(climb).collect();
    sign * ends.into_iter().map(|end| sign * end).fold(f64::NEG_INFINITY, f64::max)
}

/// Each extreme is attained at a position in the set, and no random search finds a more extreme
/// one: for two to five balls, identical or not, on both sides of the natural frequency and
/// near it, with an imbalance that they can balance and one that they cannot.
#[test]
fn extremes_are_in_the_set_and_no_search_exceeds_them() {
    let usual = (1.4e-4, 2.75e-3);
    let differ = [(1.4e-4, 2.75e-3), (2.5e-4, 1.0e-3), (0.8e-4, 4.0e-3)];
    let mut calmest_seen = 0;
    for (speed, balls, imbalance) in [
        (-179.2671, &[usual; 2][..], 1.0),
        (-179.2671, &[usual; 3][..], 1.0),
        (-216.3772, &[usual; 3][..], 1.0),
        (-216.3772, &[(1.4e-4, 1.0e-3); 3][..], 4.0),
        (-183.0, &[usual; 3][..], 1.0),
        (-160.8103, &differ[..], 1.0),
        (-191.6372, &differ[..], 4.0),
        (-216.3772, &[(1.4e-4, 1.0e-3); 5][..], 1.0),
    ] {
        let form = form(speed, balls, imbalance);
        let place = format!("{speed} {balls:?} {imbalance}");
        let [calmest, most] = amplitude_extremes(&form);
        for (found, sign) in [(&calmest, -1.0), (&most, 1.0)] {
            let (size, beta) = found.as_ref().unwrap();
            let rest = form.at_rest(beta);
            assert!(rest.friction_used <= 1.0 + 1e-9, "{place}: {}", rest.friction_used);
            let amplitude = size * form.ring_radius_m;
            assert!(
                (rest.amplitude_m - amplitude).abs()
                    <= 1e-9 * form.ring_radius_m * most.as_ref().unwrap().0,
                "{place}"
            );
            if sign < 0.0 && Balance::of(&form) != Balance::Nowhere {
                assert_eq!(*size, 0.0, "{place}");
                continue;
            }
            calmest_seen += u32::from(sign < 0.0);
            let climbed = climbed(&form, sign);
            let beyond = sign * (climbed - amplitude) / amplitude;
            assert!(beyond <= 1e-9, "{place}: {climbed:e} beyond {amplitude:e}");
        }
    }
    assert_eq!(calmest_seen, 2);
}

/// Without friction the set consists of the equilibria, which are known in closed form.
#[test]
fn extremes_without_friction_are_those_of_the_equilibria() {
    let ball = Ball { friction_coefficient: 0.0, ..Ball::default() };
    for count in [2, 3] {
        let mut machine = Machine { balls: vec![ball; count], ..Machine::default() };
        machine.imbalance_mass_kg *= 4.0;
        let known = frictionless_equilibria(&machine, 1.0).unwrap();
        let known = known.iter().map(|equilibrium| equilibrium.amplitude_m());
        let (low, high) = known.fold((f64::INFINITY, 0.0_f64), |(low, high), amplitude| {
            (low.min(amplitude), high.max(amplitude))
        });
        let form = RestForm::new(&machine).unwrap();
        let found = amplitude_extremes(&form).map(|found| found.unwrap().0 * form.ring_radius_m);
        let errors = [found[0] / low - 1.0, found[1] / high - 1.0];
        assert!(errors.iter().all(|error| error.abs() < 1e-9), "{found:?} {low} {high}");
    }
}
