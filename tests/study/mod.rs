//! Study files, sampling and plans, through the public interface.

use std::path::Path;

use stickslip::model::Machine;
use stickslip::study::{ParameterValue, Plan, Study, StudyError};

mod audit;
mod bad_files;
mod bad_tables;
mod bad_values;
mod changed_keys;
mod contact;
mod correlations;
mod design_tables;
mod designs;
mod determined;
mod distributions;
mod endings;
mod further_errors;
mod hostile_systems;
mod identify;
mod models;
mod numbers_of_balls;
mod parquet_tables;
mod plan;
mod precision;
mod resolved;
mod schema_agrees;
mod shipped;
mod stability;
mod stages;
mod system_files;
mod table_places;
mod templates;
mod uncertain_sampling;
mod units;
mod variables;
mod yaml_1_1;

/// Parses a text as the content of `a.yaml`.
fn parse(text: &str) -> Result<Study, StudyError> {
    Study::parse(Path::new("a.yaml"), text.to_owned())
}

fn study(text: &str) -> Study {
    parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Checks line, key, finding and remedy of the error of a study.
#[track_caller]
fn refused(text: &str, line: usize, key: &str, found: &str, allowed: &str) {
    let error = parse(text).err().unwrap_or_else(|| panic!("accepted: {text}"));
    assert_eq!((error.line(), error.key()), (Some(line), key), "{error}");
    says(&error, found, allowed);
}

/// Checks finding and remedy of an error.
#[track_caller]
fn says(error: &StudyError, found: &str, allowed: &str) {
    assert!(error.found().unwrap_or_default().contains(found), "{error}");
    assert!(error.allowed().unwrap_or_default().contains(allowed), "{error}");
}

/// Loads a study with this design and further lines from a folder with a table.
fn load_with(name: &str, table: &[u8], rest: &str, design: &str) -> Result<Study, StudyError> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join(name), table).expect("a table");
    let study = folder.path().join("study.yaml");
    std::fs::write(&study, format!("{}{rest}", text_with_design(design))).expect("a study");
    Study::load(&study)
}

/// Returns a study with this design, model defaults, and further lines.
fn with_design(design: &str, rest: &str) -> Study {
    study(&format!("{}{rest}", text_with_design(design)))
}

/// Returns the text of a study with this design: six lines.
fn text_with_design(design: &str) -> String {
    format!(
        "schema: 1\nname: a\nseed: 5\nmodel: {{kind: ball_balancer}}\n\
         initial_conditions:\n  design: {design}\n"
    )
}

/// Returns the coordinates of a run's start state in the order x, y, beta ..., x_dot, y_dot,
/// beta_dot ...
fn coordinates(study: &Study, run: u64) -> Vec<f64> {
    study.planned_run(run).start.0
}

/// Checks that two studies have the same runs.
#[track_caller]
fn same_runs(first: &Study, other: &Study) {
    assert_eq!(first.run_count(), other.run_count());
    for run in 0..first.run_count() {
        assert_eq!(first.planned_run(run), other.planned_run(run), "run {run}");
    }
}

/// Returns every law of friction, with speeds in this unit.
fn laws(unit: &str) -> [String; 5] {
    [
        "coulomb".to_owned(),
        format!("{{stribeck: {{static_friction_coefficient: 0.5, stribeck_speed_{unit}: 1}}}}"),
        format!("{{smooth: {{smoothing_speed_{unit}: 0.01}}}}"),
        "{viscous: {viscous_coefficient_n_s_m: 0.01}}".to_owned(),
        "{coulomb_viscous: {viscous_coefficient_n_s_m: 0.01}}".to_owned(),
    ]
}

fn machine_at(plan: &Plan, point: u64) -> Machine {
    plan.point(point).model().ball_balancer().expect("a balancer").clone()
}

/// Returns coordinates as fractions of the default box for two balls.
fn fractions(study: &Study, run: u64) -> Vec<f64> {
    let tau = std::f64::consts::TAU;
    let low = [-0.05, -0.05, 0.0, 0.0, -0.05, -0.05, -1.0, -1.0];
    let width = [0.1, 0.1, tau, tau, 0.1, 0.1, 2.0, 2.0];
    let all = coordinates(study, run);
    (0..8).map(|axis| (all[axis] - low[axis]) / width[axis]).collect()
}

/// Compares the largest difference between the empirical distribution and a distribution function
/// (Kolmogorov-Smirnov) with its critical value for a given alpha (asymptotic, for at least
/// hundreds of samples).
fn assert_follows(mut samples: Vec<f64>, cdf: impl Fn(f64) -> f64, alpha: f64) {
    samples.sort_by(f64::total_cmp);
    let count = samples.len() as f64;
    let mut largest: f64 = 0.0;
    for (index, sample) in samples.iter().enumerate() {
        let expected = cdf(*sample);
        let (below, above) = (index as f64 / count, (index + 1) as f64 / count);
        largest = largest.max(expected - below).max(above - expected);
    }
    let critical = (-0.5 * (alpha / 2.0).ln()).sqrt() / count.sqrt();
    assert!(largest < critical, "distance {largest} is above {critical}");
}

/// Returns the swept values of a point, which must be numbers.
fn swept_numbers(study: &Study, point: u64) -> Vec<f64> {
    let number = |value: &ParameterValue| match value {
        ParameterValue::Number(number) => *number,
        ParameterValue::Text(text) => panic!("{text}"),
    };
    study.point(point).swept.iter().map(number).collect()
}
