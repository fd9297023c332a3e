//! `check --existence`.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::support::{AT_ONCE, Scratch, assert_has, study_text};
use crate::support::shipped;

/// A block has one contact with a given normal force, so that the decision is always unique.
#[test]
fn the_thesis_study_and_a_block_are_certain_at_all_points() {
    let rest = "model: {kind: block_on_belt}\nsweep: [{grid: {belt_speed_m_s: [1, 2]}}]\n";
    let scratch = Scratch::with(study_text("a", "{sobol: {samples: 1}}", AT_ONCE, rest));
    let path = shipped("preferred-equilibria.yaml").display().to_string();
    for (path, points, minor) in [(&*path, 6, "0.9999999"), ("a.yaml", 2, "1.00000000 at point 0")]
    {
        let text = scratch.well(&format!("check {path} --existence"));
        let all = format!("at all {points} points stick and slip have exactly one solution");
        assert_has(&text, &[all, format!("smallest principal minor {minor}")]);
    }
    assert!(!scratch.well(&format!("check {path}")).contains("existence"));
}

#[test]
fn failing_points_are_named_with_position_and_remedy() {
    let scratch = Scratch::new();
    let path = shipped("no-unique-solution.yaml").display().to_string();
    scratch.prints(
        &format!("check {path} --existence"),
        &[
            "existence     at 1 of 2 points stick and slip do not always have exactly one solution",
            "\n  point 1 friction_coefficient=3: smallest principal minor -1.",
            "ball 1 at 0.0000, ball 2 at ",
            "remedy: multiply all friction coefficients by at most 0.5",
        ],
    );
    let existence = &scratch.json(&format!("check {path} --existence --json"))["existence"];
    let whole = ["points", "points_examined", "not_unique_points", "min_at_point"];
    let expected = json!([2, 2, 1, 1]);
    assert_eq!(Value::from(whole.map(|key| existence[key].clone()).to_vec()), expected);
    let named = &existence["not_unique"][0];
    assert_eq!((&named["point_id"], &named["friction_coefficient"]), (&json!(1), &json!(3.0)));
    assert_eq!(named["worst_position"][1]["ball"], json!(2));
    assert_eq!(named["min_principal_minor"], existence["min_principal_minor"]);
}

/// In a huge sweep only a part is checked, and the output says so.
#[test]
fn huge_sweeps_stay_quick() {
    let values: Vec<String> = (0..400).map(|k| format!("{}", -100.0 - f64::from(k))).collect();
    let friction: Vec<String> = (1..=100).map(|k| format!("{}", 0.05 * f64::from(k))).collect();
    let rest = format!(
        "model: {{kind: ball_balancer, parameters: {{balls: 8, ball_mass_kg: 0.1, \
         table_mass_kg: 0.01}}}}\n\
         sweep: [{{grid: {{speed_rad_s: [{}], friction_coefficient: [{}]}}}}]\n\
         uncertain: {{imbalance_mass_kg: {{uniform: {{min: 1.0e-5, max: 2.0e-5}}}}}}\n",
        values.join(", "),
        friction.join(", "),
    );
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 1}}", AT_ONCE, &rest));
    let started = Instant::now();
    let text = scratch.well("check a.yaml --existence");
    assert!(started.elapsed() < Duration::from_secs(20), "{:?}", started.elapsed());
    assert_has(&text, &["of 10000 points stick and slip", " more points\n", "uncertain"]);
    assert_has(&text, &["checked 10000 of 40000 points, evenly spread over the sweep"]);
    assert!(text.lines().count() < 100, "{text}");
    println!("{:?}", started.elapsed());
}
