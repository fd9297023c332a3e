//! The resolved study file: complete, self-contained, and equivalent to the original.

use std::collections::HashSet;
use std::fs;

use stickslip::study::{Study, json_schema};

use super::{parse, same_runs, study, text_with_design};

const EVERYTHING: &str = "
schema: 1
name: everything
seed: 18446744073709551615
model:
  kind: ball_balancer
  parameters:
    balls: [{}, {mass_kg: 1.5e-4, diameter_m: 3.1e-3}, {friction_coefficient: 0.1}]
    table_mass_kg: 0.1
sweep:
  - grid: {speed_rad_s: [-160.8103, -1.0e-7, 3], normal_force: [newton, lagrange]}
  - zip: {friction_coefficient_1: [2.75e-4, 0], speed_rad_s: [1, 2]}
    design: {sobol: {samples: 64}}
  - table: designs.csv
    design: {table: starts.csv}
uncertain:
  stiffness_n_m: {choice: {values: [1.05e4, 1.07e4], weights: [1, 3]}}
  imbalance_mass_kg: {normal: {mean: 5.6e-5, std_dev: 5.0e-6}}
  imbalance_radius_m: {truncated_normal: {mean: 0.037, std_dev: 0.001, min: 0.03, max: 0.04}}
  table_mass_kg: {lognormal: {mean: 0.3, std_dev: 0.1}}
  ring_radius_m: {uniform: {min: 0.011, max: 0.012}}
  damping_n_s_m: {triangular: {min: 1, mode: 2, max: 3}}
initial_conditions:
  box: {beta: [0, 3], beta_dot_2: [0.5, 0.5]}
  design: {stratified: {parts_per_axis: 2, samples_per_cell: 1}}
simulation: {band: 2.0e-4, tolerance: {absolute: 1.0e-11}, extend: {factor: 3}}
audit: {fraction: 0.25}
expect:
  - {point: {speed_rad_s: 2}, equilibrium_fraction: [0, 1], undecided_fraction: [0, 0.5]}
";

