//! Parameters that determine others: a density or a material of balls, and an imbalance as a product.

use std::f64::consts::PI;

use stickslip::study::{DesignValue, ParameterValue};

use super::{machine_at, parse, study};
use crate::support::cases;

fn text(parameters: &str, rest: &str) -> String {
    format!(
        "schema: 1\nname: a\nseed: 5\nmodel:\n  kind: ball_balancer\n  parameters: {{{parameters}}}\n{rest}\
         initial_conditions: {{design: {{monte_carlo: {{samples: 4}}}}}}\n"
    )
}

fn sphere_kg(density_kg_m3: f64, diameter_m: f64) -> f64 {
    density_kg_m3 * PI / 6.0 * diameter_m.powi(3)
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-14, "{found} {expected}");
}

/// The mass follows the diameter at each point and in each run, and the resolved study is the same study.
#[test]
fn the_mass_follows_the_diameter() {
    let swept = study(&text(
        "ball_material: steel",
        "sweep: [{grid: {ball_diameter: [3 mm, 6 mm]}}]\n\
         uncertain: {ball_diameter_2_m: {uniform: {min: 2.0e-3, max: 4.0e-3}}}\n",
    ));
    let again = study(&swept.resolved_yaml());
    assert_eq!(again.hash(), swept.hash());
    assert!(!swept.resolved_yaml().contains("ball_mass"), "{}", swept.resolved_yaml());
    near(machine_at(&swept, 1).balls[0].mass_kg, sphere_kg(7810.0, 6e-3));
    let mut drawn = Vec::new();
    for run in 0..swept.run_count() {
        let case = swept.planned_run(run).case.unwrap();
        assert_eq!(case, again.planned_run(run).case.unwrap());
        let balls = &case.model.ball_balancer().unwrap().balls;
        balls.iter().for_each(|ball| near(ball.mass_kg, sphere_kg(7810.0, ball.diameter_m)));
        drawn.push(balls[1].mass_kg);
    }
    drawn.dedup();
    assert_eq!(drawn.len(), 8);
    // Each ball has its own diameter, too.
    let balls = "ball_density: 2.5 g/cm^3, balls: [{diameter: 4 mm}, {}]";
    let machine = machine_at(&study(&text(balls, "")), 0);
    near(machine.balls[0].mass_kg, sphere_kg(2500.0, 4e-3));
    near(machine.balls[1].mass_kg, sphere_kg(2500.0, 3e-3));
}

/// A factor multiplies the density or imbalance that follows from the mass, if the study gives neither; a point of another
/// block has that value.
#[test]
fn values_that_are_not_given_follow_from_the_masses() {
    let factor = "times: {choice: {values: [2]}}";
    let uncertain =
        format!("uncertain: {{ball_density_kg_m3: {{{factor}}}, imbalance_kg_m: {{{factor}}}}}\n");
    let case = study(&text("", &uncertain)).planned_run(0).case.expect("a possible machine");
    let machine = case.model.ball_balancer().expect("a ball balancer");
    near(machine.balls[1].mass_kg, 2.0 * 1.4e-4);
    near(machine.imbalance_mass_kg, 2.0 * 5.6e-5);
    let blocks = "sweep: [{grid: {ball_density_kg_m3: [7000]}}, {grid: {speed_rad_s: [-160]}}]\n";
    let blocks = study(&text("", blocks));
    let [ParameterValue::Number(density), _] = blocks.point(1).swept[..] else {
        panic!("a number")
    };
    near(sphere_kg(density, 3e-3), 1.4e-4);
    near(machine_at(&blocks, 1).balls[0].mass_kg, 1.4e-4);
}

