//! Designs of uncertain parameters: strata as properties, stability against edits, the resolved study and faults.

use std::collections::HashSet;

use stickslip::study::Study;

use super::{coordinates, refused, study, text_with_design};

/// Three parameters whose draws are the fractions of their distributions themselves.
const FRACTIONS: &str = "uncertain:
  table_mass_kg: {uniform: {min: 0, max: 1}}
  stiffness_n_m: {uniform: {min: 0, max: 1}}
  speed_rad_s: {uniform: {min: 0, max: 1}}
";

/// A box whose coordinates are the fractions of its axes themselves.
const UNIT_BOX: &str =
    "  box: {x: [0, 1], y: [0, 1], beta: [0, 1], x_dot: [0, 1], y_dot: [0, 1], beta_dot: [0, 1]}\n";

const STRATIFIED: &str = "{stratified: {parts_per_axis: 2, samples_per_cell: 3}}";

const TABLE: &str = "{table: {columns: [x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_2], \
                     rows: [[0, 0, 0, 0, 0, 0, 0, 0], [0, 0, 1, 2, 0, 0, 0, 0], [0, 0, 1, 3, 0, 0, 0, 0]]}}";

fn sampled(starts: &str, uncertain: &str) -> Study {
    let text = text_with_design(starts);
    study(&format!("{text}{UNIT_BOX}{FRACTIONS}uncertain_sampling: {{design: {uncertain}}}\n"))
}

fn drawn(study: &Study) -> Vec<Vec<f64>> {
    (0..study.run_count()).map(|run| study.planned_run(run).uncertain).collect()
}

/// Asserts that each axis has exactly one of the fractions in each of as many strata.
#[track_caller]
fn assert_stratified(fractions: &[Vec<f64>]) {
    let count = fractions.len() as f64;
    for axis in 0..fractions[0].len() {
        let strata = fractions.iter().map(|all| (all[axis] * count).floor() as u64);
        assert_eq!(strata.collect::<HashSet<u64>>().len(), fractions.len(), "axis {axis}");
    }
}

/// For any design of the start states, a Latin hypercube and, for powers of two, a Sobol' sequence.
#[test]
fn one_run_is_in_each_stratum() {
    for (design, starts, runs) in [
        ("latin_hypercube", "{monte_carlo: {samples: 1}}", 1),
        ("latin_hypercube", "{monte_carlo: {samples: 1000}}", 1000),
        ("latin_hypercube", "{latin_hypercube: {samples: 7}}", 7),
        ("latin_hypercube", "{sobol: {samples: 100}}", 100),
        ("latin_hypercube", STRATIFIED, 768),
        ("latin_hypercube", "{grid: {points_per_axis: 2}}", 256),
        ("latin_hypercube", TABLE, 3),
        ("sobol", "{monte_carlo: {samples: 1024}}", 1024),
        ("sobol", "{latin_hypercube: {samples: 64}}", 64),
        ("sobol", "{sobol: {samples: 65536}}", 65_536),
        ("sobol", "{stratified: {parts_per_axis: 2, samples_per_cell: 2}}", 512),
        ("sobol", "{grid: {points_per_axis: 2}}", 256),
    ] {
        let study = sampled(starts, design);
        assert_eq!(study.run_count(), runs, "{design} {starts}");
        assert_stratified(&drawn(&study));
    }
}

#[test]
fn joint_designs_stratify_start_states_and_parameters_together() {
    for (starts, runs) in
        [("{latin_hypercube: {samples: 1000}}", 1000), ("{sobol: {samples: 1024}}", 1024)]
    {
        let study = sampled(starts, "joint");
        let both = |run| [coordinates(&study, run), study.planned_run(run).uncertain].concat();
        let all: Vec<Vec<f64>> = (0..runs).map(both).collect();
        assert_eq!(all[0].len(), 8 + 3);
        assert_stratified(&all);
    }
}

/// The mean of the sum of all products of a start coordinate and an uncertain parameter, both relative to their means. Its
/// exact value is 0.
fn mean_of_products(starts: &str, uncertain: &str, seed: u64) -> f64 {
    let study = sampled(starts, uncertain).with_seed(seed).expect("a study");
    let sum = |all: &[f64]| all.iter().map(|fraction| fraction - 0.5).sum::<f64>();
    let product = |run| sum(&coordinates(&study, run)) * sum(&study.planned_run(run).uncertain);
    (0..study.run_count()).map(product).sum::<f64>() / study.run_count() as f64
}

