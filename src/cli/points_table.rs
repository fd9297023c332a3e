//! The table of points on the terminal, in Markdown and as JSON.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::{Value, json};

use super::point_keys::{merged, point_keys};
use super::point_words::point_line;
use crate::analysis::AuditCounts;
use crate::classification::Label;
use crate::counted::counted;
use crate::report::{
    Conclusion, Fraction, PointFacts, PrintedColumn, printed_columns, response_columns,
};
use crate::responses::responses_json;
use crate::study::{Precision, Response, Study, Units, VariedParameter};
use crate::table::{Table, TableError};
use crate::text_table::text_table;

/// The number of points that are printed by default; the others are in `points.parquet`.
pub const MOST_LINES: usize = 40;

/// The points of a result: the first `most` of them in full, and the number of the others.
#[derive(Clone, Debug)]
pub struct PointsTable {
    swept: Vec<VariedParameter>,
    rows: Vec<PointFacts>,
    /// The values of the swept parameters of each of these points.
    shown: Vec<Vec<String>>,
    most: usize,
    balls: bool,
    audit: bool,
    flips: AuditCounts,
    precision: Option<Precision>,
    points: u64,
    not_precise: u64,
    units: Units,
    conclusion: Conclusion,
    responses: Vec<Response>,
    /// Whether the directory of the results has a `points.parquet` with these points.
    pub is_saved: bool,
}

impl PointsTable {
    /// Creates an empty table that stores at most `most` points.
    pub fn new(study: &Study, most: usize) -> Self {
        PointsTable {
            swept: study.swept().to_vec(),
            units: study.units().clone(),
            rows: Vec::new(),
            shown: Vec::new(),
            most,
            balls: study.model().kind().offers.vibration,
            audit: study.audit().is_some(),
            flips: AuditCounts::default(),
            precision: study.precision(),
            points: 0,
            not_precise: 0,
            conclusion: Conclusion::new(study),
            responses: study.responses().to_vec(),
            is_saved: true,
        }
    }

    /// Reads the table of a study's `points.parquet`.
    ///
    /// # Errors
    /// Returns an error if the table cannot be read.
    pub fn read(study: &Study, table: &Table, most: usize) -> Result<Self, TableError> {
        let mut points = Self::new(study, most);
        PointFacts::for_each(study, table, 1, |point| points.push(study, point))?;
        Ok(points)
    }

    /// Returns a point as one line of text.
    pub fn sentence(&self, study: &Study, point: &PointFacts) -> String {
        point_line(study, point, self.conclusion.own_machines)
    }

    /// Adds a point of the study.
    pub fn push(&mut self, study: &Study, point: PointFacts) {
        self.points += 1;
        self.conclusion.add(study, &point);
        self.not_precise += u64::from(point.precise == Some(false));
        let AuditCounts { runs, flips, rest_flips } = point.audit;
        self.flips.runs = self.flips.runs.saturating_add(runs);
        self.flips.flips = self.flips.flips.saturating_add(flips);
        self.flips.rest_flips = self.flips.rest_flips.saturating_add(rest_flips);
        if self.rows.len() < self.most {
            self.shown.push(study.shown(&point.swept));
            self.rows.push(point);
        }
    }

    /// Returns the audit counts of all points, in a study with an audit.
    pub fn flips(&self) -> Option<AuditCounts> {
        self.audit.then_some(self.flips)
    }

    /// Returns the number of points at which the requested precision was not reached.
    pub fn not_precise(&self) -> u64 {
        self.not_precise
    }

    /// Returns a line on the precision that the study asks for; `None` if it asks for none.
    pub fn precision_line(&self) -> Option<String> {
        let precision = self.precision?;
        let (precise, max_runs) = (precision.in_words(), precision.max_runs);
        let (points, not) = (self.points, self.not_precise);
        Some(format!(
            "{precise} at {} of {points} points{}",
            points - not,
            if not > 0 { format!(", not at {not} (max_runs {max_runs})") } else { String::new() }
        ))
    }

    /// Returns the table as text, aligned to the right, and what it says in words.
    pub fn text(&self) -> String {
        let table = |columns: &[PrintedColumn]| {
            let header = |line: usize| columns.iter().map(move |one| one.header[line].clone());
            let mut lines: Vec<Vec<String>> = vec![header(0).collect(), header(1).collect()];
            lines.extend(self.cells(columns));
            text_table(&lines, &[])
        };
        let mut text = table(&self.columns()) + &self.more_line("") + &self.conclusion.text();
        if let Some(columns) = self.response_columns() {
            text += &format!("\n{}{}", table(&columns), self.about_responses("\n"));
        }
        text
    }

