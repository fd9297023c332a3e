//! The columns of the tables of points and responses, on the terminal, in Markdown and on the page: residual vibration first,
//! then rests and the other endings. A column that says nothing about the points is left out.

use super::data::{Fraction, PointFacts};
use super::words::{percent, three_digits};
use crate::analysis::{AuditCounts, Estimate};
use crate::classification::Label;
use crate::study::{Response, Unit, Units, VariedParameter};

/// The cell of a value that a point does not have.
const MISSING: &str = "-";

/// Names of parameters above this length have two lines in the header.
const LONG_NAME: usize = 14;

/// A column of the printed table.
#[derive(Clone, Debug)]
pub struct PrintedColumn {
    /// The header in two lines.
    pub header: [String; 2],
    /// The header in one line.
    pub name: String,
    /// One cell per point.
    pub cells: Vec<String>,
}

/// Points, the swept parameters, and their values as text at each point.
type Points<'a> = (&'a [PointFacts], &'a [VariedParameter], &'a [Vec<String>]);

/// Returns the number of the point and the swept parameters.
fn key_columns<'a>((rows, swept, shown): Points<'a>) -> Columns<'a> {
    let mut columns = Columns { rows, list: Vec::new() };
    columns.add(["", "point"], "point", |row| row.point_id.to_string());
    for (index, parameter) in swept.iter().enumerate() {
        let name = parameter.shown_name();
        let [top, bottom] = in_two_lines(&name);
        columns.list.push(PrintedColumn {
            header: [top, bottom].map(str::to_owned),
            name: name.clone(),
            cells: shown.iter().map(|row| row.get(index).cloned().unwrap_or_default()).collect(),
        });
    }
    columns
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
        columns.add(["", "flips"], "flips", |row| {
            let AuditCounts { runs, flips, .. } = row.audit;
            format!("{flips} of {runs}")
        });
    }
    columns.list
}

/// Returns the columns of the responses of points, each response with its 95 % interval.
pub fn response_columns(
    points: Points<'_>,
    responses: &[Response],
    units: &Units,
) -> Vec<PrintedColumn> {
    let mut columns = key_columns(points).list;
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
    units: &Units,
) -> Vec<PrintedColumn> {
    let mut columns = Vec::new();
    for (index, response) in responses.iter().enumerate() {
        let shown = response.shown_unit(units);
        let unit = &shown.symbol;
        let text = |value: f64| match unit.as_str() {
            "%" => percent(value),
            _ => three_digits(shown.of(value)),
        };
        let interval = |estimate: &Estimate| match (estimate.low, estimate.high) {
            (Some(low), Some(high)) => Some(format!("{}-{}", text(low), text(high))),
            (Some(low), None) => Some(format!("≥ {}", text(low))),
            (None, Some(high)) => Some(format!("≤ {}", text(high))),
            (None, None) => None,
        };
        let cells = |cell: &dyn Fn(&Estimate) -> Option<String>| {
            let cell = |(row, _): &Estimates<'_>| row.get(index).and_then(cell);
            rows.iter().map(|row| cell(row).unwrap_or_else(|| MISSING.to_owned())).collect()
        };
        let Response { name, .. } = response;
        columns.push(PrintedColumn {
            header: match in_two_lines(name) {
                ["", name] => [name.to_owned(), format!("[{unit}]")],
                [top, bottom] => [top.to_owned(), format!("{bottom} [{unit}]")],
            },
            name: format!("{name} [{unit}]"),
            cells: cells(&|estimate| estimate.value.map(text)),
        });
        columns.push(PrintedColumn {
            header: ["95 %", "interval"].map(str::to_owned),
            name: format!("{name}, 95 % interval"),
            cells: cells(&interval),
        });
        let without = |(_, without): &Estimates<'_>| without.get(index).copied().flatten();
        if rows.iter().any(|row| without(row).is_some()) {
            let cell = |row| without(row).map_or_else(|| MISSING.to_owned(), text);
            columns.push(PrintedColumn {
                header: ["no balls".to_owned(), format!("[{unit}]")],
                name: format!("{name} without balls [{unit}]"),
                cells: rows.iter().map(cell).collect(),
            });
        }
    }
    columns
}

/// A list of columns that is being made.
struct Columns<'a> {
    rows: &'a [PointFacts],
    list: Vec<PrintedColumn>,
}