/// A joint Sobol' sequence covers pairs of a start coordinate and a parameter evenly, other designs only each of the two.
#[test]
fn a_joint_sequence_integrates_products_better() {
    let error = |starts: &str, uncertain: &str| {
        let squares = (1..=20).map(|seed| mean_of_products(starts, uncertain, seed).powi(2));
        (squares.sum::<f64>() / 20.0).sqrt()
    };
    let independent = error("{monte_carlo: {samples: 512}}", "monte_carlo");
    // The standard deviation is sqrt(8/12 * 3/12) / sqrt(512) = 0.0180; 20 seeds, within four standard errors.
    assert!((independent / 0.0180 - 1.0).abs() < 4.0 / 40.0_f64.sqrt(), "{independent}");
    let joint = error("{sobol: {samples: 512}}", "joint");
    let apart = error("{sobol: {samples: 512}}", "sobol");
    println!("independent {independent}, apart {apart}, joint {joint}");
    assert!(joint < 0.2 * independent && joint < 0.2 * apart, "{joint}, {apart}, {independent}");
}

/// A Latin hypercube consists of independent axes, and so do independent draws.
#[test]
fn joint_is_the_own_design_unless_the_starts_are_a_sequence() {
    for (starts, uncertain) in [
        ("{latin_hypercube: {samples: 50}}", "latin_hypercube"),
        ("{monte_carlo: {samples: 50}}", "monte_carlo"),
    ] {
        assert_eq!(drawn(&sampled(starts, "joint")), drawn(&sampled(starts, uncertain)));
    }
    let starts = "{sobol: {samples: 64}}";
    assert_ne!(drawn(&sampled(starts, "joint")), drawn(&sampled(starts, "sobol")));
}

#[test]
fn an_own_design_is_unrelated_to_the_start_states() {
    let runs = 2048;
    for (starts, uncertain) in [
        ("{sobol: {samples: 2048}}", "sobol"),
        ("{latin_hypercube: {samples: 2048}}", "latin_hypercube"),
        ("{sobol: {samples: 2048}}", "latin_hypercube"),
        ("{stratified: {parts_per_axis: 2, samples_per_cell: 8}}", "sobol"),
    ] {
        let study = sampled(starts, uncertain);
        let mut sums = [[0.0; 3]; 8];
        for run in 0..runs {
            let (start, drawn) = (coordinates(&study, run), study.planned_run(run).uncertain);
            for (axis, sums) in sums.iter_mut().enumerate() {
                for (place, sum) in sums.iter_mut().enumerate() {
                    *sum += 12.0 * (start[axis] - 0.5) * (drawn[place] - 0.5);
                }
            }
        }
        // Independent permutations have the standard deviation sqrt(n); four of them, 24 tests.
        let largest = sums.iter().flatten().fold(0.0, |largest: f64, sum| largest.max(sum.abs()));
        assert!(largest < 4.0 * (runs as f64).sqrt(), "{starts} {uncertain}: {largest}");
    }
}

#[test]
fn points_share_their_draws_and_the_start_states_stay() {
    let sweep = "sweep: [{grid: {damping_n_s_m: [1, 2]}}]\n";
    for (starts, uncertain) in
        [(STRATIFIED, "latin_hypercube"), (STRATIFIED, "sobol"), ("{sobol: {samples: 9}}", "joint")]
    {
        let single = sampled(starts, uncertain);
        let text = format!("{}{UNIT_BOX}{sweep}{FRACTIONS}", text_with_design(starts));
        let two = study(&format!("{text}uncertain_sampling: {{design: {uncertain}}}\n"));
        let independent = study(&text);
        for run in 0..single.run_count() {
            let drawn = single.planned_run(run).uncertain;
            assert_eq!(two.planned_run(run).uncertain, drawn);
            assert_eq!(two.planned_run(run + single.run_count()).uncertain, drawn);
            assert_eq!(coordinates(&independent, run), coordinates(&two, run));
        }
    }
}

