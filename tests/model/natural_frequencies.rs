//! Natural frequencies and critical speeds of systems in files against closed forms, and those of the Bristol rig.

use stickslip::model::{CampbellDiagram, Model};

use crate::support::parse;

/// Returns a model of a system.
fn model(model: &str) -> Model {
    let text = format!(
        "schema: 1\nname: a\nseed: 1\nmodel:\n  {}\n\
         initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}}}\n",
        model.trim().replace('\n', "\n  ")
    );
    parse(text).point(0).model().clone()
}

#[track_caller]
fn assert_near(found: Option<&[f64]>, expected: &[f64], tolerance: f64) {
    let found = found.unwrap_or_else(|| panic!("nothing instead of {expected:?}"));
    let near = |(found, expected): (&f64, &f64)| (found - expected).abs() < tolerance * expected;
    let all_near = found.len() == expected.len() && found.iter().zip(expected).all(near);
    assert!(all_near, "{found:?} is not {expected:?}");
}

/// Two equal masses between three equal springs, or with the first one on the ground: `sqrt(k / m)` and `sqrt(3 k / m)` while it
/// slides, and `sqrt(2 k / m)` while it sticks.
#[test]
fn a_chain_has_the_frequencies_of_its_closed_form() {
    let chain = |contact: &str| {
        model(&format!(
            "system:
  system: chain
  parameters: {{m: 2 kg, k: 300 N/m, n: 10 N}}
  coordinates: {{x: {{unit: m}}, y: {{unit: m}}}}
  mass: {{x: {{x: m}}, y: {{y: m}}}}
  force: {{x: k * (y - 2 * x), y: k * (x - 2 * y)}}
  {contact}"
        ))
    };
    let unit = 150.0_f64.sqrt();
    let both = [unit, unit * 3.0_f64.sqrt()];
    let without = chain("").natural_frequencies();
    assert_near(without.held_rad_s.as_deref(), &both, 1e-9);
    assert_eq!(without.free_rad_s, None);
    let on_ground = chain(
        "contacts: {ground: {normal: n, sliding: x', friction: {coulomb: {coefficient: 0.2}}}}",
    );
    let on_ground = on_ground.natural_frequencies();
    assert_near(on_ground.held_rad_s.as_deref(), &[unit * 2.0_f64.sqrt()], 1e-9);
    assert_near(on_ground.free_rad_s.as_deref(), &both, 1e-9);
}

/// A disc that tilts about its centre: `J_t w^2 -+ J_p w speed - k = 0` backward and forward, so that the critical speeds are
/// `sqrt(k / (J_t + J_p))` and `sqrt(k / (J_t - J_p))`.
#[test]
fn a_tilting_disc_has_the_whirl_of_its_closed_form() {
    let [across, polar, stiffness] = [0.02_f64, 0.008, 700.0];
    let disc = model(&format!(
        "system:
  system: disc
  parameters: {{across: {across} kg m^2, polar: {polar} kg m^2, k: {stiffness} N m, couple: 1e-4 rad, speed: -3000 rpm}}
  turning: {{theta: speed}}
  coordinates: {{a: {{unit: rad}}, b: {{unit: rad}}}}
  mass: {{a: {{a: across}}, b: {{b: across}}}}
  force:
    a: -k * a - polar * theta' * b' + (across - polar) * couple * theta'^2 * cos(theta)
    b: -k * b + polar * theta' * a' + (across - polar) * couple * theta'^2 * sin(theta)"
    ));
    let diagram = CampbellDiagram::of(&disc).expect("a part that turns");
    let critical = [1.0, -1.0].map(|sign| (stiffness / (across + sign * polar)).sqrt());
    assert_near(Some(&diagram.critical_rad_s), &critical, 1e-9);
    for (speed, frequencies) in diagram.speeds_rad_s.iter().zip(&diagram.frequencies_rad_s) {
        let part = 0.5 * polar * speed / across;
        let both = [-1.0, 1.0].map(|sign| (part * part + stiffness / across).sqrt() + sign * part);
        assert_near(Some(frequencies), &both, 1e-8);
    }
}

/// The rotor of the Bristol rig: its resonances at 1455, 1700, 1920 and 2280 rpm (Rodrigues, Champneys, Friswell, Wilson, Journal of
/// Sound and Vibration 330 (2011) 385, simulation of the rotor without balls) are critical speeds.
#[test]
fn the_rig_has_its_published_resonances() {
    let rpm = |all: &[f64]| all.iter().map(|w| w * 30.0 / std::f64::consts::PI).collect::<Vec<_>>();
    for balls in [0, 2] {
        let rotor =
            model(&format!("{{kind: rotor_balancer, parameters: {{number_of_balls: {balls}}}}}"));
        let diagram = CampbellDiagram::of(&rotor).expect("a part that turns");
        assert_near(Some(&rpm(&diagram.critical_rad_s)), &[1455.0, 1700.0, 1920.0, 2280.0], 3e-3);
        // Balls that roll freely make the equations of small motions change with time.
        assert_eq!(rotor.natural_frequencies().free_rad_s, None);
    }
}
