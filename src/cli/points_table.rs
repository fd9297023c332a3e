//! The table of points on the terminal, in Markdown and as JSON.

use serde_json::{Value, json};

use super::point_line::PointLine;
use crate::analysis::{AuditCounts, is_narrow};
use crate::classification::Label;
use crate::study::{Precision, Study};
use crate::table::{Kind, Table, TableError};

/// The number of points that are printed by default; the others are in `points.parquet`.
pub const MOST_LINES: usize = 40;

/// The points of a result: the first `most` of them in full, and the number of the others.
#[derive(Clone, Debug)]
pub struct PointsTable {
    names: Vec<String>,
    rows: Vec<PointLine>,
    most: usize,
    audit: bool,
    flips: AuditCounts,
    precision: Option<Precision>,
    points: u64,
    not_precise: u64,
}

impl PointsTable {
    /// Creates an empty table that stores at most `most` points.
    pub fn new(study: &Study, most: usize) -> Self {
        let names = study.swept().iter().map(|column| column.name.clone()).collect();
        PointsTable {
            names,
            rows: Vec::new(),
            most,
            audit: study.audit().is_some(),
            flips: AuditCounts::default(),
            precision: study.precision(),
            points: 0,
            not_precise: 0,
        }
    }

    /// Reads the table of a study's `points.parquet`.
    ///
    /// # Errors
    /// Returns an error if the table cannot be read.
    pub fn read(study: &Study, table: &Table, most: usize) -> Result<Self, TableError> {
        let mut points = Self::new(study, most);
        let columns = PointLine::columns(study);
        let columns: Vec<(&str, Kind)> =
            columns.iter().map(|(name, kind)| (name.as_str(), *kind)).collect();
        for batch in table.read(&columns)? {
            PointLine::read(study, &batch?)?.into_iter().for_each(|line| points.push(line));
        }
        Ok(points)
    }

    /// Returns a point as one line of text.
    pub fn sentence(&self, line: &PointLine) -> String {
        let names = self.names.iter().zip(&line.swept);
        let place: String = names.map(|(name, (text, _))| format!(" {name}={text}")).collect();
        let failed = match line.label_runs(Label::Failed) {
            0 => String::new(),
            failed => format!(", {failed} failed"),
        };
        let (low, high) = line.interval;
        format!(
            "point {}{place}: {} runs, equilibria {:.4} ({low:.4} .. {high:.4}){failed}",
            line.point_id, line.runs, line.equilibrium_fraction
        )
    }

    /// Adds a point.
    pub fn push(&mut self, line: PointLine) {
        self.points += 1;
        self.not_precise += u64::from(self.is_precise(&line) == Some(false));
        let AuditCounts { runs, flips, rest_flips } = line.audit;
        self.flips.runs = self.flips.runs.saturating_add(runs);
        self.flips.flips = self.flips.flips.saturating_add(flips);
        self.flips.rest_flips = self.flips.rest_flips.saturating_add(rest_flips);
        if self.rows.len() < self.most {
            self.rows.push(line);
        }
    }

    /// Returns the audit counts of all points, in a study with an audit.
    pub fn flips(&self) -> Option<AuditCounts> {
        self.audit.then_some(self.flips)
    }

    fn is_precise(&self, line: &PointLine) -> Option<bool> {
        let widest = self.precision?.equilibrium_fraction;
        Some(is_narrow(line.interval, widest))
    }

    /// Returns the number of points at which the requested precision was not reached.
    pub fn not_precise(&self) -> u64 {
        self.not_precise
    }

    /// Returns a line on the precision that the study asks for; `None` if it asks for none.
    pub fn precision_line(&self) -> Option<String> {
        let Precision { equilibrium_fraction, max_runs } = self.precision?;
        let (points, not) = (self.points, self.not_precise);
        Some(format!(
            "fraction known to +-{equilibrium_fraction} at {} of {points} points{}",
            points - not,
            if not > 0 { format!(", not at {not} (max_runs {max_runs})") } else { String::new() }
        ))
    }

    /// Returns the table as text, aligned to the right.
    pub fn text(&self) -> String {
        aligned(&self.lines()) + &self.more_line("")
    }