#[test]
fn random_directions_are_axes_of_the_design() {
    let text = text_with_design("{monte_carlo: {samples: 40}}").replace(
        "{kind: ball_balancer}",
        "{kind: ball_balancer, disturbances: [{kick: {at_s: 1, speed_m_s: 0.01}}]}",
    );
    let study = study(&format!("{text}uncertain_sampling: {{design: latin_hypercube}}\n"));
    let turns = |all: Vec<f64>| vec![all[0] / std::f64::consts::TAU];
    assert_stratified(&drawn(&study).into_iter().map(turns).collect::<Vec<_>>());
}

const DESIGNS: [(&str, &str); 3] = [
    ("{monte_carlo: {samples: 60}}", "latin_hypercube"),
    ("{monte_carlo: {samples: 60}}", "sobol"),
    ("{sobol: {samples: 60}}", "joint"),
];

fn with_parameters(starts: &str, uncertain: &str, names: &[&str]) -> Study {
    let each = names.iter().map(|name| format!("  {name}: {{uniform: {{min: 0, max: 1}}}}\n"));
    let text = format!("{}uncertain:\n{}", text_with_design(starts), each.collect::<String>());
    study(&format!("{text}uncertain_sampling: {{design: {uncertain}}}\n"))
}

#[test]
fn a_further_parameter_keeps_the_draws_of_those_before_it() {
    for (starts, uncertain) in DESIGNS {
        let names = ["table_mass_kg", "ring_radius_m"];
        let old = with_parameters(starts, uncertain, &names);
        let last = with_parameters(starts, uncertain, &[names[0], names[1], "speed_rad_s"]);
        let middle = with_parameters(starts, uncertain, &[names[0], "stiffness_n_m", names[1]]);
        for run in 0..60 {
            let drawn = old.planned_run(run).uncertain;
            assert_eq!(last.planned_run(run).uncertain[..2], drawn);
            let with_middle = middle.planned_run(run).uncertain;
            assert_eq!(with_middle[0], drawn[0]);
            // A sequence gives the next dimension to the next parameter.
            assert_eq!(with_middle[2] == drawn[1], uncertain == "latin_hypercube");
        }
    }
}

#[test]
fn larger_samples_and_further_balls_keep_the_draws_of_a_sequence() {
    for uncertain in ["sobol", "joint"] {
        let names = ["table_mass_kg", "stiffness_n_m"];
        let small = with_parameters("{sobol: {samples: 20}}", uncertain, &names);
        let large = with_parameters("{sobol: {samples: 90}}", uncertain, &names);
        let text = large.resolved_yaml().replace("balls: 2", "balls: 3");
        let text: String = text
            .lines()
            .filter(|line| !line.contains("beta_"))
            .fold(String::new(), |text, line| text + line + "\n");
        let balls = study(&text);
        assert_eq!(balls.model().balls(), 3);
        for run in 0..20 {
            let drawn = small.planned_run(run).uncertain;
            assert_eq!(large.planned_run(run).uncertain, drawn);
            assert_eq!(balls.planned_run(run).uncertain, drawn);
        }
    }
}

/// Pinned draws of run 17. A change here breaks reproducibility and must be announced in the changelog.
#[test]
fn designs_keep_their_values() {
    let designs = [
        ("{monte_carlo: {samples: 100}}", "monte_carlo"),
        ("{monte_carlo: {samples: 100}}", "latin_hypercube"),
        ("{monte_carlo: {samples: 100}}", "sobol"),
        ("{sobol: {samples: 100}}", "joint"),
    ];
    let found =
        designs.map(|(starts, uncertain)| sampled(starts, uncertain).planned_run(17).uncertain);
    let expected = [
        [0.8999197507631674, 0.7717029988631597, 0.11780211003030361],
        [0.9846250356568068, 0.6569356701759708, 0.6619995259335818],
        [0.241771399974823, 0.44451195001602173, 0.35340815782546997],
        [0.7354095578193665, 0.2510989308357239, 0.9942182898521423],
    ];
    assert_eq!(found, expected);
}

