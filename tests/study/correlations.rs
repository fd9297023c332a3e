//! Correlated uncertain parameters: marginals, rank correlations, stability against edits, and faults.

use statrs::distribution::{ContinuousCDF, LogNormal, Normal};
use stickslip::study::Study;

use super::{assert_follows, parse, study, text_with_design};
use crate::support::cases;

const ALPHA: f64 = 1.0e-3;

const UNCERTAIN: &str = "uncertain:
  table_mass_kg: {uniform: {min: 0, max: 1}}
  stiffness_n_m: {normal: {mean: 1.0e4, std_dev: 100}}
  damping_n_s_m: {lognormal: {mean: 2, std_dev: 1}}
  ring_radius_m: {triangular: {min: 0, mode: 0, max: 1}}
  speed_rad_s: {times: {uniform: {min: 0.5, max: 2}}}
";

/// The rank correlations of [`CORRELATED`] by the places of two parameters.
const REQUESTED: [(usize, usize, f64); 4] = [(0, 1, 0.8), (0, 2, -0.5), (1, 2, -0.25), (2, 4, 0.3)];

const CORRELATED: &str = "correlations:
    - {parameters: [table_mass_kg, stiffness_n_m], rank_correlation: 0.8}
    - {parameters: [damping_n_s_m, table_mass_kg], rank_correlation: -0.5}
    - {parameters: [stiffness_n_m, damping_n_s_m], rank_correlation: -0.25}
    - {parameters: [speed_rad_s, damping_n_s_m], rank_correlation: 0.3}
";

const RUNS: usize = 8192;

fn correlated(starts: &str, design: &str) -> Study {
    let text = text_with_design(starts);
    study(&format!("{text}{UNCERTAIN}uncertain_sampling:\n  design: {design}\n  {CORRELATED}"))
}

fn designs() -> Vec<Study> {
    let (independent, sequence) = ("{monte_carlo: {samples: 8192}}", "{sobol: {samples: 8192}}");
    let studies =
        ["monte_carlo", "latin_hypercube", "sobol"].map(|design| correlated(independent, design));
    studies.into_iter().chain([correlated(sequence, "joint")]).collect()
}

/// Returns the draws by parameter.
fn columns(study: &Study) -> Vec<Vec<f64>> {
    let runs: Vec<Vec<f64>> =
        (0..study.run_count()).map(|run| study.planned_run(run).uncertain).collect();
    (0..runs[0].len()).map(|place| runs.iter().map(|run| run[place]).collect()).collect()
}

/// Returns the ranks from 0, without ties.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|place, other| values[*place].total_cmp(&values[*other]));
    let mut ranks = vec![0.0; values.len()];
    for (rank, index) in order.into_iter().enumerate() {
        ranks[index] = rank as f64;
    }
    ranks
}

/// Returns Spearman's rank correlation.
fn spearman(first: &[f64], other: &[f64]) -> f64 {
    let count = first.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let products = ranks(first).into_iter().zip(ranks(other));
    let sum: f64 = products.map(|(left, right)| (left - middle) * (right - middle)).sum();
    12.0 * sum / (count * (count * count - 1.0))
}

#[test]
fn marginals_follow_their_distributions() {
    let normal = Normal::new(1.0e4, 100.0).expect("a positive deviation");
    let variance = 1.25_f64.ln();
    let lognormal = LogNormal::new(2.0_f64.ln() - variance / 2.0, variance.sqrt())
        .expect("a positive deviation");
    let nominal = -216.3772;
    for study in designs() {
        let columns = columns(&study);
        let cdfs: [&dyn Fn(f64) -> f64; 5] = [
            &|x| x,
            &|x| normal.cdf(x),
            &|x| lognormal.cdf(x),
            &|x| 1.0 - (1.0 - x).powi(2),
            &|x| 1.0 - (x / nominal - 0.5) / 1.5,
        ];
        for (column, cdf) in columns.into_iter().zip(cdfs) {
            assert_follows(column, cdf, ALPHA);
        }
    }
}

/// The standard error of a rank correlation of n pairs is at most 1/sqrt(n); four of them are the tolerance.
#[test]
fn rank_correlations_are_those_requested() {
    let tolerance = 4.0 / (RUNS as f64).sqrt();
    for study in designs() {
        let columns = columns(&study);
        for first in 0..5 {
            for other in first + 1..5 {
                let requested = REQUESTED.iter().find(|pair| (pair.0, pair.1) == (first, other));
                // The nominal speed is negative, and the correlation is that of its factor.
                let sign = if other == 4 { -1.0 } else { 1.0 };
                let requested = requested.map_or(0.0, |pair| sign * pair.2);
                let found = spearman(&columns[first], &columns[other]);
                println!("{first} {other}: requested {requested}, found {found:.4}");
                assert!((found - requested).abs() < tolerance, "{first}, {other}: {found}");
            }
        }
    }
}

