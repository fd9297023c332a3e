//! Templates of studies: valid, with the machines that they name, and with the program's defaults.

use std::path::Path;

use crate::support::{Block, Ground, shipped_study};
use serde_json::Value;
use stickslip::model::Machine;
use stickslip::study::{Study, Template, json_schema};

use super::study;

fn text(template: Template) -> String {
    let text = template.text("my-study", Path::new("my-study.yaml"));
    text.unwrap_or_else(|error| panic!("{}: {error}", template.name))
}

fn named(name: &str) -> (String, Study) {
    let text = text(Template::find(name).expect("a template"));
    let study = study(&text);
    (text, study)
}

/// Returns the text without comments and blank lines.
fn without_comments(text: &str) -> String {
    let is_key = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    text.lines().filter(is_key).map(|line| format!("{line}\n")).collect()
}

#[test]
fn every_template_is_a_valid_study_of_its_name() {
    for template in Template::ALL {
        let text = text(template);
        let study = study(&text);
        assert_eq!(study.name(), "my-study", "{}", template.name);
        assert!(study.planned_run(study.run_count() - 1).case.is_ok(), "{}", template.name);
        assert!(text.contains("#   stickslip check my-study.yaml\n"), "{text}");
        assert!(!text.contains("FILE") && !text.contains("name: NAME"), "{text}");
        for line in text.lines() {
            assert!(line.chars().count() <= 100 && line == line.trim_end(), "{line:?}");
        }
    }
}

/// Comments add nothing to a study, and every key that has a description has a comment above it.
#[test]
fn comments_are_complete_and_change_nothing() {
    for template in Template::ALL {
        let text = text(template);
        assert_eq!(study(&without_comments(&text)).hash(), study(&text).hash());
        let lines: Vec<&str> = text.lines().collect();
        // The keys of the model and of the simulation are different everywhere.
        for key in
            ["schema", "seed", "model", "kind", "parameters", "balls", "friction", "end_time_s"]
        {
            let is_key = |line: &&str| line.trim_start().starts_with(&format!("{key}:"));
            let Some(place) = lines.iter().position(is_key) else { continue };
            assert!(lines[place - 1].trim_start().starts_with("# "), "{key} in\n{text}");
        }
    }
}

#[test]
fn the_thesis_template_is_the_study_of_the_thesis() {
    let shipped = shipped_study("preferred-equilibria.yaml");
    let (_, study) = named("thesis");
    // The hash covers model, sweep, sampling, seed and simulation.
    assert_eq!(study.hash(), shipped.hash());
    assert_eq!(*study.model(), Machine::default().into());
}

/// The template for a machine of one's own gives every parameter: the thesis's values would
/// otherwise enter it silently.
#[test]
fn the_machine_template_gives_every_parameter() {
    let (text, study) = named("machine");
    let resolved = super::study(
        "schema: 1\nname: a\nseed: 1\nmodel: {kind: ball_balancer}\n\
         initial_conditions: {design: {sobol: {samples: 1}}}\n",
    )
    .resolved_yaml();
    let parameters = resolved.lines().skip_while(|line| *line != "  parameters:").skip(1);
    let parameters: Vec<&str> = parameters
        .take_while(|line| line.starts_with("    "))
        .filter_map(|line| line.trim().split(':').next())
        .collect();
    assert_eq!(parameters.len(), 13, "{parameters:?}");
    for name in parameters {
        assert!(text.contains(&format!("\n    {name}: ")), "{name} in\n{text}");
    }
    let machine = study.model().ball_balancer().expect("a balancer");
    assert_eq!(machine.balls.len(), 4);
    // Above its natural frequency, and the balls can balance the imbalance.
    assert!(machine.speed_rad_s > machine.natural_frequency_rad_s());
    let balls: f64 = machine.balls.iter().map(|ball| ball.mass_kg * machine.ring_radius_m).sum();
    assert!(balls > machine.imbalance_mass_kg * machine.imbalance_radius_m);
    assert!(text.contains("# A key without its unit takes a value with a unit: `speed: 6000 rpm`"));
}

