//! The README and the pages in `docs` are correct: their outputs, studies and commands are run.

mod convergence;
pub mod generated;
mod identify;
mod keys;
pub mod named;
mod own_system;
mod records;
mod system_files;
mod tutorial;

use std::path::{Path, PathBuf};
use std::process::Command;

use arrow::array::RecordBatch;
use stickslip::analysis::{Z_95, wilson};

use crate::cli::support::{Scratch, counts, numbers, words};
use crate::support::shipped;

const README: &str = include_str!("../../README.md");
const EQUILIBRIA: &str = include_str!("../../docs/equilibria.md");
const STUDY_FILE: &str = include_str!("../../docs/study-file.md");
const ROTOR: &str = include_str!("../../docs/rotor.md");
const SYSTEM_FILES: &str = include_str!("../../docs/system-files.md");

fn thesis() -> String {
    shipped("preferred-equilibria.yaml").display().to_string()
}

/// Returns the code block that follows a line of a page.
fn block_after(page: &str, line: &str) -> String {
    let mut lines = page.lines().skip_while(|text| *text != line).skip(1);
    assert!(lines.next().is_some_and(|fence| fence.starts_with("```")), "a block after {line}");
    lines.take_while(|text| !text.starts_with("```")).map(|text| format!("{text}\n")).collect()
}

/// The closed forms on the page about the rotor are those that `check` prints of its template.
#[test]
fn the_page_about_the_rotor_shows_the_closed_forms() {
    let scratch = Scratch::new();
    scratch.well("new rotor.yaml --template rotor");
    let printed = scratch.well("check rotor.yaml");
    let (_, closed_forms) = printed.split_once("\nwithout ").expect("the closed forms");
    assert_eq!(format!("without {closed_forms}"), block_after(ROTOR, "<!-- tested: rotor -->"));
}

#[test]
fn the_first_command_prints_the_readme_table() {
    let scratch = Scratch::new();
    let printed = scratch.well(&format!("run {} --out results", thesis()));
    assert_eq!(printed, block_after(README, "<!-- tested: preferred-equilibria -->"));
    named::columns_are_on_pages(&scratch.path("results"));
    // Numbers of this study on other pages.
    let points = scratch.table("results", "points");
    let irregular =
        numbers(&points, "speed_rad_s").iter().position(|speed| *speed == Some(-191.6372));
    let rate = records::escape_rate(&points, irregular.expect("the irregular speed"));
    let rate_in_words = records::rate_in_words(&rate);
    generated::compare_or_write_part("docs/methods.md", "escape-rate-thesis", &rate_in_words);
    let from = format!("{:.1} s", rate["from_s"].as_f64().expect("a time"));
    generated::compare_or_write_part("docs/methods.md", "escape-from-thesis", &from);
    generated::compare_or_write_part(
        "docs/methods.md",
        "stratified-narrower",
        &stratified_narrower(&points),
    );
}

/// Returns how much narrower the stratified intervals of the points are than Wilson's.
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

/// The page on equilibrium sets has the output for the thesis's sets.
#[test]
fn output_of_equilibria() {
    let scratch = Scratch::new();
    let options = "--speeds -150:-300:151 --no-set --out sets";
    let printed = scratch.well(&format!("equilibria {} {options}", thesis()));
    assert_eq!(printed, block_after(EQUILIBRIA, "<!-- tested: equilibria -->"));
    named::columns_are_on_pages(&scratch.path("sets"));
    let printed = scratch
        .well(&format!("equilibria {} --out block", shipped("block-on-spring.yaml").display()));
    assert_eq!(printed, block_after(EQUILIBRIA, "<!-- tested: equilibria-of-a-system -->"));
    named::columns_are_on_pages(&scratch.path("block"));
}

/// The page on `check` has its output for the thesis's study, which has no warnings.
#[test]
fn output_of_check() {
    let printed = Scratch::new().well(&format!("check {} --strict", thesis()));
    generated::compare_or_write_part(
        "docs/check.md",
        "check",
        &format!("\n```text\n{printed}```\n"),
    );
}

fn first_study(page: &str) -> (String, stickslip::study::Study) {
    let start = page.find("```yaml\n").expect("a YAML block") + "```yaml\n".len();
    let text = &page[start..];
    let text = text[..text.find("```").expect("its end")].to_owned();
    let study = stickslip::study::Study::parse(Path::new("page.md"), text.clone())
        .unwrap_or_else(|error| panic!("{error}"));
    (text, study)
}

/// The study of the README is valid and has 20 lines.
#[test]
fn study_of_the_readme() {
    let (text, study) = first_study(README);
    assert_eq!(text.lines().count(), 20);
    assert_eq!(study.point_count(), 3);
    // The maximum number of runs, because the study requires a precision.
    assert_eq!(study.run_count(), 3 * 1024);
}

/// The annotated study of the page on study files is valid.
#[test]
fn study_of_the_study_file_page() {
    let (_, study) = first_study(STUDY_FILE);
    assert_eq!(study.point_count(), 6);
    assert_eq!(study.run_count(), 6 * 1024);
}

#[test]
fn every_command_is_in_the_readme() {
    let definition = stickslip::cli::definition();
    for command in definition.get_subcommands().map(clap::Command::get_name) {
        assert!(README.contains(&format!("| `stickslip {command}")), "{command} in the README");
    }
}

/// Every bash script prints its usage for `--help`, and does nothing else.
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
            // This script needs its Python packages to list the supported peers.
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

#[test]
fn readme_is_short() {
    assert!(README.len() <= 8192, "README.md has {} bytes", README.len());
}

#[test]
fn linked_files_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = std::fs::read_dir(root.join("docs")).expect("pages");
    let docs = docs.map(|entry| entry.expect("a page").path());
    let mut pages: Vec<PathBuf> =
        docs.filter(|path| path.extension().is_some_and(|ending| ending == "md")).collect();
    for page in ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md"] {
        pages.push(root.join(page));
    }
    for page in ["benches", "fuzz", "scripts/compare", "scripts/reference"] {
        pages.push(root.join(page).join("README.md"));
    }
    for page in pages {
        let text = std::fs::read_to_string(&page).expect("a page");
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let path = link.split('#').next().unwrap_or_default();
            if !path.is_empty() && !link.starts_with("https://") {
                let folder = page.parent().expect("a folder");
                assert!(folder.join(path).exists(), "{}: {link}", page.display());
            }
        }
    }
}
