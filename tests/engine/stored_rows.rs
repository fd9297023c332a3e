//! A study that grows has the rows that it had before.

use std::collections::BTreeMap;

use arrow::array::RecordBatch;

use crate::cli::support::{Scratch, rows_by_key, study_text};

fn run(text: &str) -> RecordBatch {
    let scratch = Scratch::ran(text);
    scratch.table("out", "runs")
}

/// Columns that identify a run in studies of any size.
const KEY: [&str; 3] = ["speed_rad_s", "cell", "replicate"];
/// Columns with numbers that change when the study grows.
const MOVE: [&str; 2] = ["run_id", "point_id"];

/// Asserts that every row of the old table is in the new one under its key, apart from renumbered
/// and new columns.
fn assert_kept(old: &RecordBatch, new: &RecordBatch) {
    let (old, new) = (rows_by_key(old, &KEY, &MOVE), rows_by_key(new, &KEY, &MOVE));
    assert!(!old.is_empty() && old.len() <= new.len());
    for (key, row) in &old {
        let found: BTreeMap<&str, &str> =
            new[key].iter().map(|(name, cell)| (name.as_str(), cell.as_str())).collect();
        for (name, cell) in row {
            assert_eq!(found[name.as_str()], cell, "{key:?}: {name}");
        }
    }
}

fn text(design: &str, speeds: &str, uncertain: &str) -> String {
    let rest =
        format!("sweep: [{{grid: {{speed_rad_s: {speeds}}}}}]\nuncertain: {{{uncertain}}}\n");
    study_text("a", design, 3.0, &rest)
}

const SPEEDS: &str = "[-160.8103, -216.3772]";
const MASS: &str = "ball_mass_kg: {uniform: {min: 1.3e-4, max: 1.5e-4}}";

#[test]
fn with_another_sweep_value() {
    let old = run(&text("{latin_hypercube: {samples: 12}}", SPEEDS, MASS));
    let more = "[-170.0, -160.8103, -191.6372, -216.3772]";
    let new = run(&text("{latin_hypercube: {samples: 12}}", more, MASS));
    assert_eq!((old.num_rows(), new.num_rows()), (24, 48));
    assert_kept(&old, &new);
}

#[test]
fn with_another_replicate() {
    let box_of = |samples: u32| {
        let fixed = "x: [0, 0], y: [0, 0], x_dot: [0, 0], y_dot: [0, 0], beta_dot: [-1, 1]";
        let design = format!("{{stratified: {{parts_per_axis: 2, samples_per_cell: {samples}}}}}");
        text(&design, SPEEDS, MASS)
            .replace("initial_conditions: {", &format!("initial_conditions: {{box: {{{fixed}}}, "))
    };
    let (old, new) = (run(&box_of(1)), run(&box_of(2)));
    assert_eq!((old.num_rows(), new.num_rows()), (32, 64));
    assert_kept(&old, &new);
}

#[test]
fn with_another_sample() {
    let old = run(&text("{monte_carlo: {samples: 8}}", SPEEDS, MASS));
    let new = run(&text("{monte_carlo: {samples: 13}}", SPEEDS, MASS));
    assert_kept(&old, &new);
}

/// A further uncertain parameter does not change the other samples; the outcomes are unchanged if
/// it always has the parameter's own value.
#[test]
fn with_another_uncertain_parameter() {
    let design = "{monte_carlo: {samples: 12}}";
    let old = run(&text(design, SPEEDS, MASS));
    let more = format!("stiffness_n_m: {{choice: {{values: [1.07e4]}}}}, {MASS}");
    let new = run(&text(design, SPEEDS, &more));
    assert!(new.column_by_name("stiffness_n_m").is_some());
    assert_kept(&old, &new);
}