/// Parameters that do not depend on earlier ones keep the draws without correlations, to the last bit.
#[test]
fn the_first_parameter_of_a_pair_and_all_others_keep_their_draws() {
    let starts = "{monte_carlo: {samples: 200}}";
    for design in ["monte_carlo", "latin_hypercube", "sobol"] {
        let plain = study(&format!(
            "{}{UNCERTAIN}uncertain_sampling: {{design: {design}}}\n",
            text_with_design(starts)
        ));
        let (with, without) = (columns(&correlated(starts, design)), columns(&plain));
        let same: Vec<bool> = (0..5).map(|place| with[place] == without[place]).collect();
        assert_eq!(same, [true, false, false, true, false]);
    }
}

fn small(uncertain: &str, correlations: &str) -> Study {
    let text = text_with_design("{monte_carlo: {samples: 50}}");
    study(&format!(
        "{text}uncertain:\n{uncertain}uncertain_sampling: {{correlations: [{correlations}]}}\n"
    ))
}

#[test]
fn further_parameters_keep_the_draws_of_the_others() {
    let line = |name: &str| format!("  {name}: {{normal: {{mean: 10, std_dev: 1}}}}\n");
    let [first, middle, second, last] =
        ["table_mass_kg", "stiffness_n_m", "ring_radius_m", "speed_rad_s"].map(line);
    let pair = "{parameters: [table_mass_kg, ring_radius_m], rank_correlation: 0.6}";
    let old = columns(&small(&format!("{first}{second}"), pair));
    // An uncorrelated parameter between the others.
    let new = columns(&small(&format!("{first}{middle}{second}"), pair));
    assert_eq!([&new[0], &new[2]], [&old[0], &old[1]]);
    // A correlated parameter after the others.
    let more = "{parameters: [speed_rad_s, ring_radius_m], rank_correlation: -0.4}";
    let new = columns(&small(&format!("{first}{second}{last}"), &format!("{more}, {pair}")));
    assert_eq!(new[..2], old);
    // A correlated parameter before one of the others changes the draws of that one.
    let more = "{parameters: [stiffness_n_m, ring_radius_m], rank_correlation: -0.4}";
    let new = columns(&small(&format!("{first}{middle}{second}"), &format!("{more}, {pair}")));
    assert!(new[0] == old[0] && new[2] != old[1]);
}

#[test]
fn the_order_of_the_file_and_units_do_not_matter() {
    let uncertain = "  table_mass: {normal: {mean: 300 g, std_dev: 1 g}}
  stiffness_n_m: {normal: {mean: 1.0e4, std_dev: 100}}
  damping_n_s_m: {uniform: {min: 1, max: 2}}
";
    let pair = "{parameters: [table_mass, stiffness], rank_correlation: 0.5}";
    let turned = "{rank_correlation: 0.5, parameters: [stiffness_n_m, table_mass_kg]}";
    let other = "{parameters: [damping_n_s_m, stiffness_n_m], rank_correlation: -0.5}";
    let first = small(uncertain, &format!("{pair}, {other}"));
    let second = small(uncertain, &format!("{other}, {turned}"));
    assert_eq!((second.hash(), columns(&second)), (first.hash(), columns(&first)));
    let resolved = "uncertain_sampling:
  design: monte_carlo
  correlations:
    - parameters: [table_mass_kg, stiffness_n_m]
      rank_correlation: 0.5
    - parameters: [stiffness_n_m, damping_n_s_m]
      rank_correlation: -0.5
";
    assert!(first.resolved_yaml().contains(resolved), "{}", first.resolved_yaml());
    let again = study(&first.resolved_yaml());
    assert_eq!((again.hash(), columns(&again)), (first.hash(), columns(&first)));
    let weaker = small(uncertain, &format!("{other}, {}", turned.replace("0.5", "0.4")));
    assert_ne!(weaker.hash(), first.hash());
}

/// Pinned draws of run 17. A change here breaks reproducibility and must be announced in the changelog.
#[test]
fn correlated_draws_keep_their_values() {
    let found = correlated("{monte_carlo: {samples: 100}}", "latin_hypercube").planned_run(17);
    let expected = [
        0.9846250356568068,
        10199.237514459966,
        1.4372129760814782,
        0.2798591303785565,
        -348.50874242185824,
    ];
    for (found, expected) in found.uncertain.iter().zip(expected) {
        // Normal distribution functions may differ in the last digits between platforms.
        assert!((found - expected).abs() <= 1.0e-12 * f64::abs(expected), "{found:?} {expected:?}");
    }
}

/// Strong correlations are possible, up to those that leave nothing to a parameter.
#[test]
fn strong_correlations_are_accepted() {
    let uncertain = "  table_mass_kg: {uniform: {min: 0, max: 1}}
  stiffness_n_m: {uniform: {min: 0, max: 1}}
";
    for value in [0.9999, -0.9999] {
        let pair =
            format!("{{parameters: [table_mass_kg, stiffness_n_m], rank_correlation: {value}}}");
        let columns = columns(&small(uncertain, &pair));
        for (first, other) in columns[0].iter().zip(&columns[1]) {
            let expected = if value > 0.0 { *first } else { 1.0 - first };
            assert!((other - expected).abs() < 0.03, "{first} {other}");
        }
    }
}

