//! The JSON Schema and the program accept and refuse the same studies: shipped ones, and many damaged ones.

use std::collections::{BTreeMap, BTreeSet};

use jsonschema::Validator;
use serde_json::{Value, json};
use stickslip::study::{Study, Template, json_schema};

use super::parse;
use crate::support::{places, shipped, study_files};

/// Problems that the program finds and the schema cannot express, each with the reason. A problem that ends with a blank
/// is the beginning of a problem.
const CONTENT: [(&str, &str); 48] = [
    ("a peak amplitude has no counterpart without balls", "two keys of a response"),
    ("no peak amplitude at constant speed without disturbances", "a response and the model"),
    ("no physical meaning: hold_1_s", "a profile with a last part that lasts"),
    ("the speed changes its sign", "the sign of all speeds of a profile"),
    ("no physical meaning: speed_rad_s", "the sign of all speeds of a profile"),
    ("only for a ball balancer", "the kind of the model"),
    ("no physical meaning: start_speed_rad_s", "the sign of all speeds of a profile"),
    ("not the end of the speed profile", "the sum of the durations of a profile, and another key"),
    ("the first speed is missing", "the place of a part in the list"),
    ("the speed at the end is missing", "the place of a part in the list"),
    ("balls overlap", "the room of the balls in a table of start states"),
    ("wrong number of values in a row", "the number of a table's columns"),
    ("unequal lengths", "lengths of different lists"),
    ("unequal lengths in a zip", "lengths of different lists"),
    ("unknown column", "columns of a table depend on the model and its balls"),
    ("a column given twice", "equal items at different places"),
    ("not a parameter of ", "parameters depend on the friction law and the number of balls"),
    ("some designs do not have this ball", "a variable and the list of balls"),
    ("some points do not have this ball", "a swept parameter and the numbers of balls"),
    ("a ball has its own value", "a swept parameter and the list of balls"),
    ("balls have their own values", "a variable and the list of balls"),
    ("viscous friction does not use it", "parameters depend on the friction law"),
    ("no physical meaning", "bounds of a parameter in tables, distributions, units and designs"),
    ("reversed range", "the order of two numbers"),
    ("an empty range", "the order of two numbers"),
    ("reversed or empty range", "the order of two numbers"),
    ("not a range of fractions", "the order of two numbers"),
    ("almost nothing is left between min and max", "the order of two numbers"),
    ("limits that nothing meets", "the order of two numbers"),
    ("mode outside the range", "the order of two numbers"),
    ("a step that does not arrive", "the order of numbers"),
    ("logarithmic values through 0", "the signs of two numbers"),
    ("nothing meets it", "bounds depend on the response"),
    ("not positive", "the sum of weights"),
    ("not a swept parameter", "names at another place of the file"),
    ("no point of the sweep has these values", "values at another place of the file"),
    ("not an uncertain parameter", "names at another place of the file"),
    ("both uncertain and swept", "names at another place of the file"),
    ("varied twice", "names at another place of the file"),
    ("two variables set the same parameter", "names at another place of the file"),
    ("choices that set different parameters", "names at another place of the file"),
    ("not a response", "names at another place of the file"),
    ("not a variable", "names at another place of the file"),
    ("no objective, or too many", "the number of objectives at two places together"),
    ("the study has no audit", "a key at another place of the file"),
    ("a logarithmic range that is not positive", "the spacing of the range"),
    ("the table cannot be read: ", "files"),
    ("with ", "the study with every number of balls of its designs"),
];

