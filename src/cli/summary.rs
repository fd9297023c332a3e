//! `stickslip summary`: prints the points of a directory of results.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::{Map, Value, json};

use super::arguments::parsed;
use super::output::{CliError, End, OutputReader, csv_line, print, print_json};
use super::points_table::{MOST_LINES, PointsTable};
use super::result_lines::{failed_runs, kinds_of_failure};
use crate::engine::{ReadableResults, how_to_continue, readable_results, say};
use crate::numbers::counted;
use crate::report::IncompletePoints;
use crate::responses::{add_known, merged};
use crate::study::{ParameterValue, Study};
use crate::table::{Manifest, Row, Table};

const EXAMPLES: &str = "\
Examples:
  stickslip summary results/night
  stickslip summary results/night --points all
  stickslip summary results/night --format markdown     (for an issue)
  stickslip summary results/night --format csv > points.csv

The first line states what was run: study, version, seed, number of runs, failed runs by kind, audit flips, and what \
is missing from interrupted results; with csv it goes to standard error. table and markdown have the columns \
that `run` prints; csv and json have all columns of points.parquet in full precision. While a study is running, and \
after it was killed, the finished runs are summarised. The command computes nothing and changes nothing in the \
directory. `stickslip report` draws the same results.";

/// Print the results of a directory, one line per point
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Directory with results
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    /// Output format
    #[arg(long, value_name = "FORMAT", value_enum, default_value = "table")]
    format: Format,

    /// Number of points, from the first [default: 40 in table and markdown, all in csv and json]
    #[arg(long, value_name = "all|N", value_parser = points, allow_negative_numbers = true)]
    points: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Aligned columns, as `run` prints them
    Table,
    /// Comma-separated, all columns of points.parquet
    Csv,
    /// One JSON document, all columns of points.parquet
    Json,
    /// Markdown table, to paste into an issue
    Markdown,
}

fn points(text: &str) -> Result<usize, String> {
    match text {
        "all" => Ok(usize::MAX),
        _ => parsed(text, "all, or a whole number from 1", |number| *number > 0),
    }
}

/// Prints the summary of a directory of results.
pub fn summary(arguments: &Arguments) -> Result<End, CliError> {
    let directory = &arguments.directory;
    let results = readable_results(directory)?;
    let ReadableResults { study, manifest, tables, .. } = &results;
    let table = Table::open(tables, manifest, "points")?;
    let printed = match arguments.format {
        Format::Table | Format::Markdown => arguments.points.unwrap_or(MOST_LINES),
        Format::Csv | Format::Json => 0,
    };
    let mut points = PointsTable::read(study, &table, printed)?;
    points.is_saved = !results.is_from_chunks();
    let incomplete = IncompletePoints::read(study, manifest, &table)?;
    let title = title(&results, &points, &incomplete, directory);
    let most = arguments.points.unwrap_or(usize::MAX);
    match arguments.format {
        Format::Table => {
            print(&format!("{title}\n\n{}", points.text()))?;
        }
        Format::Markdown => {
            print(&format!("{title}\n\n{}", points.markdown()))?;
        }
        Format::Csv => {
            say(&title);
            print_csv(&table, most)?;
        }
        Format::Json => {
            print_document(&facts(study, manifest, &points, &incomplete), &table, most)?;
        }
    }
    Ok(End::Well)
}

/// Returns the first line of the summary.
fn title(
    results: &ReadableResults,
    points: &PointsTable,
    incomplete: &IncompletePoints,
    directory: &Path,
) -> String {
    let ReadableResults { study, manifest, .. } = results;
    let Manifest { version, runs_planned, runs_finished, .. } = manifest;
    let mut parts = vec![format!("{}: stickslip {version}, seed {}", study.name(), study.seed())];
    if manifest.shard != "1/1" {
        parts.push(format!("shard {}", manifest.shard));
    }
    parts.push(match manifest.complete {
        true => format!("all {} finished", counted(*runs_finished, "run")),
        false => {
            let missing = runs_planned.saturating_sub(*runs_finished);
            let bound = if study.precision().is_some() { "at most " } else { "" };
            format!(
                "{runs_finished} of {bound}{runs_planned} runs finished, {bound}{missing} are missing ({})",
                how_to_continue(results, directory)
            )
        }
    });
    parts.push(match kinds_of_failure(&manifest.failures) {
        kinds if kinds.is_empty() => format!("{} failed", failed_runs(manifest)),
        kinds => format!("{} failed ({kinds})", failed_runs(manifest)),
    });
    parts.extend(incomplete.words());
    if let Some(audit) = points.flips() {
        parts.push(format!("{} of {} audited runs flipped", audit.flips, audit.runs));
    }
    parts.join(", ")
}

/// Returns the facts of the first line as JSON.
fn facts(
    study: &Study,
    manifest: &Manifest,
    points: &PointsTable,
    incomplete: &IncompletePoints,
) -> Value {
    let facts = json!({
        "study": study.name(),
        "study_hash": manifest.study_hash,
        "version": manifest.version,
        "model_version": manifest.model_version,
        "seed": study.seed(),
        "shard": manifest.shard,
        "runs_planned": manifest.runs_planned,
        "runs_finished": manifest.runs_finished,
        "complete": manifest.complete,
        "points_incomplete": incomplete.count(),
        "failed_runs": failed_runs(manifest),
        "failures": manifest.failures,
    });
    let audit = points.flips().map(|audit| {
        json!({"audited_runs": audit.runs, "audit_flips": audit.flips, "audit_rest_flips": audit.rest_flips})
    });
    let mut facts = merged(facts, audit);
    add_known(&mut facts, "points_not_precise", points.not_precise());
    facts
}

/// Returns the names of the columns of a table.
fn names(table: &Table) -> Vec<&str> {
    table.columns.iter().map(|(name, _)| name.as_str()).collect()
}

/// Prints the first `most` rows of a table as CSV.
fn print_csv(table: &Table, most: usize) -> Result<(), CliError> {
    let names = names(table);
    let cell = |value: Value| match value {
        Value::Null => String::new(),
        Value::String(text) => text,
        Value::Number(number) => match number.as_f64().filter(|_| number.is_f64()) {
            Some(number) => ParameterValue::Number(number).to_string(),
            None => number.to_string(),
        },
        other => other.to_string(),
    };
    print(&csv_line(names.iter().map(ToString::to_string))?)?;
    let cells = |row: &Row<'_>| names.iter().map(|name| cell(row.json(name))).collect::<Vec<_>>();
    for cells in table.read_rows(cells)?.take(most) {
        if print(&csv_line(cells?)?)? == OutputReader::Gone {
            break;
        }
    }
    Ok(())
}

/// Prints one JSON document, point by point.
fn print_document(facts: &Value, table: &Table, most: usize) -> Result<(), CliError> {
    let head = format!("{facts:#}");
    // Pretty-printed non-empty objects end in a line break and a brace.
    let head = head.strip_suffix("\n}").unwrap_or(&head);
    print_json(&format!("{head},\n  \"points\": ["))?;
    let names = names(table);
    let object = |row: &Row<'_>| -> Map<String, Value> {
        names.iter().map(|name| ((*name).to_owned(), row.json(name))).collect()
    };
    let mut separator = "\n    ";
    for object in table.read_rows(object)?.take(most) {
        let before = std::mem::replace(&mut separator, ",\n    ");
        if print_json(&format!("{before}{}", Value::Object(object?)))? == OutputReader::Gone {
            return Ok(());
        }
    }
    print("\n  ]\n}\n")?;
    Ok(())
}
