//! A list in the place of any block of a study is refused.

use serde_json::{Value, json};
use stickslip::study::json_schema;

use super::parse;

/// Studies that together have every key of a study file, in JSON, which is YAML.
fn studies() -> Vec<Value> {
    let stratified = json!({"stratified": {"parts_per_axis": 2, "samples_per_cell": 3}});
    let monte_carlo = json!({"monte_carlo": {"samples": 4}});
    let balancer = json!({
        "schema": 1, "name": "a", "seed": 5, "units": {"speed": "rpm", "vibration": "mm"},
        "model": {
            "kind": "ball_balancer",
            "parameters": {
                "table_mass_kg": 0.3, "stiffness_n_m": 1e4, "damping_n_s_m": 1, "ring_radius_m": 0.0115,
                "imbalance_mass_kg": 5.6e-5, "imbalance_radius_m": 0.0115,
                "balls": [{"mass_kg": 1e-4}, {"diameter_m": 3e-3, "friction_coefficient": 2e-3}],
                "ball_mass_kg": 1e-4, "ball_diameter_m": 3e-3, "friction_coefficient": 2.75e-3,
                "speed_rad_s": -200,
            },
            "friction": {"stribeck": {"static_friction_coefficient": 5e-3, "stribeck_speed_rad_s": 1}},
            "normal_force": "lagrange",
        },
        "sweep": [
            {"grid": {"speed_rad_s": [-160, -200]}, "design": stratified},
            {"zip": {"speed_rad_s": [-170, -210], "damping_n_s_m": [1, 2]}},
            {"table": {"columns": ["speed_rad_s"], "rows": [[-150], [-151]]}},
        ],
        "uncertain": {
            "imbalance_mass_kg": {"normal": {"mean": 5.6e-5, "std_dev": 5e-6}},
            "imbalance_radius_m":
                {"truncated_normal": {"mean": 0.01, "std_dev": 0.001, "min": 0.009, "max": 0.011}},
            "table_mass_kg": {"lognormal": {"mean": 0.3, "std_dev": 0.01}},
            "stiffness_n_m": {"uniform": {"min": 9e3, "max": 1e4}},
            "ring_radius_m": {"triangular": {"min": 0.011, "mode": 0.0115, "max": 0.012}},
            "damping_n_s_m": {"times": {"choice": {"values": [1, 2], "weights": [1, 2]}}},
        },
        "initial_conditions": {"box": {"x": [-0.05, 0.05]}, "design": stratified},
        "simulation": {
            "method": "switch", "band": 1e-4, "end_time_s": 16.5, "endings": "all",
            "extend": {"factor": 2, "labels": ["undecided"]},
            "tolerance": {"relative": 1e-8, "absolute": 1e-10},
        },
        "precision": {"equilibrium_fraction": 0.1, "max_runs": 1e6},
        "audit": {"fraction": 0.5},
        "expect": [{"point": {"speed_rad_s": -160}, "equilibrium_fraction": [0.5, 1]}],
    });
    let with = |keys: Value| {
        let mut study = json!({
            "schema": 1, "name": "b", "seed": 5, "model": {"kind": "ball_balancer"},
            "initial_conditions": {"design": monte_carlo},
        });
        study.as_object_mut().unwrap().extend(keys.as_object().unwrap().clone());
        study
    };
    let design = |design: Value| with(json!({"initial_conditions": {"design": design}}));
    let model = |model: Value| with(json!({"model": model}));
    let mut studies = vec![
        balancer,
        design(json!({"latin_hypercube": {"samples": 4}})),
        design(json!({"sobol": {"samples": 4}})),
        design(json!({"grid": {"points_per_axis": 2}})),
        model(
            json!({"kind": "ball_balancer", "friction": {"smooth": {"smoothing_speed_rad_s": 1}}}),
        ),
        model(
            json!({"kind": "ball_balancer", "friction": {"viscous": {"viscous_coefficient_n_s_m": 1}}}),
        ),
    ];
    let shipped = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    for name in [
        "design",
        "cd-rom",
        "model-form",
        "block-on-belt",
        "correlated-tolerances",
        "identify-friction",
    ] {
        let text = std::fs::read_to_string(shipped.join(format!("{name}.yaml"))).unwrap();
        studies.push(serde_saphyr::from_str(&text).unwrap());
    }
    studies
}

/// Returns the paths of all blocks in a value, each a list of steps.
fn blocks(value: &Value, path: &[String], found: &mut Vec<Vec<String>>) {
    let below = |step: String| [path, &[step]].concat();
    match value {
        Value::Object(map) => {
            found.push(path.to_vec());
            map.iter().for_each(|(key, value)| blocks(value, &below(key.clone()), found));
        }
        Value::Array(items) => {
            let items = items.iter().enumerate();
            items.for_each(|(index, item)| blocks(item, &below(index.to_string()), found));
        }
        _ => {}
    }
}

#[test]
fn a_list_in_the_place_of_any_block_is_refused() {
    let mut tried = 0;
    for study in studies() {
        let name = study["name"].clone();
        let right = |study: &Value| parse(&study.to_string());
        if let Err(error) = right(&study) {
            panic!("{name}: {error}");
        }
        let mut paths = Vec::new();
        blocks(&study, &[], &mut paths);
        for path in paths {
            let mut wrong = study.clone();
            let pointer: String = path.iter().map(|step| format!("/{step}")).collect();
            let block = wrong.pointer_mut(&pointer).unwrap();
            *block = Value::Array(block.as_object().unwrap().values().cloned().collect());
            let error = right(&wrong).err().unwrap_or_else(|| panic!("{name}{pointer}: accepted"));
            // Keys in the form of messages: `sweep[0].grid`.
            let key = path.iter().fold(String::new(), |key, step| match step.parse::<usize>() {
                Ok(index) => format!("{key}[{index}]"),
                Err(_) if key.is_empty() => step.clone(),
                Err(_) => format!("{key}.{step}"),
            });
            assert_eq!(error.key(), key, "{name}: {error}");
            let found = error.found().unwrap_or_default();
            assert!(found.starts_with("a list"), "{name}: {error}");
            assert!(error.allowed().is_some_and(|text| !text.is_empty()), "{name}: {error}");
            tried += 1;
        }
    }
    assert!(tried > 80, "{tried}");
}

/// The walk above reaches every top-level key of the schema.
#[test]
fn the_studies_have_every_key_of_the_schema() {
    let studies = studies();
    for key in json_schema()["properties"].as_object().unwrap().keys() {
        assert!(studies.iter().any(|study| study.get(key).is_some()), "no study has `{key}`");
    }
}
