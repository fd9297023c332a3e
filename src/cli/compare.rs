//! `stickslip compare`: how the answers of two studies differ.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::exit::{CliError, End};
use super::output::{print, print_json};
use super::points_table::MOST_LINES;
use crate::analysis::Estimate;
use crate::counted::counted;
use crate::engine::{Readable, readable_results};
use crate::report::{
    ComparedQuantity, ComparedResults, Comparison, NamedPoints, compare as compare_results,
    percent, three_digits,
};
use crate::sanitize::shown_path;
use crate::table::Table;
use crate::text_table::text_table;

const EXAMPLES: &str = "\
Examples:
  stickslip compare results/steel results/ceramic
  stickslip compare results/before results/after --json

Prints the keys in which the two studies differ, and for each point that both have (equal values of all parameters \
that one of them sweeps) the fraction of runs at rest, the vibration, and the responses that both studies define \
alike, with the difference second - first and its 95 % confidence interval. If the runs of both studies have the same \
start states (the same seed and sampling), the interval accounts for the correlation of the pairs. The command \
computes no run and changes nothing.";

/// Say how the results of two studies differ, with intervals of the differences
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct CompareArguments {
    /// Directory with the first results
    #[arg(value_name = "DIR1")]
    first: PathBuf,

    /// Directory with the second results
    #[arg(value_name = "DIR2")]
    second: PathBuf,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Compares two directories of results.
///
/// # Errors
/// Returns an error if a directory holds no results, or if a table cannot be read.
pub fn compare(arguments: &CompareArguments) -> Result<End, CliError> {
    let directories = [&arguments.first, &arguments.second];
    let [first, second] = directories.map(|directory| readable_results(directory));
    let (first, second) = (first?, second?);
    let tables = |results: &Readable| -> Result<[Table; 2], CliError> {
        let Readable { manifest, tables, .. } = results;
        Ok([Table::open(tables, manifest, "points")?, Table::open(tables, manifest, "runs")?])
    };
    let ([points_1, runs_1], [points_2, runs_2]) = (tables(&first)?, tables(&second)?);
    let one = ComparedResults { study: &first.study, points: &points_1, runs: &runs_1 };
    let other = ComparedResults { study: &second.study, points: &points_2, runs: &runs_2 };
    let comparison = compare_results([&one, &other])?;
    if arguments.json {
        let directories = directories.map(|directory| directory.display().to_string());
        let mut result = json!({"directories": directories});
        if let (Some(keys), Value::Object(found)) = (result.as_object_mut(), json!(comparison)) {
            keys.extend(found);
        }
        print_json(&format!("{result:#}\n"))?;
        return Ok(End::Well);
    }
    let title = |name: &str, directory: &PathBuf, results: &Readable| {
        let runs = counted(results.manifest.runs_finished, "run");
        format!("{name}  {} ({}, {runs})\n", shown_path(directory), results.study.name())
    };
    let titles =
        title("first ", directories[0], &first) + &title("second", directories[1], &second);
    print(&(titles + &in_words(&comparison)))?;
    Ok(End::Well)
}

fn in_words(comparison: &Comparison) -> String {
    let Comparison { changed_keys, points, points_without_counterpart } = comparison;
    let mut text = match changed_keys.is_empty() {
        true => "both studies have the same keys and values\n".to_owned(),
        false => "keys that differ\n".to_owned(),
    };
    for key in changed_keys {
        text += &format!("  {key}\n");
    }
    let mut lines: Vec<Vec<String>> = Vec::new();
    let titled = points.iter().any(|point| !point.title.is_empty());
    let mut header = vec!["point"];
    header.extend(titled.then_some(""));
    header.extend(["quantity", "first", "second", "difference", "95 % interval"]);
    lines.push(header.into_iter().map(str::to_owned).collect());
    for point in points.iter().take(MOST_LINES) {
        let [one, other] = point.point_ids;
        let mut number = if one == other { one.to_string() } else { format!("{one}, {other}") };
        let mut title = point.title.clone();
        for quantity in &point.quantities {
            let mut line = vec![std::mem::take(&mut number)];
            line.extend(titled.then(|| std::mem::take(&mut title)));
            line.extend(cells(quantity));
            lines.push(line);
        }
    }
    if lines.len() > 1 {
        let left: &[usize] = if titled { &[0, 1, 2] } else { &[0, 1] };
        text += &format!("\n{}", text_table(&lines, left));
    }
    if points.len() > MOST_LINES {
        text += &format!("... and {} more points\n", points.len() - MOST_LINES);
    }
    text += "\n";
    text += &conclusions(comparison);
    for (which, without) in ["first", "second"].iter().zip(points_without_counterpart) {
        if *without > 0 {
            let points = counted(*without, "point");
            text += &format!("{points} of the {which} study: the other study has no such point.\n");
        }
    }
    text
}

/// Returns name, both values, the difference and its interval.
fn cells(quantity: &ComparedQuantity) -> Vec<String> {
    let ComparedQuantity { name, unit, first, second, difference } = quantity;
    let known = |value: Option<f64>, text: &dyn Fn(f64) -> String| {
        value.map_or_else(|| "-".to_owned(), text)
    };
    let value = |value: f64| match unit.symbol.as_str() {
        "%" => percent(value),
        _ => three_digits(unit.of(value)),
    };
    let signed = |value: f64| {
        let sign = if value < 0.0 { "-" } else { "+" };
        format!("{sign}{}", three_digits(unit.of(value.abs())))
    };
    let Estimate { low, high, .. } = difference;
    vec![
        format!("{name} [{}]", unit.symbol),
        known(first.value, &value),
        known(second.value, &value),
        known(difference.value, &signed),
        match (low, high) {
            (None, None) => "-".to_owned(),
            _ => format!("{} to {}", known(*low, &signed), known(*high, &signed)),
        },
    ]
}

/// Says for each quantity at which points the interval of the difference lies above or below 0.
fn conclusions(comparison: &Comparison) -> String {
    let points = &comparison.points;
    let Some(first) = points.first() else {
        return "The studies have no point in common.\n".to_owned();
    };
    let mut text = String::new();
    for (place, quantity) in first.quantities.iter().enumerate() {
        let [mut rises, mut falls, mut unknown] = [(); 3].map(|()| NamedPoints::default());
        for point in points {
            let Some(Estimate { low, high, .. }) =
                point.quantities.get(place).map(|one| &one.difference)
            else {
                continue;
            };
            match (low, high) {
                (Some(low), _) if *low > 0.0 => rises.add(point.point_ids[0]),
                (_, Some(high)) if *high < 0.0 => falls.add(point.point_ids[0]),
                (Some(_), Some(_)) => {}
                _ => unknown.add(point.point_ids[0]),
            }
        }
        let all = points.len();
        let verb = |count: u64, named: &NamedPoints, verb: &str| match (count, all) {
            (0, _) => None,
            (_, 1) => Some(verb.to_owned()),
            (count, _) => Some(format!("{verb} at {count} of {all} points ({})", named.text())),
        };
        let parts = [
            verb(rises.count, &rises, "rises"),
            verb(falls.count, &falls, "falls"),
            verb(unknown.count, &unknown, "has no complete 95 % interval"),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        let what = match parts.is_empty() {
            true if all == 1 => "the 95 % interval of the difference contains 0".to_owned(),
            true => "the 95 % intervals of all differences contain 0".to_owned(),
            false => parts.join(" and "),
        };
        text += &format!("{}: {what}.\n", quantity.name);
    }
    let paired = points.iter().filter(|point| point.same_start_states).count();
    text + match paired {
        0 => {
            "The runs of the studies have different start states: the intervals are those of independent samples.\n"
        }
        _ if paired == points.len() => {
            "The runs of both studies have the same start states; the intervals account for the correlation of the pairs.\n"
        }
        _ => "At some points the runs of both studies have the same start states.\n",
    }
}
