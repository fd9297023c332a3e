//! Mutilated study files never panic: they are studies, or get a message.

use proptest::prelude::*;

use super::parse;

const SEED: &str = "\
schema: 1
name: fuzz
seed: 5
model:
  kind: ball_balancer
  parameters: {table_mass_kg: 0.3, balls: [{}, {mass_kg: 1.0e-4}], speed_rad_s: -200}
  normal_force: newton
sweep:
  - grid: {speed_rad_s: [-160, -200], normal_force: [newton, lagrange]}
  - zip: {damping_n_s_m: [1.0, 2.0], friction_coefficient: [0, 0.1]}
    design: {latin_hypercube: {samples: 3}}
  - table: {columns: [speed_rad_s, ball_mass_1_kg], rows: [[1, 2], [3, 4]]}
    design: {sobol: {samples: 4}}
uncertain:
  imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}}
  stiffness_n_m: {truncated_normal: {mean: 1.0e4, std_dev: 1, min: 9.9e3, max: 1.1e4}}
  imbalance_radius_m: {choice: {values: [1, 2], weights: [0, 1]}}
  ring_radius_m: {lognormal: {mean: 1, std_dev: 1}}
initial_conditions:
  box: {x: [-0.05, 0.05], beta: [0, 6.28], beta_dot_2: [0, 0]}
  design: {stratified: {parts_per_axis: 2, samples_per_cell: 3}}
simulation: {method: switch, tolerance: {relative: 1.0e-8}}
audit: {fraction: 0.05}
expect:
  - {point: {speed_rad_s: -160}, equilibrium_fraction: [0.5, 1.0]}
";

const PIECES: [&str; 34] = [
    "0",
    "-1",
    "9",
    "1e308",
    "-1e308",
    "1e-320",
    "1e15",
    "18446744073709551615",
    ".nan",
    ".inf",
    "~",
    "true",
    "[]",
    "{}",
    "[",
    "]",
    "{",
    "}",
    ":",
    ": ",
    "- ",
    "\n",
    "\n  ",
    "&a ",
    "*a",
    "!!int ",
    "\"",
    "'",
    "#",
    "|",
    "é",
    "\t",
    "? ",
    "<<: ",
];

/// Replaces `length` characters from `at` (both as shares) by a piece.
fn mutilate(text: &str, at: usize, length: usize, piece: &str) -> String {
    let all: Vec<char> = text.chars().collect();
    let at = at % (all.len() + 1);
    let end = (at + length).min(all.len());
    all[..at].iter().collect::<String>() + piece + &all[end..].iter().collect::<String>()
}

fn survive(text: &str) {
    match parse(text) {
        Err(error) => assert!(error.to_string().starts_with("a.yaml")),
        Ok(study) => {
            let last = study.run_count() - 1;
            for run in [0, last / 3, last] {
                let planned = study.planned_run(run);
                assert!(planned.uncertain.iter().all(|value| !value.is_nan()));
            }
            let resolved = study.resolved_yaml();
            let again = parse(&resolved).unwrap_or_else(|error| panic!("{error}\n{resolved}"));
            assert_eq!(again.hash(), study.hash(), "{text}\n{resolved}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn mutilated_studies_never_panic(
        edits in prop::collection::vec((any::<usize>(), 0_usize..12, 0..PIECES.len()), 1..4)
    ) {
        let mut text = SEED.to_owned();
        for (at, length, piece) in edits {
            text = mutilate(&text, at, length, PIECES[piece]);
        }
        survive(&text);
    }

    #[test]
    fn other_numbers_never_panic(at in 0_usize..60, piece in 0_usize..11) {
        // Replaces one number by another.
        let starts: Vec<usize> = SEED
            .match_indices(|c: char| c.is_ascii_digit() || c == '-')
            .map(|(index, _)| index)
            .filter(|&index| matches!(SEED.as_bytes()[index - 1], b' ' | b'['))
            .filter(|&index| SEED.as_bytes()[index + 1] != b' ')
            .collect();
        let start = starts[at % starts.len()];
        let rest = &SEED[start..];
        let length = rest.find([',', ']', '}', '\n']).unwrap_or(rest.len());
        survive(&mutilate(SEED, start, length, PIECES[piece]));
    }

    #[test]
    fn any_text_never_panics(text in "\\PC{0,200}") {
        survive(&text);
    }
}
