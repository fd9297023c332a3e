//! Figures for papers: from a directory that this program has written to files beside it.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde_json::Value;

use super::exit::CliError;
use super::replaceable::{beside, outside, replace, replaceable, sealed};
use super::results_study::results_study;
use super::summary::no_tables;
use crate::model::Machine;
use crate::report::chart::Figure;
use crate::report::paper::{Format, is_ours, sheets};
use crate::report::{Budget, Gathered, ResultTables, figures, of_results};
use crate::study::Study;
use crate::table::{ResultsError, Table, manifest_of};

/// What figures are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FigureFormat {
    /// Lines and words, for LaTeX and for drawing programs
    Svg,
    /// Pixels, 300 per inch
    Png,
}

/// Writes the figures of a directory and returns their paths.
///
/// # Errors
/// Where the directory is none that this program has written, a table cannot be read, or a file that is
/// not a figure of this program is in the way.
pub fn write(
    directory: &Path,
    format: FigureFormat,
    out: Option<&Path>,
) -> Result<Vec<PathBuf>, CliError> {
    let figures = figures_of(directory)?;
    let out = match out {
        Some(out) => out.to_owned(),
        None => beside(directory, "-figures")?,
    };
    let format = match format {
        FigureFormat::Svg => Format::Svg,
        FigureFormat::Png => Format::Png,
    };
    let sheets: Vec<_> = figures.iter().flat_map(sheets).collect();
    let file = |name: &str| out.join(format!("{name}.{}", format.extension()));
    outside(directory, &out)?;
    // Nothing is written where one of them cannot be.
    for (name, _) in &sheets {
        replaceable(&file(name), is_ours)?;
    }
    let mut written = Vec::new();
    for (name, sheet) in &sheets {
        let path = file(name);
        let content = sheet.file(format).map_err(io::Error::other)?;
        let content = match String::from_utf8(content) {
            Ok(text) => sealed(&text).into_bytes(),
            Err(pixels) => pixels.into_bytes(),
        };
        replace(&path, &content)?;
        written.push(path);
    }
    Ok(written)
}

/// The figures of a directory, by what it holds.
fn figures_of(directory: &Path) -> Result<Vec<Figure>, CliError> {
    let refused = |reason: &str, found: String, allowed: &str| -> CliError {
        let (path, reason) = (directory.to_owned(), reason.to_owned());
        ResultsError::Occupied { path, reason, found, allowed: allowed.to_owned() }.into()
    };
    let has = |name: &str| directory.join(name).exists();
    let figures = if manifest_of(directory)?.is_some() {
        let (study, manifest) = results_study(directory)?;
        if manifest.files.is_empty() {
            return Err(no_tables(directory, &study, &manifest)?);
        }
        let tables = ResultTables::open(directory, &manifest)?;
        of_results(&Gathered::read(&tables, &study, &manifest, Budget::SCREEN)?)
    } else if has("frictionless.parquet") {
        let (table, about) = Table::of_itself(directory, "frictionless")?;
        let study = study_of(directory, &about)?;
        equilibria(&table, &study)?
    } else if has("trajectory.parquet") {
        let (table, about) = Table::of_itself(directory, "trajectory")?;
        let study = study_of(directory, &about)?;
        let run = about["options"]["run_id"].as_u64().unwrap_or(0);
        let title = format!("Run {run} of {}", study.name());
        // Of a part of the motion nobody knows what comes after it.
        let whole = about["options"]["times"].is_null() && run < study.run_count();
        let case = whole.then(|| study.planned_run(run).case.ok()).flatten();
        let balls = study.model().balls();
        figures::motion(&table, balls, &title, case.as_ref())?.into_iter().collect()
    } else {
        let found = match fs::read_dir(directory) {
            Err(error) => error.to_string(),
            Ok(mut entries) => match entries.next() {
                None => "an empty directory".to_owned(),
                Some(_) => {
                    "no manifest.json, frictionless.parquet or trajectory.parquet".to_owned()
                }
            },
        };
        let allowed = "a directory that `stickslip run`, `equilibria` or `replay` has written";
        return Err(refused("there is nothing to draw here", found, allowed));
    };
    if figures.is_empty() {
        let found = "tables without anything that figures show".to_owned();
        let allowed = "results of runs; equilibrium sets of two balls, or --speeds; a motion";
        return Err(refused("there is nothing to draw here", found, allowed));
    }
    Ok(figures)
}

/// What `stickslip equilibria` has computed.
fn equilibria(table: &Table, study: &Study) -> Result<Vec<Figure>, CliError> {
    let own_speeds = table.columns().iter().all(|(name, _)| name != "point_id");
    let only_speed = matches!(study.swept(), [only] if only.name == "speed_rad_s");
    let machine: Option<&Machine> = study.model().ball_balancer();
    let mut found = figures::sets(study);
    if let Some(machine) = machine.filter(|_| own_speeds || only_speed) {
        found.extend(figures::branches(table, machine)?);
    }
    Ok(found)
}

/// The study that a table says it is of.
fn study_of(directory: &Path, about: &Value) -> Result<Study, CliError> {
    let text = about["study_yaml"].as_str().unwrap_or_default().to_owned();
    Ok(Study::parse(&directory.join("study_yaml"), text)?)
}