/// The template for blocks is a block on a belt, and on rigid ground as its head says.
#[test]
fn the_template_for_blocks() {
    let (text, study) = named("blocks");
    let ground = |study: &Study| Block::of(study.model()).expect("a block").ground;
    assert_eq!(ground(&study), Ground::Belt { speed_m_s: 0.1 });
    let on_ground = without_comments(&text).replace("block_on_belt", "block_on_spring");
    let removed =
        ["    belt_speed_m_s: 0.1\n", "sweep:\n  - grid: {belt_speed_m_s: [0.1, 0.2, 0.3, 0.4]}\n"];
    let on_ground = removed.into_iter().fold(on_ground, |text, part| {
        assert!(text.contains(part), "{text}");
        text.replace(part, "")
    });
    assert_eq!(ground(&super::study(&on_ground)), Ground::Fixed);
}

/// A key behind `#` stands above the blank line before the next key, whose description follows the blank line.
#[test]
fn descriptions_stand_above_their_keys() {
    let (text, _) = named("monte-carlo");
    let lines: Vec<&str> = text.lines().collect();
    let place = lines.iter().position(|line| line.starts_with("# uncertain_sampling: "));
    let place = place.expect("the key behind `#`");
    assert!(lines[place - 1].trim_start().starts_with("ball_mass_2_kg: "), "{text}");
    assert_eq!(lines[place + 1], "");
    assert!(lines[place + 2].starts_with("# "), "{text}");
    let next = lines[place + 2..].iter().find(|line| !line.starts_with('#'));
    assert_eq!(next, Some(&"initial_conditions:"));
}

#[test]
fn the_templates_for_monte_carlo_and_optimize() {
    let (_, study) = named("monte-carlo");
    assert_eq!(study.uncertain().len(), 6);
    assert!(study.optimization().is_none());
    let (_, study) = named("optimize");
    let optimization = study.optimization().expect("optimize");
    assert_eq!((study.variables().len(), study.responses().len()), (3, 3));
    assert_eq!(optimization.designs, 60);
    assert!(optimization.compare_with.is_some());
}

/// Returns the lines of a text that are a key with a value behind `#`, without the `#`.
fn commented_keys(text: &str) -> Vec<(usize, String)> {
    let key = |line: &str| {
        let (margin, rest) = line.split_once("# ")?;
        let (key, value) = rest.split_once(": ")?;
        let is_key = key.chars().all(|letter| letter.is_ascii_lowercase() || letter == '_');
        (margin.trim().is_empty() && is_key && !value.is_empty()).then(|| format!("{margin}{rest}"))
    };
    text.lines().enumerate().filter_map(|(place, line)| Some((place, key(line)?))).collect()
}

/// A key behind `#` has the value that the program uses without it: the study is the same with it.
#[test]
fn keys_behind_comments_are_the_defaults() {
    let mut all = 0;
    for template in Template::ALL {
        let text = text(template);
        let lines: Vec<&str> = text.lines().collect();
        for (place, key) in commented_keys(&text) {
            let mut with: Vec<&str> = lines.clone();
            with[place] = &key;
            let with = super::parse(&with.join("\n"));
            let with = with.unwrap_or_else(|error| panic!("{key} in {}: {error}", template.name));
            assert_eq!(with.hash(), study(&text).hash(), "{key} in {}", template.name);
            all += 1;
        }
    }
    assert!(all > 20, "{all} keys");
}