fn everything() -> Study {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("study.yaml", EVERYTHING);
    write("designs.csv", "normal_force,speed_rad_s\nnewton,1e4\nlagrange,10700.1\n");
    write(
        "starts.csv",
        "y,x,beta_1,beta_2,beta_3,x_dot,y_dot,beta_dot_1,beta_dot_2,beta_dot_3\n\
         0.1,0.2,1,2,3,1e-300,0.3333333333333333,-1,-2,-3\n",
    );
    Study::load(&folder.path().join("study.yaml")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn loading_the_resolved_file_gives_the_same_study() {
    let first = everything();
    let text = first.resolved_yaml();
    assert!(!text.contains(".csv"), "{text}");
    let second = study(&text);
    assert_eq!(second.hash(), first.hash());
    assert_eq!(second.resolved_yaml(), text);
    same_runs(&second, &first);
    assert_eq!(second.expectations(), first.expectations());
    assert_eq!(second.swept(), first.swept());
    assert_eq!(second.uncertain(), first.uncertain());
    assert_eq!((second.audit(), first.audit().is_some()), (first.audit(), true));
}

#[test]
fn the_resolved_file_names_every_default() {
    let text = study(&text_with_design("{monte_carlo: {samples: 1e3}}")).resolved_yaml();
    for line in [
        "    table_mass_kg: 0.324",
        "    stiffness_n_m: 10700.0",
        "    balls: 2",
        "    speed_rad_s: -216.3772",
        "  friction: coulomb",
        "  normal_force: lagrange",
        "    beta_2: [0.0, 6.283185307179586]",
        "    beta_dot_1: [-1.0, 1.0]",
        "    monte_carlo: {samples: 1000}",
        "  band: 1.0e-8",
        "  end_time_s: 16.5",
        "  tolerance: {relative: 1.0e-8, absolute: 1.0e-10}",
    ] {
        assert!(text.lines().any(|found| found == line), "{line}\n{text}");
    }
}

#[test]
fn the_hash_is_that_of_what_determines_the_runs() {
    let text = text_with_design("{monte_carlo: {samples: 10}}");
    let hash = |text: &str| study(text).hash();
    let base = hash(&text);
    assert_eq!(base.len(), 64);
    let same = [
        text.replace("name: a", "name: b"),
        format!("# comment\n{text}"),
        format!("{text}expect: [{{equilibrium_fraction: [0, 1]}}]\n"),
        format!("{text}design: {{balls: {{from: 1, to: 3}}}}\n"),
        format!("{text}responses: {{a: median_time_to_rest}}\n"),
        format!("{text}simulation: {{band: 1e-8}}\n"),
        format!("{text}  box: {{y: [-0.05, 0.05], x: [-5e-2, 0.05]}}\n"),
        text.replace("schema: 1\nname: a\nseed: 5\n", "seed: 5\nschema: 1\nname: a\n"),
        text.replace(
            "{kind: ball_balancer}",
            "{parameters: {balls: [{}, {}]}, kind: ball_balancer}",
        ),
    ];
    for text in same {
        assert_eq!(hash(&text), base, "{text}");
    }
    let other = [
        text.replace("seed: 5", "seed: 6"),
        text.replace("samples: 10", "samples: 11"),
        format!("{text}simulation: {{band: 2e-4}}\n"),
        format!("{text}simulation: {{extend: {{factor: 2}}}}\n"),
        format!("{text}  box: {{x: [-0.05, 0.051]}}\n"),
        format!("{text}sweep: [{{grid: {{speed_rad_s: [-216.3772]}}}}]\n"),
        format!("{text}uncertain: {{speed_rad_s: {{uniform: {{min: 1, max: 2}}}}}}\n"),
    ];
    let precision = |max_runs: u64| {
        format!("{text}precision: {{equilibrium_fraction: 0.02, max_runs: {max_runs}}}\n")
    };
    let other = other.into_iter().chain([
        format!("{text}audit: {{fraction: 0.25}}\n"),
        format!("{text}audit: {{fraction: 0.5}}\n"),
        precision(10_000),
        precision(20_000),
    ]);
    let mut hashes = HashSet::from([base]);
    for text in other {
        assert!(hashes.insert(hash(&text)), "{text}");
    }
    let normal = "ball_mass_kg: {normal: {mean: 1, std_dev: 0.1}}";
    let uniform = "speed_rad_s: {uniform: {min: 1, max: 2}}";
    let listed = format!("{text}uncertain: {{{normal}, {uniform}}}\n");
    let turned = format!("{text}uncertain: {{{uniform}, {normal}}}\n");
    assert_eq!(hash(&listed), hash(&turned));
}

#[test]
fn every_design_may_stand_in_a_block_alone() {
    let text = "schema: 1\nname: a\nseed: 1\nmodel: {kind: ball_balancer}\ninitial_conditions: {}\n\
                sweep: [{grid: {speed_rad_s: [1]}, design: {sobol: {samples: 8}}}]\n";
    assert_eq!(study(text).run_count(), 8);
    assert!(parse(&text.replace(", design: {sobol: {samples: 8}}", "")).is_err());
}

#[test]
fn the_json_schema_knows_every_key_with_its_unit() {
    let text = json_schema().to_string();
    for part in [
        "friction_coefficient_2",
        "ball_mass_8_kg",
        "rad/s",
        "latin_hypercube",
        "beta_dot_8",
        "samples_per_cell",
        "equilibrium_fraction",
        "Stiffness of the suspension per direction (default 10700), or stiffness of the spring (default 100), N/m; above 0",
        "stribeck_speed_m_s",
        "belt_speed_m_s",
        "velocity_m_s",
        "\"additionalProperties\":false",
        "https://json-schema.org/draft/2020-12/schema",
    ] {
        assert!(text.contains(part), "{part}");
    }
}

#[test]
fn an_extension_names_its_labels() {
    let text = text_with_design("{monte_carlo: {samples: 10}}");
    let with = |extend: &str| study(&format!("{text}simulation: {{extend: {{{extend}}}}}\n"));
    let both = with("factor: 4");
    let lines = "  extend:\n    factor: 4.0\n    labels: [undecided, irregular]\n";
    assert!(both.resolved_yaml().contains(lines), "{}", both.resolved_yaml());
    let extend = both.simulation().extend.expect("extends");
    assert_eq!(
        (extend.factor, extend.labels.undecided, extend.labels.irregular),
        (4.0, true, true)
    );
    assert_eq!(both.simulation().end_times_s(), [16.5, 66.0]);
    assert_eq!(both.hash(), with("labels: [irregular, undecided], factor: 4.0").hash());
    let single = with("factor: 4, labels: [irregular]");
    let extend = single.simulation().extend.expect("extends");
    assert_eq!((extend.labels.undecided, extend.labels.irregular), (false, true));
    assert_ne!(single.hash(), both.hash());
    let found = &json_schema()["$defs"]["ExtendFile"];
    assert_eq!(found["required"], serde_json::json!(["factor"]));
    assert_eq!(
        found["properties"]["labels"]["default"],
        serde_json::json!(["undecided", "irregular"])
    );
}