#[test]
fn the_resolved_study_contains_the_design_unless_draws_are_independent() {
    let text = text_with_design("{sobol: {samples: 8}}") + FRACTIONS;
    let plain = study(&text);
    assert!(!plain.resolved_yaml().contains("uncertain_sampling"));
    for default in ["{}", "{design: monte_carlo}"] {
        let written = study(&format!("{text}uncertain_sampling: {default}\n"));
        assert_eq!(written.hash(), plain.hash(), "{default}");
        assert_eq!(drawn(&written), drawn(&plain));
    }
    let mut hashes = HashSet::from([plain.hash()]);
    for design in ["latin_hypercube", "sobol", "joint"] {
        let first = study(&format!("{text}uncertain_sampling: {{design: {design}}}\n"));
        let resolved = first.resolved_yaml();
        assert!(resolved.contains(&format!("\nuncertain_sampling: {{design: {design}}}\n")));
        let second = study(&resolved);
        assert_eq!((second.hash(), drawn(&second)), (first.hash(), drawn(&first)));
        assert!(hashes.insert(first.hash()));
        let other = first.with_seed(6).expect("a study");
        assert_ne!(drawn(&other), drawn(&first));
    }
}

#[test]
fn a_sequence_ends_with_the_samples_of_a_precision() {
    let text = text_with_design("{monte_carlo: {samples: 100}}") + FRACTIONS;
    let precision = "precision: {equilibrium_fraction: 0.02, max_runs: 1e6}\n";
    let study = study(&format!("{text}{precision}uncertain_sampling: {{design: sobol}}\n"));
    assert_eq!(study.run_count(), 65_500);
    let last = study.planned_run(65_499);
    assert!(last.uncertain.iter().all(|fraction| (0.0..1.0).contains(fraction)));
}

#[test]
fn impossible_designs_are_refused() {
    let refuse = |starts: &str, rest: &str, found: &str, allowed: &str| {
        let text = text_with_design(starts) + FRACTIONS + "uncertain_sampling:\n" + rest;
        refused(&text, 12, "uncertain_sampling.design", found, allowed);
    };
    let precision =
        "  design: latin_hypercube\nprecision: {equilibrium_fraction: 0.1, max_runs: 9}\n";
    let allowed = "monte_carlo, sobol or joint, or no `precision`";
    refuse("{sobol: {samples: 4}}", precision, "latin_hypercube", allowed);
    let allowed = "sobol for at most 65536 runs at each point, or latin_hypercube";
    refuse("{monte_carlo: {samples: 65537}}", "  design: sobol\n", "65537 runs", allowed);
    let allowed = "latin_hypercube, sobol or monte_carlo for the start states, or";
    for (starts, kind) in
        [(STRATIFIED, "stratified"), ("{grid: {points_per_axis: 2}}", "grid"), (TABLE, "table")]
    {
        refuse(starts, "  design: joint\n", &format!("joint with the design {kind}"), allowed);
    }
    refuse("{sobol: {samples: 4}}", "  design: halton\n", "halton", "latin_hypercube");
    refuse("{sobol: {samples: 4}}", "  design: {sobol: {}}\n", "", "");
    // The design of one block of the sweep.
    let text = text_with_design("{sobol: {samples: 4}}") + FRACTIONS;
    let sweep = "sweep: [{grid: {damping_n_s_m: [1]}}, {grid: {damping_n_s_m: [2]}, \
                 design: {grid: {points_per_axis: 2}}}]\nuncertain_sampling: {design: joint}\n";
    refused(&(text + sweep), 12, "uncertain_sampling.design", "grid", allowed);
}

#[test]
fn a_design_needs_uncertain_parameters_and_known_keys() {
    let text = text_with_design("{sobol: {samples: 4}}");
    let alone = text.clone() + "uncertain_sampling: {design: sobol}\n";
    let found = "no uncertain parameter";
    refused(&alone, 7, "uncertain_sampling", found, "`uncertain` with at least");
    let text = text + FRACTIONS;
    for (rest, key, allowed) in [
        ("{desing: sobol}", "desing", "design (did you mean this?), correlations"),
        ("{design: }", "design", "monte_carlo"),
    ] {
        let text = format!("{text}uncertain_sampling: {rest}\n");
        refused(&text, 11, &format!("uncertain_sampling.{key}"), "", allowed);
    }
}
