//! The result of a study as a table on the terminal, or as JSON.

use serde_json::{Value, json};

use crate::analysis::{AuditCounts, is_narrow};
use crate::ending::Label;
use crate::study::{ParameterValue, Precision, Study};
use crate::table::PointRow;

/// Most points that are printed; the rest is in `points.parquet`.
pub const MOST_LINES: usize = 40;

/// One point as shown.
#[derive(Clone, Debug)]
pub struct PointsTable {
    names: Vec<String>,
    rows: Vec<PointRow>,
    more: u64,
    keep_all: bool,
    audit: bool,
    precision: Option<Precision>,
    points: u64,
    not_precise: u64,
}

impl PointsTable {
    /// An empty table for a study; `keep_all` keeps rows that would not be printed.
    pub fn new(study: &Study, keep_all: bool) -> Self {
        let names = study.swept().iter().map(|column| column.name.clone()).collect();
        PointsTable {
            names,
            rows: Vec::new(),
            more: 0,
            keep_all,
            audit: study.audit().is_some(),
            precision: study.precision(),
            points: 0,
            not_precise: 0,
        }
    }

    /// Adds a point.
    pub fn push(&mut self, row: &PointRow) {
        self.points += 1;
        self.not_precise += u64::from(self.is_precise(row) == Some(false));
        if self.keep_all || self.rows.len() < MOST_LINES {
            self.rows.push(row.clone());
        } else {
            self.more += 1;
        }
    }

    fn is_precise(&self, row: &PointRow) -> Option<bool> {
        let widest = self.precision?.equilibrium_fraction;
        Some(is_narrow(row.summary.interval.ends(), widest))
    }

    /// How many points are not known as precisely as the study asks for.
    pub fn not_precise(&self) -> u64 {
        self.not_precise
    }

    /// What has come of the precision that the study asks for, if it does.
    pub fn precision_line(&self) -> Option<String> {
        let Precision { equilibrium_fraction, max_runs } = self.precision?;
        let (points, not) = (self.points, self.not_precise);
        Some(format!(
            "fraction known to +-{equilibrium_fraction} at {} of {points} points{}",
            points - not,
            if not > 0 { format!(", not at {not} (max_runs {max_runs})") } else { String::new() }
        ))
    }

    /// The table as text, numbers aligned to the right.
    pub fn text(&self) -> String {
        let mut header: Vec<String> = vec!["point".to_owned()];
        header.extend(self.names.iter().cloned());
        header.extend(
            ["runs", "equilibria", "fraction", "95 % interval", "median rest [s]"]
                .map(String::from),
        );
        let others: Vec<Label> = Label::ALL[1..]
            .iter()
            .copied()
            .filter(|&label| self.rows.iter().any(|row| row.summary.counts.of(label) > 0))
            .collect();
        header.extend(others.iter().map(|label| label.name().to_owned()));
        header.extend(self.audit.then(|| "flips".to_owned()));
        let line = |row: &PointRow| -> Vec<String> {
            let summary = &row.summary;
            let mut cells = vec![row.point_id.to_string()];
            cells.extend(row.swept.iter().map(ParameterValue::to_string));
            cells.push(summary.counts.total().to_string());
            cells.push(summary.counts.of(Label::Equilibrium).to_string());
            cells.push(format!("{:.4}", summary.equilibrium_fraction));
            cells.push(format!("{:.4} .. {:.4}", summary.interval.low, summary.interval.high));
            cells.push(match summary.time_to_rest_s[1] {
                Some(median) => format!("{median:.2}"),
                None => "not reached".to_owned(),
            });
            cells.extend(others.iter().map(|&label| summary.counts.of(label).to_string()));
            let AuditCounts { runs, flips, .. } = summary.audit;
            cells.extend(self.audit.then(|| format!("{flips} of {runs}")));
            cells
        };
        let mut lines = vec![header];
        lines.extend(self.rows.iter().take(MOST_LINES).map(line));
        let mut text = aligned(&lines);
        let more = self.more + (self.rows.len().saturating_sub(MOST_LINES)) as u64;
        if more > 0 {
            text += &format!("... and {more} more points in points.parquet\n");
        }
        text
    }

    /// The table as JSON.
    pub fn json(&self) -> Value {
        let row = |row: &PointRow| {
            let mut object = serde_json::Map::new();
            object.insert("point_id".to_owned(), json!(row.point_id));
            for (name, value) in self.names.iter().zip(&row.swept) {
                let value = match value {
                    ParameterValue::Number(number) => json!(number),
                    ParameterValue::Text(text) => json!(text),
                };
                object.insert(name.clone(), value);
            }
            let summary = &row.summary;
            object.insert("runs".to_owned(), json!(summary.counts.total()));
            for label in Label::ALL {
                object.insert(format!("{}_runs", label.name()), json!(summary.counts.of(label)));
            }
            object.insert("equilibrium_fraction".to_owned(), json!(summary.equilibrium_fraction));
            object.insert("ci_low".to_owned(), json!(summary.interval.low));
            object.insert("ci_high".to_owned(), json!(summary.interval.high));
            object.insert("ci_method".to_owned(), json!(summary.interval.method.name()));
            object.insert("time_to_rest_p50_s".to_owned(), json!(summary.time_to_rest_s[1]));
            if let Some(precise) = self.is_precise(row) {
                object.insert("precision_reached".to_owned(), json!(precise));
            }
            if self.audit {
                let audit = &summary.audit;
                object.insert("audited_runs".to_owned(), json!(audit.runs));
                object.insert("audit_flips".to_owned(), json!(audit.flips));
                object.insert("audit_rest_flips".to_owned(), json!(audit.rest_flips));
                object.insert("audit_flip_rate".to_owned(), json!(audit.flip_rate()));
                object.insert("audit_flip_low".to_owned(), json!(audit.interval().0));
                object.insert("audit_flip_high".to_owned(), json!(audit.interval().1));
            }
            object.insert("set_fraction".to_owned(), json!(row.set_fraction));
            Value::Object(object)
        };
        self.rows.iter().map(row).collect()
    }
}

/// Lines of cells as text, each column as wide as its widest cell.
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
