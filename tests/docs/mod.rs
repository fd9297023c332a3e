//! The README says what the program does: its outputs, its study and its commands are run.

mod convergence;
pub mod generated;
mod records;
mod tutorial;

use std::path::Path;
use std::process::{Command, Output};

use arrow::array::RecordBatch;
use stickslip::analysis::{Z_95, wilson};

use crate::cli::support::{counts, numbers, table, words};

const README: &str = include_str!("../../README.md");

fn stickslip(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// The code block that follows a line of the README.
fn block_after(line: &str) -> String {
    let mut lines = README.lines().skip_while(|text| *text != line).skip(1);
    assert!(lines.next().is_some_and(|fence| fence.starts_with("```")), "a block after {line}");
    lines.take_while(|text| !text.starts_with("```")).map(|text| format!("{text}\n")).collect()
}

/// The table that the first command prints is the one in the README.
#[test]
fn output_of_the_first_command() {
    let out = tempfile::tempdir().expect("a folder");
    let folder = out.path().join("results");
    let folder = folder.to_str().expect("a plain name");
    let output = stickslip(&["run", "studies/preferred-equilibria.yaml", "--out", folder]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(printed, block_after("<!-- tested: preferred-equilibria -->"));
    // Numbers that other pages take from this study.
    let points = table(&out.path().join("results/points.parquet"));
    let irregular = numbers(&points, "speed_rad_s").iter().position(|one| *one == Some(-191.6372));
    let rate = records::escape_rate(&points, irregular.expect("the irregular speed"));
    let rate_in_words = records::rate_in_words(&rate);
    generated::compare_or_write_part("docs/endings.md", "escape-rate-thesis", &rate_in_words);
    let from = format!("{:.1} s", rate["from_s"].as_f64().expect("a time"));
    generated::compare_or_write_part("docs/endings.md", "escape-from-thesis", &from);
    generated::compare_or_write_part(
        "docs/endings.md",
        "stratified-narrower",
        &stratified_narrower(&points),
    );
}

/// How much narrower than Wilson's the intervals of the points with stratified ones are.
fn stratified_narrower(points: &RecordBatch) -> String {
    let [low, high] = ["ci_low", "ci_high"].map(|name| numbers(points, name));
    let (rests, runs) = (counts(points, "equilibrium_runs"), counts(points, "runs"));
    let methods = words(points, "ci_method");
    let stratified = |point: &usize| methods[*point].as_deref() == Some("stratified");
    let narrower = (0..points.num_rows()).filter(stratified).map(|point| {
        let (from, to) = wilson(rests[point], runs[point], Z_95);
        1.0 - (high[point].unwrap() - low[point].unwrap()) / (to - from)
    });
    let narrower: Vec<f64> = narrower.collect();
    let least = narrower.iter().copied().fold(f64::INFINITY, f64::min);
    let most = narrower.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!("{:.0} to {:.0} %", (100.0 * least).abs(), 100.0 * most)
}

/// The equilibrium sets of the thesis, as the README shows them.
#[test]
fn output_of_equilibria() {
    let out = tempfile::tempdir().expect("a folder");
    let folder = out.path().join("sets");
    let folder = folder.to_str().expect("a plain name");
    let study = "studies/preferred-equilibria.yaml";
    let speeds = ["--speeds", "-150:-300:151"];
    let arguments = ["equilibria", study, speeds[0], speeds[1], "--no-set", "--out", folder];
    let output = stickslip(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(printed, block_after("<!-- tested: equilibria -->"));
}

/// The annotated study of the README is a study.
#[test]
fn study_of_the_readme() {
    let start = README.find("```yaml\n").expect("a YAML block") + "```yaml\n".len();
    let text = &README[start..];
    let text = &text[..text.find("```").expect("its end")];
    let study = stickslip::study::Study::parse(Path::new("README.md"), text.to_owned())
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(study.point_count(), 6);
    // At most, as it asks for a precision.
    assert_eq!(study.run_count(), 6 * 1024);
}

/// Every command has help with examples, and the README names every command.
#[test]
fn commands_have_help_and_are_in_the_readme() {
    let definition = stickslip::cli::definition();
    for command in definition.get_subcommands().map(clap::Command::get_name) {
        let help = stickslip(&[command, "--help"]);
        assert_eq!(help.status.code(), Some(0));
        let help = String::from_utf8_lossy(&help.stdout).into_owned();
        assert!(help.contains("Examples:"), "{command}: {help}");
        assert!(README.contains(&format!("| `stickslip {command}")), "{command} in the README");
    }
}

/// Every script in bash says what it does with `--help`, and does nothing else then.
#[cfg(unix)]
#[test]
fn scripts_have_help() {
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts");
    let (mut folders, mut asked) = (vec![scripts], 0);
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.unwrap().path())
        {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            // That one needs its Python packages to say which peers it knows.
            let needs_packages = path.ends_with("compare/run");
            if needs_packages || !text.starts_with("#!/usr/bin/env bash") {
                continue;
            }
            let elsewhere = tempfile::tempdir().expect("a folder");
            let output = Command::new(&path)
                .arg("--help")
                .current_dir(elsewhere.path())
                .output()
                .expect("the script starts");
            let help = String::from_utf8_lossy(&output.stdout);
            let told = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success() && told.is_empty(), "{}: {told}", path.display());
            let is_comment = help.lines().any(|line| line.starts_with('#'));
            assert!(help.len() > 60 && !is_comment, "{}: {help}", path.display());
            assert_eq!(std::fs::read_dir(elsewhere.path()).unwrap().count(), 0);
            asked += 1;
        }
    }
    assert!(asked > 10, "{asked} scripts");
}

/// Files that the README links to are there.
#[test]
fn links_lead_somewhere() {
    for link in README.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        if !link.starts_with("https://") {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(link);
            assert!(path.exists(), "{link}");
        }
    }
}
