//! `expand` writes exactly the cases that `run` computes.

use super::support::{AT_ONCE, Scratch, counts, names, numbers, parse, row, study_text, words};
use crate::table::contract::listed;

/// Blocks with different columns, text values, and samples that include physically invalid ones.
fn study() -> String {
    let rest = "sweep:\n\
                \x20 - grid: {speed_rad_s: [-160.0, -200.0], normal_force: [lagrange, newton]}\n\
                \x20 - zip: {friction_coefficient: [1.0e-3]}\n\
                uncertain: {ball_mass_2_kg: {normal: {mean: 1.0e-4, std_dev: 1.0e-4}}}\n";
    study_text("a", "{monte_carlo: {samples: 300}}", AT_ONCE, rest)
}

fn columns() -> Vec<String> {
    listed(
        "run_id, point_id, cell, replicate, speed_rad_s, normal_force, friction_coefficient, \
         ball_mass_2_kg, initial_x, initial_y, initial_beta_1, initial_beta_2, initial_x_dot, \
         initial_y_dot, initial_beta_dot_1, initial_beta_dot_2, error",
    )
}

#[test]
fn csv_parquet_plan_and_run_agree() {
    let scratch = Scratch::with(study());
    let text = scratch.well("expand a.yaml");
    scratch.well("expand a.yaml --out cases.parquet");
    assert_eq!(scratch.stickslip("run a.yaml --out out").code, Some(3));
    let (cases, runs) = (scratch.table(".", "cases"), scratch.table("out", "runs"));
    let of_cases = names(&cases);
    assert_eq!(of_cases, columns());

    let mut reader = csv::Reader::from_reader(text.as_bytes());
    assert_eq!(reader.headers().expect("a header"), columns());
    let lines: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let study = parse(study());
    assert_eq!(study.run_count(), 1500);
    assert_eq!((lines.len(), cases.num_rows(), runs.num_rows()), (1500, 1500, 1500));

    let mut others = names(&runs);
    others.retain(|name| !of_cases.contains(name) || name == "error");
    let others: Vec<&str> = others.iter().map(String::as_str).collect();
    let (errors, run_errors) = (words(&cases, "error"), words(&runs, "error"));
    let mut invalid = 0;
    for (index, line) in lines.iter().enumerate() {
        let planned = study.planned_run(index as u64);
        let number = |column: usize| line[column].parse::<f64>().unwrap();
        assert_eq!((8..16).map(number).collect::<Vec<_>>(), planned.start.0);
        assert_eq!(number(7), planned.uncertain[0]);
        assert_eq!(number(0), index as f64);
        assert_eq!(number(1), planned.point_id as f64);
        assert_eq!(number(3), planned.replicate as f64);
        let swept: Vec<String> = planned.swept.iter().map(ToString::to_string).collect();
        assert_eq!((number(4), &line[5]), (swept[0].parse().unwrap(), swept[1].as_str()));
        let error = planned.case.as_ref().err().map(ToString::to_string);
        invalid += usize::from(error.is_some());
        assert_eq!(line[16], error.unwrap_or_default());
        // Parquet against Parquet, in all common columns; runs with a message have the message of
        // their case.
        assert_eq!(row(&cases, index, &["error"]), row(&runs, index, &others));
        if let Some(error) = &errors[index] {
            assert_eq!(run_errors[index].as_ref(), Some(error));
        }
    }
    assert!(invalid > 100, "{invalid}");
    for name in &of_cases[7..16] {
        assert_eq!(numbers(&cases, name), numbers(&runs, name));
    }
}

#[test]
fn a_shard_has_one_case_of_each_n() {
    let scratch = Scratch::with(study());
    scratch.well("expand a.yaml --shard 2/7 --out part.parquet");
    let ids = counts(&scratch.table(".", "part"), "run_id");
    assert!(ids.iter().map(|id| id / 7).eq(0..ids.len() as u64), "{ids:?}");
    assert!([214, 215].contains(&ids.len()), "{}", ids.len());
    // The position varies; with a constant one a shard would always have the same cells of a
    // stratified design.
    let places: std::collections::BTreeSet<u64> = ids.iter().map(|id| id % 7).collect();
    assert_eq!(places.len(), 7);
    let text = scratch.well("expand a.yaml --shard 2/7");
    assert_eq!(text.lines().count(), ids.len() + 1);
}

/// The ending of the name chooses the format, and a file is never overwritten.
#[test]
fn files_of_cases_have_their_format_and_are_new() {
    let scratch = Scratch::with(study());
    scratch.write("cases.parquet", "mine");
    scratch.refuses(
        "expand a.yaml --out",
        "cases.xlsx ¦ cases.xlsx: stickslip writes tables as Parquet or CSV only ¦ such as cases.parquet
cases.parquet ¦ cases.parquet: exists already ¦ allowed: the name of a new file
nowhere/cases.parquet ¦ cannot write nowhere/cases.parquet ¦ allowed: the name of a new file in a directory
a.yaml/cases.parquet ¦ cannot write a.yaml/cases.parquet ¦ allowed: the name of a new file in a directory",
    );
    let printed = scratch.well("expand a.yaml");
    assert_eq!(scratch.well("expand a.yaml --out cases.csv"), "");
    assert_eq!(scratch.text("cases.csv"), printed);
    assert!(scratch.files().keys().all(|path| !path.ends_with("stickslip-partial")));
    scratch.refused("expand a.yaml --out cases.csv", &["cases.csv: exists already"]);
}
