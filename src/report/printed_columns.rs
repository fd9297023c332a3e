//! The columns of the tables of points and responses, on the terminal, in Markdown and on the page: residual vibration first,
//! then rests and the other endings. A column that says nothing about the points is left out.

use super::data::{Fraction, PointFacts};
use crate::analysis::Estimate;
use crate::classification::Label;
use crate::numbers::{percent, three_digits};
use crate::printed_table::{PrintedColumn, PrintedTable, in_two_lines};
use crate::study::{Response, ShownUnits, Unit, VariedParameter};

/// The cell of a value that a point does not have.
const MISSING: &str = "-";

/// Points, the swept parameters, and their values as text at each point.
type Points<'a> = (&'a [PointFacts], &'a [VariedParameter], &'a [Vec<String>]);

/// Returns the number of the point and the swept parameters.
fn key_columns<'a>((rows, swept, shown): Points<'a>) -> PrintedTable<'a, PointFacts> {
    let mut table = PrintedTable::new(rows, MISSING);
    table.add_point(|row| row.point_id, swept, shown);
    for column in &mut table.columns {
        let name = column.name.clone();
        column.header(in_two_lines(&name));
    }
    table
}

/// Returns the columns of points; those of vibration in this unit, if the model has them.
pub fn printed_columns(
    points: Points<'_>,
    vibration: Option<&Unit>,
    audit: bool,
) -> Vec<PrintedColumn> {
    let mut columns = key_columns(points);
    if let Some(unit) = vibration {
        add_vibration(&mut columns, unit);
    }
    add_rests(&mut columns);
    add_other_endings(&mut columns);
    if audit {
        columns.add("flips", |row| format!("{} of {}", row.audit.flips, row.audit.runs));
    }
    columns.columns
}

/// Returns the columns of the responses of points, each response with its 95 % interval.
pub fn response_columns(
    points: Points<'_>,
    responses: &[Response],
    units: &ShownUnits,
) -> Vec<PrintedColumn> {
    let mut columns = key_columns(points).columns;
    let rows: Vec<Estimates<'_>> =
        points.0.iter().map(|row| (&row.responses[..], &row.responses_without_balls[..])).collect();
    columns.extend(estimate_columns(responses, &rows, units));
    columns
}

/// One estimate per response, and the values for machines without balls, if they are known.
pub type Estimates<'a> = (&'a [Estimate], &'a [Option<f64>]);

/// Returns the columns of responses in rows, with their 95 % intervals and the values without balls.
pub fn estimate_columns(
    responses: &[Response],
    rows: &[Estimates<'_>],
    units: &ShownUnits,
) -> Vec<PrintedColumn> {
    let mut table = PrintedTable::new(rows, MISSING);
    for (index, response) in responses.iter().enumerate() {
        let shown = response.shown_unit(units);
        let unit = &shown.symbol;
        let text = |value: f64| match unit.as_str() {
            "%" => percent(value),
            _ => three_digits(shown.of(value)),
        };
        let estimate = |(row, _): &Estimates<'_>| row.get(index).cloned().unwrap_or_default();
        let Response { name, .. } = response;
        let value = |row: &Estimates<'_>| estimate(row).value.map(text);
        table.add_known(format!("{name} [{unit}]"), value).header(match in_two_lines(name) {
            ["", name] => [name.to_owned(), format!("[{unit}]")],
            [top, bottom] => [top.to_owned(), format!("{bottom} [{unit}]")],
        });
        let interval = |row: &Estimates<'_>| {
            let Estimate { low, high, .. } = estimate(row);
            match (low.map(text), high.map(text)) {
                // A hyphen before a negative number would be read as its sign.
                (Some(low), Some(high)) if low.starts_with('-') => Some(format!("{low} to {high}")),
                (Some(low), Some(high)) => Some(format!("{low}-{high}")),
                (Some(low), None) => Some(format!("≥ {low}")),
                (None, Some(high)) => Some(format!("≤ {high}")),
                (None, None) => None,
            }
        };
        let column = table.add_known(format!("{name}, 95 % interval"), interval);
        column.header(["95 %", "interval"]);
        let without =
            |(_, without): &Estimates<'_>| without.get(index).copied().flatten().map(text);
        if let Some(column) = table.add_if_any(format!("{name} without balls [{unit}]"), without) {
            column.header(["no balls".to_owned(), format!("[{unit}]")]);
        }
    }
    table.columns
}

fn add_vibration(table: &mut PrintedTable<'_, PointFacts>, unit: &Unit) {
    let symbol = format!("[{}]", unit.symbol);
    let mut add = |top: &str, name: &str, metres: fn(&PointFacts) -> Option<f64>| {
        let cell = |row: &PointFacts| metres(row).map(|metres| three_digits(unit.of(metres)));
        table.add_known(format!("{name} {symbol}"), cell).header([top, &symbol]);
    };
    add("vibration", "median vibration", |row| row.amplitude_m[1]);
    add("95 %", "95 % of the runs", |row| row.amplitude_m[2]);
    add("no balls", "without balls", |row| row.residual.amplitude_without_balls_m);
    let worse =
        |row: &PointFacts| row.residual.worse_than_without_balls.map(|[worse, ..]| percent(worse));
    table.add_known("worse than without balls [%]", worse).header(["worse", "[%]"]);
    let grade = |row: &PointFacts| row.residual.balance_quality_grade_mm_s[0].map(three_digits);
    if let Some(column) = table.add_if_any("median G of rests [mm/s]", grade) {
        column.header(["G", "[mm/s]"]);
    }
}

fn add_rests(table: &mut PrintedTable<'_, PointFacts>) {
    let rests = |row: &PointFacts| format!("{}/{}", row.equilibrium.runs, row.runs);
    table.add("at rest", rests).header(["at", "rest"]);
    let fraction = |row: &PointFacts| percent(row.equilibrium.fraction);
    table.add("at rest [%]", fraction).header(["", "[%]"]);
    let interval = |row: &PointFacts| {
        let Fraction { low, high, .. } = row.equilibrium;
        format!("{}-{}", percent(low), percent(high))
    };
    table.add("95 % interval", interval).header(["95 %", "interval"]);
    if table.rows().iter().any(|row| row.overlapping_rests() > 0) {
        let overlapping = |row: &PointFacts| row.overlapping_rests().to_string();
        table.add("rests that overlap", overlapping).header(["", "overlap"]);
    }
    let median = |row: &PointFacts| row.time_to_rest_s[1].map(|median| format!("{median:.2}"));
    table.add_known("median rest [s]", median).header(["median", "rest [s]"]);
}

fn add_other_endings(table: &mut PrintedTable<'_, PointFacts>) {
    for label in Label::ALL {
        let header = match label {
            Label::Equilibrium => continue,
            Label::LimitCycle => ["limit", "cycle"],
            Label::Periodic => ["peri-", "odic"],
            Label::Creep => ["", "creep"],
            Label::QuasiPeriodic => ["quasi-", "periodic"],
            Label::Irregular => ["irreg-", "ular"],
            Label::Undecided => ["unde-", "cided"],
            Label::Failed => ["", "failed"],
        };
        if table.rows().iter().any(|row| row.label(label).runs > 0) {
            table.add(label.name(), |row| row.label(label).runs.to_string()).header(header);
        }
    }
}
