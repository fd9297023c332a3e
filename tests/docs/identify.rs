//! The numbers of docs/identify.md come from docs/records/identify.json, which `scripts/identify-synthetic` computes: the
//! outcomes of inferences from synthetic measurements with known truths.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::generated::compare_or_write_part;
use super::records::stale;

const PAGE: &str = "docs/identify.md";
/// The level of the test of uniform ranks.
const RANK_LEVEL: f64 = 1e-3;
/// The least fraction of repetitions in which the 95 % interval contains the truth. The intervals are
/// slightly too narrow (docs/identify.md).
const LEAST_COVERAGE: f64 = 0.8;

/// Returns the record, which is of the studies as they are now.
fn record() -> Value {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("docs/records/identify.json")).expect("a record");
    let record: Value = serde_json::from_str(&text).expect("JSON");
    let of = record["of"].as_array().expect("a list");
    assert!(!of.is_empty());
    for study in of {
        if let Some(why) = stale(study, study["study"].as_str().expect("a study")) {
            panic!("{why}; `scripts/identify-synthetic` computes the record anew");
        }
    }
    record
}

/// Returns the probability of a Kolmogorov-Smirnov distance from the uniform distribution at least as large as that of these
/// values (M. A. Stephens 1970, with his correction for the number of values).
fn kolmogorov_smirnov(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let count = values.len() as f64;
    let distance = (0..).zip(&values).fold(0.0_f64, |most, (index, value)| {
        let steps = [f64::from(index) / count, f64::from(index + 1) / count];
        most.max((value - steps[0]).abs()).max((value - steps[1]).abs())
    });
    let root = count.sqrt();
    let scaled = (root + 0.12 + 0.11 / root) * distance;
    let term = |k: i32| {
        let sign = if k % 2 == 1 { 2.0 } else { -2.0 };
        sign * (-2.0 * (f64::from(k) * scaled).powi(2)).exp()
    };
    (1..=100).map(term).sum::<f64>().clamp(0.0, 1.0)
}

/// The distance of evenly spaced values is small, and that of squeezed ones large.
#[test]
fn distances_from_the_uniform_distribution() {
    let even = |index: i32| (f64::from(index) + 0.5) / 100.0;
    assert!(kolmogorov_smirnov((0..100).map(even).collect()) > 0.99);
    assert!(kolmogorov_smirnov((0..100).map(|index| 0.25 + 0.5 * even(index)).collect()) < 1e-3);
}

/// What the command prints for the shipped measurements, and the truth of these lies within both intervals.
#[test]
fn the_example() {
    let record = record();
    let text = record["example"].as_str().expect("text");
    for (parameter, truth) in
        [("friction_coefficient", 2.75e-3), ("contact_friction_coefficient", 0.1)]
    {
        let line =
            text.lines().find(|line| line.starts_with(&format!("{parameter} "))).expect("a row");
        let numbers: Vec<f64> =
            line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let [low, high] = [numbers[2], numbers[3]];
        assert!(low < truth && truth < high, "{line}");
    }
    assert!(text.contains("The model explains the 200 measured runs"), "{text}");
    compare_or_write_part(PAGE, "identify", &format!("\n```text\n{text}```\n"));
}

/// The least number of repetitions of a family in the record.
const REPETITIONS: usize = 100;

/// The ranks of the truth are uniform, the test of the fit rejects true models rarely, and the model without contact nearly
/// always.
#[test]
fn synthetic_measurements() {
    let record = record();
    let families = record["families"].as_object().expect("families");
    assert_eq!(families.len(), 4, "friction, contact, runout and ghosts");
    let mut table = "\n| truth | inferred | repetitions | ranks uniform, p | truth in the 95 % interval | std. dev. / mean | \
        width/prior | fit rejected |\n|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for (family, outcomes) in families {
        let title = match family.as_str() {
            "friction" => "balls pass through each other",
            "contact" => "balls touch",
            "runout" => "the ring has runout",
            "ghosts" => "balls touch, inferred without contact",
            other => panic!("unknown family {other}"),
        };
        let outcomes = outcomes.as_array().expect("a list");
        let count = outcomes.len();
        assert!(count >= REPETITIONS, "{family}: {count}");
        let rejected = outcomes.iter().filter(|outcome| outcome["fit"]["rejected"] == true).count();
        if family == "ghosts" {
            assert!(20 * rejected >= 19 * count, "{family}: {rejected} of {count}");
            table.push_str(&format!("| {title} | | {count} | | | | | {rejected} |\n"));
            continue;
        }
        // Three standard deviations above a level of 0.05: a probability of about 0.002.
        let level = 0.05 * count as f64;
        assert!(rejected as f64 <= level + 3.0 * (0.95 * level).sqrt(), "{family}: {rejected}");
        let first = outcomes[0]["parameters"].as_object().expect("parameters");
        for parameter in first.keys() {
            let of = |key: &str| -> Vec<f64> {
                let value = |outcome: &Value| {
                    outcome["parameters"][parameter][key].as_f64().expect("a number")
                };
                outcomes.iter().map(value).collect()
            };
            let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
            let uniform = kolmogorov_smirnov(of("rank"));
            let ends = of("low").into_iter().zip(of("high")).zip(of("truth"));
            let covered = ends.filter(|((low, high), truth)| low <= truth && truth <= high).count();
            assert!(uniform > RANK_LEVEL, "{family}, {parameter}: {uniform}");
            assert!(
                covered as f64 >= LEAST_COVERAGE * count as f64,
                "{family}, {parameter}: {covered}"
            );
            let relative = of("std_dev").into_iter().zip(of("mean")).map(|(dev, mean)| dev / mean);
            table.push_str(&format!(
                "| {title} | `{parameter}` | {count} | {uniform:.2} | {covered} | {:.1} % | {:.2} | {rejected} |\n",
                100.0 * mean(relative.collect()),
                mean(of("width_over_prior")),
            ));
        }
    }
    compare_or_write_part(PAGE, "identify-synthetic", &format!("{table}\n"));
}