#[test]
fn materials_are_swept_and_chosen() {
    let swept = study(&text("", "sweep: [{grid: {ball_material: [steel, silicon_nitride]}}]\n"));
    near(machine_at(&swept, 1).balls[1].mass_kg, sphere_kg(3200.0, 3e-3));
    assert_eq!(study(&swept.resolved_yaml()).hash(), swept.hash());
    let choices = "design:\n  ball_diameter_m: {from: 3.0e-3, to: 6.0e-3}\n  material:\n    choices:\n      \
                   a: {ball_material: steel}\n      b: {ball_material: tungsten_carbide}\n";
    let designs = study(&text("", choices));
    let values = [DesignValue::Number(5e-3), DesignValue::Choice(1)];
    let set = designs.set(&values).unwrap();
    near(machine_at(&set, 0).balls[0].mass_kg, sphere_kg(14_900.0, 5e-3));
    // The contact has the restitution of rolling balls of this material, or its own.
    let contact = |contact: &str| {
        let text = text("ball_material: glass", "")
            .replace("  parameters", &format!("  contact: {contact}\n  parameters"));
        machine_at(&study(&text), 0).contact.unwrap().restitution
    };
    near(contact("{friction_coefficient: 0.1}"), (0.97 - 0.4) / 1.4);
    near(contact("{restitution: 0.2}"), 0.2);
}

#[test]
fn an_imbalance_is_a_product() {
    let swept =
        study(&text("imbalance: 40 g mm", "sweep: [{grid: {imbalance_radius: [20 mm, 40 mm]}}]\n"));
    near(machine_at(&swept, 0).imbalance_mass_kg, 2e-3);
    near(machine_at(&swept, 1).imbalance_mass_kg, 1e-3);
    assert_eq!(study(&swept.resolved_yaml()).hash(), swept.hash());
    let drawn =
        study(&text("", "uncertain: {imbalance: {uniform: {min: 30 g mm, max: 50 g mm}}}\n"));
    let run = drawn.planned_run(2);
    let machine = run.case.unwrap();
    let machine = machine.model.ball_balancer().unwrap();
    near(machine.imbalance_mass_kg * machine.imbalance_radius_m, run.uncertain[0]);
    assert!((3e-5..5e-5).contains(&run.uncertain[0]));
    assert_eq!(study(&drawn.resolved_yaml()).hash(), drawn.hash());
    let balanced = machine_at(&study(&text("imbalance: 0 g mm", "")), 0);
    assert_eq!(balanced.imbalance_mass_kg, 0.0);
}

/// A study that gives neither has the same resolved text as before.
#[test]
fn a_study_gives_one_of_the_two() {
    let plain = study(&text("", ""));
    assert!(!plain.resolved_yaml().contains("density"));
    assert!(!plain.resolved_yaml().contains("imbalance_kg_m"));
    for [parameters, rest, key, found] in cases(
        r"ball_material: steel, ball_mass: 1 g ¦  ¦ model.parameters.ball_mass ¦ both `ball_material` and `ball_mass`
ball_density: 7 g/cm^3, balls: [{mass: 1 g}] ¦  ¦ balls ¦ ball_mass_kg
ball_material: steel ¦ sweep: [{grid: {ball_mass_kg: [1e-4]}}]\n ¦ sweep ¦ ball_mass_kg
imbalance: 40 g mm ¦ uncertain: {imbalance_mass_kg: {normal: {mean: 1e-4, std_dev: 1e-5}}}\n ¦ uncertain ¦ imbalance_mass_kg
ball_material: steel, ball_density: 7 g/cm^3 ¦  ¦ ball_density ¦ `ball_material` in line 6
ball_material: stel ¦  ¦ ball_material ¦ stel
ball_material: 7810 ¦  ¦ ball_material ¦ 7810
ball_density: 7810 kg ¦  ¦ ball_density ¦ 7810 kg",
    ) {
        let error = parse(&text(&parameters, &rest)).unwrap_err();
        assert!(error.key().contains(&key), "{error}");
        assert!(error.found().unwrap_or_default().contains(&found), "{error}");
        assert!(error.allowed().is_some(), "{error}");
    }
    let error = parse(&text("ball_material: stel", "")).unwrap_err();
    assert!(error.allowed().unwrap().contains("steel (did you mean this?)"), "{error}");
}