impl PrintedColumn {
    /// Returns a column with the header in one line only.
    pub fn new(name: &str, cells: Vec<String>) -> Self {
        PrintedColumn { header: Default::default(), name: name.to_owned(), cells }
    }
}

impl Columns<'_> {
    fn add(&mut self, header: [&str; 2], name: &str, cell: impl Fn(&PointFacts) -> String) {
        self.list.push(PrintedColumn {
            header: header.map(str::to_owned),
            name: name.to_owned(),
            cells: self.rows.iter().map(cell).collect(),
        });
    }

    /// Adds a column whose values may be missing.
    fn add_known(
        &mut self,
        header: [&str; 2],
        name: &str,
        cell: impl Fn(&PointFacts) -> Option<String>,
    ) {
        self.add(header, name, |row| cell(row).unwrap_or_else(|| MISSING.to_owned()));
    }

    fn any(&self, holds: impl Fn(&PointFacts) -> bool) -> bool {
        self.rows.iter().any(holds)
    }
}

fn add_vibration(columns: &mut Columns<'_>, unit: &Unit) {
    let symbol = format!("[{}]", unit.symbol);
    let mut add = |top: &str, name: &str, metres: fn(&PointFacts) -> Option<f64>| {
        columns.add_known([top, &symbol], &format!("{name} {symbol}"), |row| {
            metres(row).map(|metres| three_digits(unit.of(metres)))
        });
    };
    add("vibration", "median vibration", |row| row.amplitude_m[1]);
    add("95 %", "95 % of the runs", |row| row.amplitude_m[2]);
    add("no balls", "without balls", |row| row.residual.amplitude_without_balls_m);
    columns.add_known(["worse", "[%]"], "worse than without balls [%]", |row| {
        row.residual.worse_than_without_balls.map(|[worse, ..]| percent(worse))
    });
    let grade = |row: &PointFacts| row.residual.balance_quality_grade_mm_s[0];
    if columns.any(|row| grade(row).is_some()) {
        columns.add_known(["G", "[mm/s]"], "median G of rests [mm/s]", |row| {
            grade(row).map(three_digits)
        });
    }
}

fn add_rests(columns: &mut Columns<'_>) {
    columns.add(["at", "rest"], "at rest", |row| format!("{}/{}", row.equilibrium.runs, row.runs));
    columns.add(["", "[%]"], "at rest [%]", |row| percent(row.equilibrium.fraction));
    columns.add(["95 %", "interval"], "95 % interval", |row| {
        let Fraction { low, high, .. } = row.equilibrium;
        format!("{}-{}", percent(low), percent(high))
    });
    if columns.any(|row| row.overlapping_rests() > 0) {
        columns
            .add(["", "overlap"], "rests that overlap", |row| row.overlapping_rests().to_string());
    }
    columns.add_known(["median", "rest [s]"], "median rest [s]", |row| {
        row.time_to_rest_s[1].map(|median| format!("{median:.2}"))
    });
}

fn add_other_endings(columns: &mut Columns<'_>) {
    for label in Label::ALL {
        let header = match label {
            Label::Equilibrium => continue,
            Label::LimitCycle => ["limit", "cycle"],
            Label::Irregular => ["irreg-", "ular"],
            Label::Undecided => ["unde-", "cided"],
            Label::Failed => ["", "failed"],
        };
        if columns.any(|row| row.label(label).runs > 0) {
            columns.add(header, label.name(), |row| row.label(label).runs.to_string());
        }
    }
}

/// Divides a long name after the underscore that is nearest to its middle.
fn in_two_lines(name: &str) -> [&str; 2] {
    let places = name.match_indices('_').map(|(place, _)| place + 1);
    let middle = name.len() / 2;
    match places.min_by_key(|place| place.abs_diff(middle)) {
        Some(place) if name.len() > LONG_NAME => {
            let (top, bottom) = name.split_at(place);
            [top, bottom]
        }
        _ => ["", name],
    }
}

#[cfg(test)]
mod tests {
    use super::in_two_lines;

    #[test]
    fn long_names_have_two_lines() {
        assert_eq!(in_two_lines("speed_rad_s"), ["", "speed_rad_s"]);
        assert_eq!(in_two_lines("friction_coefficient"), ["friction_", "coefficient"]);
        assert_eq!(in_two_lines("friction_coefficient_2"), ["friction_", "coefficient_2"]);
        assert_eq!(in_two_lines("withoutunderscore"), ["", "withoutunderscore"]);
    }
}
