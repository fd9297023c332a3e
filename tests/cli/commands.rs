//! `check`, `verify`, `schema` and `completions`.

use serde_json::{Value, json};

use super::support::{AT_ONCE, Scratch, assert_has, study_text};
use crate::support::shipped;

#[test]
fn check_counts_and_computes_nothing() {
    let rest = "sweep: [{grid: {speed_rad_s: [-160.0, -200.0]}}]\n\
                uncertain: {ball_mass_kg: {uniform: {min: 1.0e-4, max: 2.0e-4}}}\n";
    let scratch = Scratch::with(study_text("a", "{sobol: {samples: 7}}", AT_ONCE, rest));
    let before = scratch.files();
    scratch.prints(
        "check a.yaml",
        &[
            "study         a (hash ",
            "swept         speed_rad_s\n",
            "uncertain     ball_mass_kg\n",
            "points        2\n",
            "runs          14, each",
        ],
    );
    let report = scratch.json("check a.yaml --json");
    let whole = ["study", "seed", "points", "runs", "balls", "swept", "uncertain", "expectations"];
    let expected = json!(["a", 5, 2, 14, 2, ["speed_rad_s"], ["ball_mass_kg"], 0]);
    assert_eq!(Value::from(whole.map(|key| report[key].clone()).to_vec()), expected);
    assert_eq!(report["hash"].as_str().map(str::len), Some(64));
    let cost = |key: &str| report[key].as_f64().unwrap();
    assert!(cost("core_seconds") > 0.0 && cost("most_core_seconds") > cost("core_seconds"));
    assert_eq!(scratch.files(), before);
}

#[test]
fn check_says_how_uncertain_parameters_are_sampled_together() {
    let scratch = Scratch::new();
    let uncertain = "uncertain:\n  ball_mass_kg: {uniform: {min: 1.0e-4, max: 2.0e-4}}\n\
                     \x20 stiffness_n_m: {uniform: {min: 9.0e+3, max: 1.0e+4}}\n";
    let pair = "{parameters: [ball_mass_kg, stiffness_n_m], rank_correlation: 0.5}";
    for (sampling, words, facts) in [
        ("{}".to_owned(), "", Value::Null),
        (
            "{design: sobol}".to_owned(),
            " (design sobol)",
            json!({"design": "sobol", "correlations": 0}),
        ),
        (
            format!("{{design: joint, correlations: [{pair}]}}"),
            " (design joint, 1 rank correlation)",
            json!({"design": "joint", "correlations": 1}),
        ),
        (
            format!("{{correlations: [{pair}]}}"),
            " (design monte_carlo, 1 rank correlation)",
            json!({"design": "monte_carlo", "correlations": 1}),
        ),
    ] {
        let rest = format!("{uncertain}uncertain_sampling: {sampling}\n");
        scratch.write("a.yaml", study_text("a", "{sobol: {samples: 7}}", AT_ONCE, &rest));
        let said = [&format!("uncertain     stiffness_n_m, ball_mass_kg{words}\n")];
        scratch.prints("check a.yaml", &said);
        let report = scratch.json("check a.yaml --json");
        assert_eq!(report["uncertain_sampling"], facts);
    }
}

#[test]
fn check_says_where_only_rest_is_looked_for() {
    let scratch = Scratch::new();
    for (name, written, only) in [("a.yaml", "all", false), ("b.yaml", "rest", true)] {
        let plain = study_text("a", "{sobol: {samples: 7}}", AT_ONCE, "");
        let simulation = format!("simulation: {{endings: {written}, ");
        scratch.write(name, plain.replace("simulation: {", &simulation));
        let text = scratch.well(&format!("check {name}"));
        assert_eq!(text.contains("method switch, detects rest only\n"), only, "{text}");
        let report = scratch.json(&format!("check {name} --json"));
        assert_eq!(report["endings"], json!(written));
    }
}