/// Problems that the schema cannot express at these places, each with what it depends on.
const CONTENT_AT: [(&str, &str, &str); 18] = [
    ("/units", "unknown unit", "the symbols of units"),
    ("/units", "neither a quantity nor a parameter with a unit", "the parameters of the kind"),
    ("/responses", "not a quantity of a run", "the outputs of a system file"),
    ("/initial_conditions", "unknown key", "coordinates depend on the number of balls"),
    ("/model/parameters", "unknown key", "coordinates depend on the number of balls"),
    ("/table", "not a number", "the type of a value depends on its column"),
    ("/table", "wrong type", "the type of a value depends on its column"),
    ("/table", "unknown choice", "the type of a value depends on its column"),
    ("/optimize/compare_with", "missing key", "the variables"),
    (
        "/optimize/compare_with",
        "a number without a unit",
        "the variables, which may have this name",
    ),
    ("/optimize/compare_with", "not a number", "the variables"),
    (
        "/optimize/compare_with",
        "not a number with a unit",
        "the variables, which may have this name",
    ),
    ("/optimize/compare_with", "not a whole number", "the variables"),
    ("/optimize/compare_with", "not a choice", "the choices"),
    ("/optimize/compare_with", "out of range", "the ranges of variables"),
    ("/design", "missing key", "the reference design"),
    ("/design", "not a choice", "the reference design"),
    ("/design", "out of range", "the reference design"),
];

/// Shipped studies, and studies that use every key.
fn studies() -> Vec<(String, Value)> {
    let mut all = Vec::new();
    for path in study_files("studies") {
        let name = path.display().to_string();
        let resolved = Study::load(&path).expect("a study").resolved_yaml();
        all.push((name.clone(), read(&std::fs::read_to_string(&path).expect("a study"))));
        all.push((format!("{name} resolved"), read(&resolved)));
    }
    all.push(("units".to_owned(), read(UNITS)));
    all.push(("block".to_owned(), read(BLOCK)));
    all
}

