//! Residual unbalance and balance quality grade against closed forms.

use std::f64::consts::{FRAC_PI_2, PI};

use stickslip::analysis::{RestForm, balance_quality_grade, overlaps, residual_imbalance};
use stickslip::model::{Ball, Machine};

fn relative_error(found: f64, expected: f64) -> f64 {
    (found / expected - 1.0).abs()
}

fn machine(ball_masses_kg: &[f64]) -> Machine {
    let ball = |&mass_kg: &f64| Ball { mass_kg, ..Ball::default() };
    Machine { balls: ball_masses_kg.iter().map(ball).collect(), ..Machine::default() }
}

/// A ball opposite the imbalance with `m L = m_I e` balances it; on the same side it doubles it.
#[test]
fn one_ball_balances_an_imbalance_of_its_own_size() {
    let Machine { imbalance_mass_kg, imbalance_radius_m, ring_radius_m, .. } = Machine::default();
    let imbalance = imbalance_mass_kg * imbalance_radius_m;
    let machine = machine(&[imbalance / ring_radius_m]);
    assert!(residual_imbalance(&machine, &[PI]) < 1e-15 * imbalance);
    assert!(balance_quality_grade(&machine, &[PI]) < 1e-14);
    assert!(!overlaps(&machine, &[PI]));
    assert!(relative_error(residual_imbalance(&machine, &[0.0]), 2.0 * imbalance) < 1e-14);
    // Two vectors of the same length with an angle of 60 degrees between their directions.
    let found = residual_imbalance(&machine, &[2.0 * PI / 3.0]);
    assert!(relative_error(found, imbalance) < 1e-14);
}

/// Two balls that cancel each other leave the imbalance of the thesis's machine, by hand:
/// 5.6e-5 kg * 0.037 m / 0.324336 kg * 216.3772 rad/s = 1.3823120 mm/s.
#[test]
fn the_grade_of_the_imbalance_alone() {
    let machine = Machine::default();
    for beta in [[FRAC_PI_2, -FRAC_PI_2], [0.0, PI], [1.0, 1.0 + PI]] {
        let found = balance_quality_grade(&machine, &beta);
        assert!(relative_error(found, 1.382_312_041_833) < 1e-11, "{found}");
    }
    // The direction of rotation does not matter.
    let other = Machine { speed_rad_s: -machine.speed_rad_s, ..machine.clone() };
    let beta = [0.3, 2.0];
    assert_eq!(balance_quality_grade(&other, &beta), balance_quality_grade(&machine, &beta));
}

/// The amplitude at rest is the specific unbalance times `ω² / |ω_n² - ω² + 2iζω_nω|`, which the
/// equilibrium sets compute in non-dimensional form.
#[test]
fn the_grade_and_the_amplitude_at_rest_have_one_unbalance() {
    let mut machine = machine(&[1.0e-4, 1.4e-4, 2.0e-4]);
    for turn in 0..20 {
        (machine.ring_runout_m, machine.ring_runout_angle_rad) = (1e-5 * f64::from(turn), 2.0);
        let form = RestForm::new(&machine).expect("three balls");
        let beta = [0.1, 1.7, 4.0].map(|angle| angle * (1.0 + 0.13 * f64::from(turn)));
        let specific_unbalance_m = form.at_rest(&beta).amplitude_m / form.transfer.norm();
        let expected = 1e3 * specific_unbalance_m * machine.speed_rad_s.abs();
        assert!(relative_error(balance_quality_grade(&machine, &beta), expected) < 1e-9);
    }
}
