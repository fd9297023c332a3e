//! `stickslip compare`: what changed between two studies, with intervals of the differences.

use serde_json::Value;

use super::support::{Scratch, assert_has, numbers};

fn study(name: &str, seed: u64, parameters: &str, speeds: &str) -> String {
    format!(
        "schema: 1\nname: {name}\nseed: {seed}\n\
         model: {{kind: ball_balancer, parameters: {{{parameters}}}}}\n\
         sweep: [{{grid: {{speed_rad_s: [{speeds}]}}}}]\n\
         initial_conditions: {{design: {{monte_carlo: {{samples: 40}}}}}}\n\
         simulation: {{end_time_s: 2.0}}\n\
         responses: {{mean: {{amplitude_mean: {{}}}}, above: {{amplitude_above: {{limit: 40 µm}}}}}}\n"
    )
}

fn quantity<'a>(point: &'a Value, name: &str) -> &'a Value {
    let all = point["quantities"].as_array().unwrap();
    all.iter().find(|quantity| quantity["name"] == name).expect("a quantity of this name")
}

/// With the same start states, the interval of the difference of means is that of the paired differences; with other ones,
/// it is that of independent samples, and wider.
#[test]
fn common_start_states_make_differences_precise() {
    let scratch = Scratch::with(study("a", 3, "", "-160, -216"));
    scratch.write("b.yaml", study("b", 3, "stiffness_n_m: 1.0701e4", "-216, -300"));
    scratch.write("c.yaml", study("c", 4, "stiffness_n_m: 1.0701e4", "-216"));
    for name in ["a", "b", "c"] {
        scratch.well(&format!("run {name}.yaml --out {name} --quiet"));
    }
    let before = scratch.files();
    let paired = scratch.json("compare a b --json");
    assert_eq!(paired["points"].as_array().map(Vec::len), Some(1));
    assert_eq!(paired["points_without_counterpart"], serde_json::json!([1, 1]));
    let point = &paired["points"][0];
    assert_eq!(point["point_ids"], serde_json::json!([1, 0]));
    assert_eq!(point["same_start_states"], true);
    let amplitudes = |name: &str, from: usize| {
        let all = numbers(&scratch.table(name, "runs"), "amplitude_m");
        all[from..from + 40]
            .iter()
            .map(|metres| metres.expect("an amplitude"))
            .collect::<Vec<f64>>()
    };
    let (first, other) = (amplitudes("a", 40), amplitudes("b", 0));
    let differences: Vec<f64> = first.iter().zip(&other).map(|(a, b)| b - a).collect();
    let mean = differences.iter().sum::<f64>() / 40.0;
    let variance = differences.iter().map(|change| (change - mean).powi(2)).sum::<f64>() / 39.0;
    let half = 2.023 * (variance / 40.0).sqrt();
    let found = &quantity(point, "mean")["difference"];
    let number = |key: &str| found[key].as_f64().unwrap();
    assert!((number("value") - mean).abs() < 1e-12);
    // Student's intervals of both means have the same number of degrees of freedom as that of the differences.
    assert!(((number("high") - mean) / half - 1.0).abs() < 1e-3, "{found} {half}");
    let independent = scratch.json("compare a c --json");
    let point = &independent["points"][0];
    assert_eq!(point["same_start_states"], false);
    let wide = &quantity(point, "mean")["difference"];
    let width = |of: &Value| of["high"].as_f64().unwrap() - of["low"].as_f64().unwrap();
    assert!(width(wide) > width(found), "{wide} {found}");
    assert_eq!(scratch.files(), before);
    // A point of a sweep is that of a study whose parameter has this value.
    let plain = study("d", 3, "speed_rad_s: -216", "-216")
        .replace("sweep: [{grid: {speed_rad_s: [-216]}}]\n", "");
    scratch.write("d.yaml", plain);
    scratch.well("run d.yaml --out d --quiet");
    let found = scratch.json("compare d a --json");
    assert_eq!(found["points"].as_array().map(Vec::len), Some(1));
    assert_eq!(found["points"][0]["point_ids"], serde_json::json!([0, 1]));
    assert_eq!(quantity(&found["points"][0], "mean")["difference"]["value"], 0.0);
}

#[test]
fn differences_are_said_in_words() {
    let scratch = Scratch::with(study("a", 3, "friction_coefficient: 2.75e-3", "-216"));
    scratch.write("b.yaml", study("b", 3, "friction_coefficient: 2.75e-2", "-216"));
    for name in ["a", "b"] {
        scratch.well(&format!("run {name}.yaml --out {name} --quiet"));
    }
    let text = scratch.well("compare a b");
    let parts = [
        "first   a (a, 40 runs)\nsecond  b (b, 40 runs)\nkeys that differ\n",
        "  model.parameters.friction_coefficient: 0.00275 -> 0.0275\n",
        "\nat rest: rises.\n",
        "The runs of both studies have the same start states",
        "speed \u{2212}216 rad/s",
        "mean [µm]",
    ];
    assert_has(&text, &parts);
    scratch.prints(
        "compare a a",
        &[
            "both studies have the same keys and values\n",
            "mean: the 95 % interval of the difference contains 0.\n",
        ],
    );
}
