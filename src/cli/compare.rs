//! `stickslip compare`: how the answers of two studies differ.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::output::{CliError, End, print_result};
use super::points_table::MOST_LINES;
use crate::analysis::Estimate;
use crate::engine::{ReadableResults, readable_results};
use crate::numbers::counted;
use crate::printed_table::{PrintedColumn, PrintedTable, as_text};
use crate::report::{
    ComparedPoint, ComparedQuantity, ComparedResults, Comparison, NamedPoints,
    compare as compare_results, percent, three_digits,
};
use crate::responses::merged;
use crate::sanitize::shown_path;
use crate::table::Table;

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
pub struct Arguments {
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
pub fn compare(arguments: &Arguments) -> Result<End, CliError> {
    let directories = [&arguments.first, &arguments.second];
    let [first, second] = directories.map(|directory| readable_results(directory));
    let (first, second) = (first?, second?);
    let tables = |results: &ReadableResults| -> Result<[Table; 2], CliError> {
        let ReadableResults { manifest, tables, .. } = results;
        Ok([Table::open(tables, manifest, "points")?, Table::open(tables, manifest, "runs")?])
    };
    let ([points_1, runs_1], [points_2, runs_2]) = (tables(&first)?, tables(&second)?);
    let results_1 = ComparedResults { study: &first.study, points: &points_1, runs: &runs_1 };
    let results_2 = ComparedResults { study: &second.study, points: &points_2, runs: &runs_2 };
    let comparison = compare_results([&results_1, &results_2])?;
    let json = || {
        let directories = directories.map(|directory| directory.display().to_string());
        merged(json!({"directories": directories}), &comparison)
    };
    let title = |name: &str, directory: &PathBuf, results: &ReadableResults| {
        let runs = counted(results.manifest.runs_finished, "run");
        format!("{name}  {} ({}, {runs})\n", shown_path(directory), results.study.name())
    };
    let text = || {
        title("first ", directories[0], &first)
            + &title("second", directories[1], &second)
            + &in_words(&comparison)
    };
    print_result(arguments.json, json, text)?;
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
    let printed = points.iter().take(MOST_LINES);
    let rows: Vec<(Option<&ComparedPoint>, &ComparedQuantity)> = printed
        .flat_map(|point| {
            let of_first = [Some(point)].into_iter().chain(std::iter::repeat(None));
            of_first.zip(&point.quantities)
        })
        .collect();
    if !rows.is_empty() {
        text += &format!("\n{}", as_text(&columns(&rows)));
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

/// Returns the columns of quantities, the first one of each point with the point.
fn columns(rows: &[(Option<&ComparedPoint>, &ComparedQuantity)]) -> Vec<PrintedColumn> {
    let value = |quantity: &ComparedQuantity, value: f64| match quantity.unit.symbol.as_str() {
        "%" => percent(value),
        _ => three_digits(quantity.unit.of(value)),
    };
    let signed = |quantity: &ComparedQuantity, value: f64| {
        let sign = if value < 0.0 { "-" } else { "+" };
        format!("{sign}{}", three_digits(quantity.unit.of(value.abs())))
    };
    let mut table = PrintedTable::new(rows, "-");
    let number = |(point, _): &(Option<&ComparedPoint>, _)| match point.map(|row| row.point_ids) {
        None => String::new(),
        Some([first, second]) if first == second => first.to_string(),
        Some([first, second]) => format!("{first}, {second}"),
    };
    table.add("point", number).left();
    if rows.iter().any(|(point, _)| point.is_some_and(|point| !point.title.is_empty())) {
        table.add("", |(point, _)| point.map_or_else(String::new, |row| row.title.clone())).left();
    }
    table.add("quantity", |(_, row)| format!("{} [{}]", row.name, row.unit.symbol)).left();
    table.add_known("first", |(_, row)| Some(value(row, row.first.value?)));
    table.add_known("second", |(_, row)| Some(value(row, row.second.value?)));
    table.add_known("difference", |(_, row)| Some(signed(row, row.difference.value?)));
    table.add_known("95 % interval", |(_, row)| {
        let ends = [row.difference.low, row.difference.high];
        let text = |end: Option<f64>| end.map_or_else(|| "-".to_owned(), |end| signed(row, end));
        ends.iter().any(Option::is_some).then(|| ends.map(text).join(" to "))
    });
    table.columns
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
                point.quantities.get(place).map(|compared| &compared.difference)
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