fn read(text: &str) -> Value {
    serde_saphyr::from_str(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

const UNITS: &str = "
schema: 1
name: units
seed: 1
model:
  kind: ball_balancer
  parameters: {table_mass: 300 g, balls: [{mass: 0.14 g}, {diameter: 3 mm}], damping: 1.3 N s/m}
  friction: {stribeck: {static_friction_coefficient: 0.1, stribeck_speed: 1 rad/s}}
  normal_force: newton
sweep:
  - grid: {speed: {from: 1000 rpm, to: 2000 rpm, count: 3}, normal_force: [newton, lagrange]}
  - zip: {speed_rad_s: {from: 1, to: 100, count: 3, spacing: logarithmic}, imbalance_mass: [0 g, 1 mg, 2 mg]}
  - grid: {friction_coefficient_1: {from: 0, to: 0.1, step: 0.05}}
  - table: {columns: [speed_rad_s], rows: [[1], [2]]}
uncertain:
  ring_radius: {uniform: {min: 11 mm, max: 12 mm}}
  stiffness: {times: {triangular: {min: 0.9, mode: 1, max: 1.1}}}
uncertain_sampling:
  design: joint
  correlations: [{parameters: [ring_radius, stiffness_n_m], rank_correlation: -0.5}]
initial_conditions:
  box: {beta: [0, 1], x: [0, 0.01]}
  design: {sobol: {samples: 8}}
simulation: {end_time: 2 s, method: event, tolerance: {relative: 1.0e-7}}
audit: {fraction: 0.5}
precision: {equilibrium_fraction: 0.1, amplitude_p95: 5 µm, max_runs: 100}
expect: [{point: {normal_force: newton}, equilibrium_fraction: [0, 1], audit_flip_rate: [0, 1]}]
design:
  imbalance_radius: {from: 30 mm, to: 40 mm}
  table: {choices: {light: {table_mass: 200 g}, heavy: {table_mass_kg: 0.4}}}
responses:
  early: {at_rest_by: 1 s}
  mean: {amplitude_mean: {relative: true}}
  high: {amplitude_above: {limit: 1.0}}
  middle: median_time_to_rest
optimize:
  minimize: mean
  subject_to: {early: {at_least: 0.5}}
  designs: 40
  sensitivity: {from: runs, samples: 8}
  compare_with: {imbalance_radius: 35 mm, table: light}
";

const BLOCK: &str = "
schema: 1
name: block
seed: 1
model:
  kind: block_on_belt
  parameters: {mass: 2 kg, normal_force: 5 N, belt_speed_m_s: 0.2}
  friction: {smooth: {smoothing_speed: 1 mm/s}}
sweep: [{grid: {normal_force: [4 N, 5 N], smoothing_speed_m_s: [0.01]}, design: {latin_hypercube: {samples: 3}}}]
initial_conditions: {box: {position: [-1 cm, 1 cm], velocity_m_s: [0, 0.1]}}
";

/// Returns all damaged versions of a study, with what was done.
fn damaged(study: &Value) -> Vec<(String, Value)> {
    // Further items of a list are like the first two.
    let paths = places(study, 2);
    let mut all = Vec::new();
    let values = json!([null, "text", true, -1, 0, [], {}, [[1]]]);
    let values = values.as_array().expect("a list");
    for path in &paths {
        let mut with = |what: &str, change: &dyn Fn(&mut Value)| {
            let mut study = study.clone();
            change(study.pointer_mut(path).expect("a path of this study"));
            all.push((format!("{path}: {what}"), study));
        };
        for value in values {
            with(&format!("= {value}"), &|place| *place = value.clone());
        }
        let keys: Vec<String> = match study.pointer(path) {
            Some(Value::Object(fields)) => {
                with("+ foreign key", &|place| place["foreign_key"] = json!(1));
                fields.keys().cloned().collect()
            }
            _ => Vec::new(),
        };
        for key in keys {
            with(&format!("- {key}"), &|place| {
                place.as_object_mut().expect("an object").shift_remove(&key);
            });
            with(&format!("misspelt {key}"), &|place| {
                let fields = place.as_object_mut().expect("an object");
                if let Some(value) = fields.shift_remove(&key) {
                    fields.insert(format!("{key}x"), value);
                }
            });
        }
    }
    let others = "mass_kg mass balls belt_speed_m_s ring_radius normal_force normal_force_n";
    for key in others.split(' ') {
        let mut study = study.clone();
        study["model"]["parameters"][key] = json!(1);
        all.push((format!("/model/parameters + {key}"), study));
    }
    all
}

fn program(value: &Value) -> Result<(), String> {
    match Study::parse(&shipped("a.yaml"), value.to_string()) {
        Ok(_) => Ok(()),
        Err(error) => Err(error.problem().to_owned()),
    }
}

#[test]
fn the_schema_and_the_program_agree() {
    let validator: Validator = jsonschema::validator_for(&json_schema()).expect("a valid schema");
    let (mut tried, mut disagreements) = (0, BTreeMap::<String, Vec<String>>::new());
    let mut seen = BTreeSet::new();
    for (name, study) in studies() {
        let found: Vec<String> = validator
            .iter_errors(&study)
            .map(|error| format!("{}: {error}", error.instance_path()))
            .collect();
        assert!(found.is_empty(), "{name}: {found:?}");
        assert_eq!(program(&study), Ok(()), "{name}");
        // The schema knows neither the names of a system nor its formulas.
        if study["model"].get("system").is_some() {
            continue;
        }
        let kind = study["model"]["kind"].to_string();
        for (damage, study) in damaged(&study) {
            // The same damage to two studies of one kind of model shows the same.
            if !seen.insert(format!("{kind} {damage}")) {
                continue;
            }
            tried += 1;
            let disagreement = match (validator.is_valid(&study), program(&study)) {
                (true, Ok(())) | (false, Err(_)) => continue,
                (true, Err(problem)) => {
                    let everywhere = |(known, _): &(&str, &str)| {
                        problem == *known || known.ends_with(' ') && problem.starts_with(known)
                    };
                    let here = |(place, known, _): &(&str, &str, &str)| {
                        damage.contains(place) && problem == *known
                    };
                    if CONTENT.iter().any(everywhere) || CONTENT_AT.iter().any(here) {
                        continue;
                    }
                    format!("only the program refuses: {problem}")
                }
                (false, Ok(())) => {
                    let why = validator
                        .iter_errors(&study)
                        .next()
                        .map(|error| error.instance_path().to_string());
                    format!("only the schema refuses: {}", why.unwrap_or_default())
                }
            };
            disagreements.entry(disagreement).or_default().push(format!("{name} {damage}"));
        }
    }
    assert!(tried > 2000, "{tried}");
    let shown: Vec<String> = disagreements
        .iter()
        .map(|(what, places)| {
            format!(
                "{what} ({} times)\n    {}",
                places.len(),
                places[..places.len().min(4)].join("\n    ")
            )
        })
        .collect();
    assert!(shown.is_empty(), "{}", shown.join("\n"));
}

/// What one of the two accepted and the other refused is refused by both.
#[test]
fn forms_that_were_accepted_by_one_are_refused_by_both() {
    let validator = jsonschema::validator_for(&json_schema()).expect("a valid schema");
    let balancer = read(UNITS);
    let block = read(BLOCK);
    let cases: [(&Value, &str, Value); 7] = [
        (&balancer, "/model/parameters", json!({ "mass_kg": 1 })),
        (&block, "/model/parameters", json!({ "balls": 2 })),
        (&block, "/model/parameters", json!({ "ball_mass_kg": 1 })),
        (&balancer, "/sweep", json!([])),
        (&balancer, "/sweep", json!(null)),
        (&balancer, "/model/parameters", json!({ "balls": null })),
        (&balancer, "/simulation", json!({ "end_time": "2 s", "end_time_s": 2 })),
    ];
    for (study, path, value) in cases {
        assert!(validator.is_valid(study));
        let mut study = study.clone();
        *study.pointer_mut(path).expect("a path") = value.clone();
        assert!(!validator.is_valid(&study), "{path} = {value}");
        assert!(program(&study).is_err(), "{path} = {value}");
    }
    // The schema knows the keys of a system in the study.
    let template = Template::find("system").expect("a template").text("a", "a.yaml".as_ref());
    let template = template.expect("a study");
    assert!(validator.is_valid(&read(&template)));
    assert!(!validator.is_valid(&read(&template.replace("contacts:", "contact:"))));
}

/// A list in the place of any block is refused with the key of the block. The studies have every key of the schema.
#[test]
fn a_list_in_the_place_of_any_block_is_refused() {
    let mut tried = 0;
    let all = studies();
    for key in json_schema()["properties"].as_object().expect("keys").keys() {
        assert!(all.iter().any(|(_, study)| study.get(key).is_some()), "no study has `{key}`");
    }
    for (name, study) in all.iter().filter(|(_, study)| study["model"].get("system").is_none()) {
        for path in places(study, usize::MAX) {
            let mut wrong = study.clone();
            let block = wrong.pointer_mut(&path).expect("a path of this study");
            let Value::Object(fields) = block else { continue };
            // A range of a sweep stands for a list.
            if path.starts_with("/sweep") && fields.contains_key("from") {
                continue;
            }
            *block = fields.values().cloned().collect();
            let error = parse(&wrong.to_string()).expect_err(&format!("{name}{path}: accepted"));
            // Keys in the form of messages: `sweep[0].grid`.
            let key = path.split('/').skip(1).fold(String::new(), |key, step| match step.parse() {
                Ok::<usize, _>(index) => format!("{key}[{index}]"),
                Err(_) if key.is_empty() => step.to_owned(),
                Err(_) => format!("{key}.{step}"),
            });
            assert_eq!(error.key(), key, "{name}: {error}");
            assert!(error.found().unwrap_or_default().starts_with("a list"), "{name}: {error}");
            assert!(error.allowed().is_some_and(|text| !text.is_empty()), "{name}: {error}");
            tried += 1;
        }
    }
    assert!(tried > 400, "{tried}");
}