#[test]
fn check_lists_variables_and_responses() {
    let plain = study_text("a", "{sobol: {samples: 7}}", AT_ONCE, "");
    let scratch = Scratch::with(&plain);
    assert!(!scratch.well("check a.yaml").contains("design "));
    let report = scratch.json("check a.yaml --json");
    assert_eq!((&report["design"], &report["responses"]), (&json!([]), &json!([])));
    let more = "design:
  speed_rad_s: {from: -260, to: -140}
  balls: {from: 1, to: 3}
  material: {choices: {steel: {ball_mass_kg: 1.4e-4}, ceramic: {ball_mass_kg: 5.8e-5}}}
responses: {half: median_time_to_rest, mean: {amplitude_mean: {relative: true}}}
";
    scratch.write("b.yaml", plain + more);
    let expected = "design        speed_rad_s, balls, material\nresponses     half, mean\n";
    scratch.prints("check b.yaml", &[expected]);
    let report = scratch.json("check b.yaml --json");
    let variables = json!([
        {"name": "speed_rad_s", "unit": "rad/s", "from": -260.0, "to": -140.0, "integer": false},
        {"name": "balls", "unit": "1", "from": 1.0, "to": 3.0, "integer": true},
        {"name": "material", "choices": ["steel", "ceramic"]},
    ]);
    assert_eq!(report["design"], variables);
    let [half, mean] = [0, 1].map(|index| &report["responses"][index]);
    assert_eq!((&half["name"], &half["unit"]), (&json!("half"), &json!("s")));
    assert_eq!((&mean["name"], &mean["unit"]), (&json!("mean"), &json!("1")));
    assert_has(mean["meaning"].as_str().unwrap(), &["mean residual amplitude over"]);
}

#[test]
fn the_schema_and_completions_for_three_shells() {
    let scratch = Scratch::new();
    assert_eq!(scratch.json("schema"), stickslip::study::json_schema());
    for (shell, sign) in [
        ("bash", "complete -F _stickslip"),
        ("zsh", "#compdef stickslip"),
        ("fish", "complete -c stickslip"),
    ] {
        let said = [sign, "threads", "shard", "verify", "expand"];
        scratch.prints(&format!("completions {shell}"), &said);
    }
}

fn with_expectation(range: &str) -> String {
    let rest = format!(
        "sweep: [{{grid: {{speed_rad_s: [-160.0, -200.0]}}}}]\n\
         expect: [{{point: {{speed_rad_s: -200.0}}, equilibrium_fraction: {range}}}]\n"
    );
    study_text("a", "{monte_carlo: {samples: 5}}", AT_ONCE, &rest)
}

#[test]
fn verify_says_what_is_met() {
    let scratch = Scratch::new();
    scratch.write("met.yaml", with_expectation("[0, 0.1]"));
    let text = scratch.well("verify met.yaml --out met");
    let line = "point 1 speed_rad_s=-200: equilibrium fraction 0.0000, expected";
    assert_has(&text, &[format!("met      {line} 0 to 0.1\n")]);
    assert_eq!(scratch.table("met", "runs").num_rows(), 10);
    scratch.refused("verify met.yaml --out met", &["met: holds results of this study already"]);

    scratch.write("not.yaml", with_expectation("[0.9, 1]"));
    for arguments in ["verify not.yaml", "verify not.yaml --json", "verify not.yaml --quiet"] {
        let ended = scratch.stickslip(arguments);
        assert_eq!(ended.code, Some(4), "{arguments}");
        match arguments.split_once("--") {
            None => {
                assert_has(&ended.out, &[format!("NOT MET  {line} 0.9 to 1\n")]);
                assert_has(&ended.err, &["1 expectation not met"]);
            }
            Some((_, "json")) => {
                let report = ended.json();
                let expected = json!([{"point_id": 1, "label": "equilibrium", "fraction": 0.0,
                    "expected": [0.9, 1.0], "met": false}]);
                assert_eq!(report["expectations"], expected);
            }
            _ => assert_eq!((ended.out.as_str(), ended.err.as_str()), ("", "")),
        }
    }
}

#[test]
fn verify_needs_expectations_and_all_runs() {
    let scratch = Scratch::with(study_text("a", "{sobol: {samples: 1}}", AT_ONCE, ""));
    let missing = ["a.yaml: `expect`: missing key", "found: ", "allowed: a list such as expect"];
    scratch.refused("verify a.yaml --out out", &missing);
    scratch.write("b.yaml", with_expectation("[0, 1]"));
    scratch.refused("verify b.yaml --shard 1/2", &["unexpected argument '--shard'"]);
}

/// The small studies meet all of their expectations. Continuous integration verifies the smoke study.
#[test]
fn small_shipped_studies_hold() {
    let scratch = Scratch::new();
    for (name, met) in [
        ("block-on-spring", 1),
        ("block-on-belt", 1),
        ("stribeck", 1),
        ("smooth-friction", 1),
        ("viscous", 1),
        ("precision", 1),
    ] {
        let study = shipped(&format!("{name}.yaml"));
        let text = scratch.well(&format!("verify {} --threads 2", study.display()));
        assert!(text.matches("\nmet    ").count() >= met && !text.contains("NOT MET"), "{text}");
    }
}