    /// Returns the table in Markdown.
    pub fn markdown(&self) -> String {
        let lines = self.lines();
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let columns = lines.first().map_or(0, Vec::len);
        let rule = line(&vec!["--:".to_owned(); columns]);
        let mut text: String = lines.iter().take(1).map(|cells| line(cells)).collect();
        text += &rule;
        text.extend(lines.iter().skip(1).map(|cells| line(cells)));
        text + &self.more_line("\n")
    }

    /// Returns a line with the number of points that are not printed; empty if all are.
    fn more_line(&self, before: &str) -> String {
        match self.points - self.rows.len() as u64 {
            0 => String::new(),
            more => format!("{before}... and {more} more points in points.parquet\n"),
        }
    }

    /// Returns the cells of the header and of the points.
    fn lines(&self) -> Vec<Vec<String>> {
        let mut header: Vec<String> = vec!["point".to_owned()];
        header.extend(self.names.iter().cloned());
        header.extend(
            ["runs", "equilibria", "fraction", "95 % interval", "median rest [s]"]
                .map(String::from),
        );
        let others: Vec<Label> = Label::ALL[1..]
            .iter()
            .copied()
            .filter(|&label| self.rows.iter().any(|row| row.label_runs(label) > 0))
            .collect();
        header.extend(others.iter().map(|label| label.name().to_owned()));
        header.extend(self.audit.then(|| "flips".to_owned()));
        let line = |row: &PointLine| -> Vec<String> {
            let mut cells = vec![row.point_id.to_string()];
            cells.extend(row.swept.iter().map(|(text, _)| text.clone()));
            cells.push(row.runs.to_string());
            cells.push(row.label_runs(Label::Equilibrium).to_string());
            cells.push(format!("{:.4}", row.equilibrium_fraction));
            cells.push(format!("{:.4} .. {:.4}", row.interval.0, row.interval.1));
            cells.push(match row.time_to_rest_p50_s {
                Some(median) => format!("{median:.2}"),
                None => "not reached".to_owned(),
            });
            cells.extend(others.iter().map(|&label| row.label_runs(label).to_string()));
            let AuditCounts { runs, flips, .. } = row.audit;
            cells.extend(self.audit.then(|| format!("{flips} of {runs}")));
            cells
        };
        let mut lines = vec![header];
        lines.extend(self.rows.iter().map(line));
        lines
    }

    /// Returns the table as JSON.
    pub fn json(&self) -> Value {
        self.rows.iter().map(|row| self.point_json(row)).collect()
    }

    /// Returns a point as JSON.
    pub fn point_json(&self, row: &PointLine) -> Value {
        let mut object = serde_json::Map::new();
        object.insert("point_id".to_owned(), json!(row.point_id));
        for (name, (_, value)) in self.names.iter().zip(&row.swept) {
            object.insert(name.clone(), value.clone());
        }
        object.insert("runs".to_owned(), json!(row.runs));
        for label in Label::ALL {
            object.insert(format!("{}_runs", label.name()), json!(row.label_runs(label)));
        }
        object.insert("equilibrium_fraction".to_owned(), json!(row.equilibrium_fraction));
        object.insert("ci_low".to_owned(), json!(row.interval.0));
        object.insert("ci_high".to_owned(), json!(row.interval.1));
        object.insert("ci_method".to_owned(), json!(row.ci_method));
        object.insert("time_to_rest_p50_s".to_owned(), json!(row.time_to_rest_p50_s));
        if let Some(precise) = self.is_precise(row) {
            object.insert("precision_reached".to_owned(), json!(precise));
        }
        if self.audit {
            let audit = &row.audit;
            object.insert("audited_runs".to_owned(), json!(audit.runs));
            object.insert("audit_flips".to_owned(), json!(audit.flips));
            object.insert("audit_rest_flips".to_owned(), json!(audit.rest_flips));
            object.insert("audit_flip_rate".to_owned(), json!(audit.flip_rate()));
            object.insert("audit_flip_low".to_owned(), json!(audit.interval().0));
            object.insert("audit_flip_high".to_owned(), json!(audit.interval().1));
        }
        object.insert("set_fraction".to_owned(), json!(row.set_fraction));
        Value::Object(object)
    }
}

/// Returns lines of cells as text, with each column as wide as its widest cell.
pub fn aligned(lines: &[Vec<String>]) -> String {
    let columns = lines.first().map_or(0, Vec::len);
    let width = |column: usize| {
        let cells = lines.iter().filter_map(|line| line.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for line in lines {
        let cells = line.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}"));
        text += cells.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    text
}
