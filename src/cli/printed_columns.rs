//! The columns of the printed table of points: residual vibration first, then rests and the other
//! endings. A column that says nothing about the printed points is left out.

use super::point_words::{micrometres, percent, three_digits};
use crate::analysis::AuditCounts;
use crate::classification::Label;
use crate::report::{Fraction, PointFacts};

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

/// Returns the columns of points, with the swept parameters of these names and their values as `shown` for each point.
pub fn printed_columns(
    rows: &[PointFacts],
    names: &[String],
    shown: &[Vec<String>],
    balls: bool,
    audit: bool,
) -> Vec<PrintedColumn> {
    let mut columns = Columns { rows, list: Vec::new() };
    columns.add(["", "point"], "point", |row| row.point_id.to_string());
    for (index, name) in names.iter().enumerate() {
        let [top, bottom] = in_two_lines(name);
        columns.list.push(PrintedColumn {
            header: [top, bottom].map(str::to_owned),
            name: name.clone(),
            cells: shown.iter().map(|row| row.get(index).cloned().unwrap_or_default()).collect(),
        });
    }
    if balls {
        add_vibration(&mut columns);
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

/// A list of columns that is being made.
struct Columns<'a> {
    rows: &'a [PointFacts],
    list: Vec<PrintedColumn>,
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

fn add_vibration(columns: &mut Columns<'_>) {
    columns.add_known(["vibration", "[µm]"], "median vibration [µm]", |row| {
        row.amplitude_m[1].map(micrometres)
    });
    columns.add_known(["95 %", "[µm]"], "95 % of the runs [µm]", |row| {
        row.amplitude_m[2].map(micrometres)
    });
    columns.add_known(["no balls", "[µm]"], "without balls [µm]", |row| {
        row.residual.amplitude_without_balls_m.map(micrometres)
    });
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