/// Returns the numbers and words that a description states as defaults.
fn stated_defaults(description: &str) -> Vec<String> {
    let words: Vec<&str> = description.split_whitespace().collect();
    let after = |place: usize| match words.get(place + 1) {
        Some(&"is") => words.get(place + 2),
        next => next,
    };
    let defaults =
        (0..words.len()).filter(|place| words[*place].ends_with("default")).filter_map(after);
    let bare = |word: &&str| word.trim_matches(|sign: char| "(),.;:`".contains(sign)).to_owned();
    let value = |word: &String| word.parse::<f64>().is_ok() || word.chars().all(char::is_lowercase);
    let prose = ["the", "are", "as"];
    defaults.map(bare).filter(value).filter(|word| !prose.contains(&word.as_str())).collect()
}

/// The defaults in the descriptions of the schema are the annotations `default`, which are the
/// values of a resolved study.
#[test]
fn descriptions_state_the_defaults_of_the_schema() {
    let schema = json_schema();
    let mut compared = 0;
    for map in ["ModelFile", "ParametersFile", "SimulationFile", "ToleranceFile"] {
        let properties = schema["$defs"][map]["properties"].as_object().expect("properties");
        for (name, property) in properties {
            let Some(default) = property.get("default") else { continue };
            let stated = stated_defaults(property["description"].as_str().expect("a description"));
            let same = |stated: &String| match default {
                Value::Number(number) => stated.parse() == Ok(number.as_f64().unwrap_or(f64::NAN)),
                default => default.as_str() == Some(stated),
            };
            assert!(stated.len() == 1 && stated.iter().all(same), "{name}: {stated:?}, {default}");
            compared += 1;
        }
    }
    assert!(compared >= 17, "{compared} defaults");
    // Two parameters have other defaults in each kind of model.
    let properties = &schema["$defs"]["ParametersFile"]["properties"];
    for (name, expected) in
        [("stiffness_n_m", &[1.07e4, 100.0][..]), ("friction_coefficient", &[2.75e-3, 0.1, 1e-3])]
    {
        let stated =
            stated_defaults(properties[name]["description"].as_str().expect("a description"));
        let stated: Vec<f64> = stated.iter().filter_map(|word| word.parse().ok()).collect();
        assert_eq!(stated, expected, "{name}");
        assert!(properties[name].get("default").is_none(), "{name}");
    }
    let machine = Machine::default();
    assert_eq!((machine.stiffness_n_m, machine.balls[0].friction_coefficient), (1.07e4, 2.75e-3));
}

/// The defaults of `optimize` in the descriptions are those of a study that gives none of them.
#[test]
fn descriptions_state_the_defaults_of_optimize() {
    let study = study(
        "schema: 1\nname: a\nseed: 1\nmodel: {kind: ball_balancer}\n\
         initial_conditions: {design: {sobol: {samples: 1}}}\n\
         design: {speed_rad_s: {from: -200, to: -100}}\nresponses: {a: {amplitude_mean: {}}}\n\
         optimize: {minimize: a}\n",
    );
    let optimization = study.optimization().expect("optimize");
    let schema = json_schema();
    let stated = |name: &str| {
        let property = &schema["$defs"]["OptimizeFile"]["properties"][name];
        stated_defaults(property["description"].as_str().expect("a description"))
    };
    assert_eq!(stated("finalists"), [optimization.finalists.to_string()]);
    assert_eq!(stated("final_samples"), [optimization.final_samples.to_string()]);
    assert_eq!(stated("over_points"), ["worst"]);
    assert_eq!((optimization.start_designs, optimization.designs), (10, 40));
}

/// A name that YAML would read as a number or a word of its own is text in the study.
#[test]
fn names_are_text() {
    for name in ["123", "1.5", "true", "null", "a.b", "-x", "1e3"] {
        let text = Template::ALL[0].text(name, Path::new("a.yaml"));
        let text = text.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(study(&text).name(), name);
    }
    for name in ["", "two words", "ä", ".hidden", "a/b"] {
        let error = Template::ALL[0].text(name, Path::new("x/a.yaml")).expect_err("no name");
        let error = error.to_string();
        assert!(
            error.contains("x/a.yaml: not a name") && error.contains("allowed: 1 to 100"),
            "{error}"
        );
    }
}