    /// Returns the table in Markdown, and what it says in words.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let table = |columns: &[PrintedColumn]| {
            let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
            let mut text = line(&names) + &line(&vec!["--:".to_owned(); columns.len()]);
            text.extend(self.cells(columns).iter().map(|cells| line(cells)));
            text
        };
        let mut text = table(&self.columns()) + &self.more_line("\n");
        let words = self.conclusion.text();
        if !words.is_empty() {
            // A blank line separates paragraphs.
            text += &format!("\n{}\n", words.lines().collect::<Vec<_>>().join("\n\n"));
        }
        if let Some(columns) = self.response_columns() {
            text += &format!("\n{}\n{}", table(&columns), self.about_responses("\n\n"));
        }
        text
    }

    fn response_columns(&self) -> Option<Vec<PrintedColumn>> {
        let has_responses = !self.responses.is_empty();
        has_responses.then(|| {
            response_columns((&self.rows, &self.swept, &self.shown), &self.responses, &self.units)
        })
    }

    /// Returns what each response means, and why values are missing.
    fn about_responses(&self, end: &str) -> String {
        let mut text = String::new();
        for (index, response) in self.responses.iter().enumerate() {
            text += &format!(
                "{}: {}{end}",
                response.name,
                response.meaning_in(&self.units.vibration())
            );
            let estimates = self.rows.iter().filter_map(|row| row.responses.get(index));
            let missing = estimates.filter(|estimate| estimate.value.is_none());
            let reasons: BTreeSet<&str> = missing.filter_map(|one| one.reason.as_deref()).collect();
            for reason in reasons {
                text += &format!("{} is missing where {reason}{end}", response.name);
            }
        }
        text
    }

    /// Returns a line with the number of points that are not printed; empty if all are.
    fn more_line(&self, before: &str) -> String {
        match self.points - self.rows.len() as u64 {
            0 => String::new(),
            more => {
                let points = counted(more, "more point");
                let place = match self.is_saved {
                    true => "in points.parquet",
                    false => "with finished runs; `--points all` prints them",
                };
                format!("{before}... and {points} {place}\n")
            }
        }
    }

    fn columns(&self) -> Vec<PrintedColumn> {
        let vibration = self.balls.then(|| self.units.vibration());
        printed_columns((&self.rows, &self.swept, &self.shown), vibration.as_ref(), self.audit)
    }

    /// Returns the cells of each point.
    fn cells(&self, columns: &[PrintedColumn]) -> Vec<Vec<String>> {
        let row = |row: usize| {
            columns.iter().filter_map(|column| column.cells.get(row).cloned()).collect()
        };
        (0..self.rows.len()).map(row).collect()
    }

    /// Returns the result of a command as JSON: `facts` of the command, and the points.
    pub fn result_json(
        &self,
        study: &Study,
        out: Option<&Path>,
        [planned, finished]: [u64; 2],
        facts: Value,
    ) -> Value {
        let keys = json!({
            "study": study.name(),
            "out": out.map(|out| out.display().to_string()),
            "runs_planned": planned,
            "runs_finished": finished,
        });
        let mut report = merged(keys, facts);
        report["points"] = self.rows.iter().map(|row| self.point_json(row)).collect();
        if self.precision.is_some() {
            report["points_not_precise"] = self.not_precise.into();
        }
        report
    }

    /// Returns a point as JSON.
    pub fn point_json(&self, row: &PointFacts) -> Value {
        let mut object = point_keys(row.point_id, &self.swept, &row.swept);
        object["runs"] = json!(row.runs);
        let [_, median, p95] = row.amplitude_m;
        object["amplitude_p50_m"] = json!(median);
        object["amplitude_p95_m"] = json!(p95);
        object["amplitude_without_balls_m"] = json!(row.residual.amplitude_without_balls_m);
        let [_, median, p95] = row.residual.relative_amplitude;
        object["relative_amplitude_p50"] = json!(median);
        object["relative_amplitude_p95"] = json!(p95);
        let worse = |end: usize| row.residual.worse_than_without_balls.map(|worse| worse[end]);
        object["worse_than_without_balls_fraction"] = json!(worse(0));
        object["worse_than_without_balls_low"] = json!(worse(1));
        object["worse_than_without_balls_high"] = json!(worse(2));
        let [median, p95] = row.residual.balance_quality_grade_mm_s;
        object["balance_quality_grade_p50_mm_s"] = json!(median);
        object["balance_quality_grade_p95_mm_s"] = json!(p95);
        object["overlapping_rest_fraction"] = json!(row.residual.overlapping_rest_fraction);
        for label in Label::ALL {
            object[format!("{}_runs", label.name())] = json!(row.label(label).runs);
        }
        let Fraction { fraction, low, high, .. } = row.equilibrium;
        object["equilibrium_fraction"] = json!(fraction);
        object["ci_low"] = json!(low);
        object["ci_high"] = json!(high);
        object["ci_method"] = json!(row.ci_method);
        object["time_to_rest_p50_s"] = json!(row.time_to_rest_s[1]);
        if let Some(precise) = row.precise {
            object["precision_reached"] = json!(precise);
        }
        if self.audit {
            let audit = &row.audit;
            object["audited_runs"] = json!(audit.runs);
            object["audit_flips"] = json!(audit.flips);
            object["audit_rest_flips"] = json!(audit.rest_flips);
            object["audit_flip_rate"] = json!(audit.flip_rate());
            object["audit_flip_low"] = json!(audit.interval().0);
            object["audit_flip_high"] = json!(audit.interval().1);
        }
        object["set_fraction"] = json!(row.set_fraction);
        if !self.responses.is_empty() {
            object["responses"] = responses_json(&self.responses, &row.responses);
            let without = self.responses.iter().zip(&row.responses_without_balls);
            for (response, value) in without.filter(|(one, _)| one.has_value_without_balls()) {
                object["responses"][&response.name]["without_balls"] = json!(value);
            }
        }
        object
    }
}