#[track_caller]
fn refused(correlations: &str, line: usize, key: &str, found: &str, allowed: &str) {
    let text = text_with_design("{sobol: {samples: 4}}");
    let text = format!("{text}{UNCERTAIN}uncertain_sampling:\n  correlations:{correlations}\n");
    super::refused(&text, line, &format!("uncertain_sampling.correlations{key}"), found, allowed);
}

/// Pairs, with `P` for two parameters, the line of the message, its key, what it found, and what it allows.
const FAULTY: &str = r" [] ¦ 14 ¦  ¦ an empty list ¦ at least one pair, or no `correlations`
\n    - {parameters: [table_mass_kg], rank_correlation: 0.5} ¦ 15 ¦ [0].parameters ¦ a list of 1 ¦ two different
\n    - {parameters: [table_mass_kg, stiffness_n_m, speed_rad_s], rank_correlation: 0.5} ¦ 15 ¦ [0].parameters ¦ a list of 3 ¦ two different
\n    - {parameters: [stiffness, stiffness_n_m], rank_correlation: 0.5} ¦ 15 ¦ [0].parameters ¦ twice ¦ two different
\n    - {P, rank_correlation: 0.5}\n    - {parameters: [stiffness_n_m, table_mass], rank_correlation: 0.5} ¦ 16 ¦ [1].parameters ¦ here and in item 0 ¦ each pair once
\n    - {parameters: [table_mas_kg, speed_rad_s], rank_correlation: 0.5} ¦ 15 ¦ [0].parameters[0] ¦ mas_kg ¦ table_mass_kg (did you mean this?), stiffness_n_m
# A parameter that is not uncertain.
\n    - {parameters: [speed_rad_s, ball_mass_kg], rank_correlation: 0.5} ¦ 15 ¦ [0].parameters[1] ¦ ball_mass_kg ¦ table_mass_kg
\n    - {P, rank_correlation: 1} ¦ 15 ¦ [0].rank_correlation ¦ 1 ¦ above -1 and below 1
\n    - {P, rank_correlation: -1} ¦ 15 ¦ [0].rank_correlation ¦ -1 ¦ above -1 and below 1
\n    - {P, rank_correlation: 1.5} ¦ 15 ¦ [0].rank_correlation ¦ 1.5 ¦ above -1 and below 1
\n    - {P, rank_correlation: 2} ¦ 15 ¦ [0].rank_correlation ¦ 2 ¦ above -1 and below 1
\n    - {P, rank_correlation: strong} ¦ 15 ¦ [0].rank_correlation ¦ strong ¦ a number
\n    - {P, rank_correlation: .nan} ¦ 15 ¦ [0].rank_correlation ¦ .nan ¦ a finite number
\n    - {P, correlation: 0.5} ¦ 15 ¦ [0].correlation ¦ correlation ¦ rank_correlation (did you mean this?)
\n    - {P} ¦ 15 ¦ [0].rank_correlation ¦  ¦ rank_correlation";

#[test]
fn faulty_pairs_are_refused() {
    for [pairs, line, key, found, allowed] in cases(FAULTY) {
        let pairs = pairs.replace("{P", "{parameters: [table_mass_kg, stiffness_n_m]");
        refused(&pairs, line.parse().expect("a line"), &key, &found, &allowed);
    }
}

/// The message names a pair of the parameter at which the correlations become impossible, and the values that are
/// possible; these are indeed accepted, and those beyond them are not.
#[test]
fn contradictions_are_refused_with_a_remedy() {
    let items = |last: f64| {
        format!(
            "
    - {{parameters: [table_mass_kg, stiffness_n_m], rank_correlation: 0.9}}
    - {{parameters: [table_mass_kg, damping_n_s_m], rank_correlation: 0.8}}
    - {{parameters: [stiffness_n_m, damping_n_s_m], rank_correlation: {last}}}"
        )
    };
    let found =
        "-0.3 for stiffness_n_m and damping_n_s_m, with those of the other pairs of damping";
    let allowed = "0.478 to 0.98 for this pair, which the other pairs leave possible, or weaker";
    refused(&items(-0.3), 17, "[2].rank_correlation", found, allowed);
    let text = |last| {
        let text = text_with_design("{sobol: {samples: 4}}");
        format!("{text}{UNCERTAIN}uncertain_sampling:\n  correlations:{}\n", items(last))
    };
    for (value, possible) in [(0.478, true), (0.98, true), (0.476, false), (0.982, false)] {
        assert_eq!(parse(&text(value)).is_ok(), possible, "{value}");
    }
    // The same with the pairs in another order: the message is at the last pair of the parameter.
    let turned = "
    - {parameters: [stiffness_n_m, damping_n_s_m], rank_correlation: -0.3}
    - {parameters: [table_mass_kg, damping_n_s_m], rank_correlation: 0.8}
    - {parameters: [table_mass_kg, stiffness_n_m], rank_correlation: 0.9}";
    let found = "0.8 for table_mass_kg and damping_n_s_m";
    refused(turned, 16, "[1].rank_correlation", found, "weaker correlations of damping_n_s_m");
}
