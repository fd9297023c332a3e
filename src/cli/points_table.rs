//! The table of points on the terminal, in Markdown and as JSON.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::{Map, Value, json};

use super::result_lines::point_line;
use crate::analysis::AuditCounts;
use crate::classification::Label;
use crate::numbers::counted;
use crate::printed_table::{PrintedColumn, as_markdown, as_text};
use crate::report::{Conclusion, PointFacts, printed_columns, response_columns};
use crate::responses::{add_known, merged};
use crate::study::{Response, Study};
use crate::table::column::Column;
use crate::table::{Batch, PointRow, Row, Table, TableError, point_columns};

/// The number of points that are printed by default; the others are in `points.parquet`.
pub const MOST_LINES: usize = 40;

/// The points of a result: the first `most` of them in full, and the number of the others.
pub struct PointsTable<'a> {
    study: &'a Study,
    columns: Vec<Column<PointRow>>,
    rows: Vec<PointFacts>,
    /// These points as JSON.
    json: Vec<Value>,
    /// The values of the swept parameters of each of these points.
    shown: Vec<Vec<String>>,
    most: usize,
    flips: AuditCounts,
    points: u64,
    /// The number of points at which the requested precision was not reached.
    not_precise: u64,
    conclusion: Conclusion,
    /// Whether the directory of the results has a `points.parquet` with these points.
    pub is_saved: bool,
}

impl<'a> PointsTable<'a> {
    /// Creates an empty table that stores at most `most` points.
    pub fn new(study: &'a Study, most: usize) -> Self {
        PointsTable {
            study,
            columns: point_columns(study),
            rows: Vec::new(),
            json: Vec::new(),
            shown: Vec::new(),
            most,
            flips: AuditCounts::default(),
            points: 0,
            not_precise: 0,
            conclusion: Conclusion::new(study),
            is_saved: true,
        }
    }

    /// Reads the table of a study's `points.parquet`.
    pub fn read(study: &'a Study, table: &Table, most: usize) -> Result<Self, TableError> {
        let (columns, mut points) = (point_columns(study), Self::new(study, most));
        table.for_each(|row| {
            let json = points.has_room().then(|| point_json(study, row));
            if let Some(point) = PointRow::read(study, &columns, row) {
                points.add(PointFacts::of(study, &point), json);
            }
        })?;
        Ok(points)
    }

    /// Returns a point as one line of text.
    pub fn sentence(&self, point: &PointFacts) -> String {
        point_line(self.study, point, self.conclusion.own_machines)
    }

    /// Adds a point of the study whose runs have finished.
    pub fn push(&mut self, row: &PointRow) {
        let json = self.has_room().then(|| self.point_json(row));
        self.add(PointFacts::of(self.study, row), json);
    }

    fn has_room(&self) -> bool {
        self.rows.len() < self.most
    }

    fn add(&mut self, point: PointFacts, json: Option<Value>) {
        self.points += 1;
        self.conclusion.add(self.study, &point);
        self.not_precise += u64::from(point.precise == Some(false));
        let AuditCounts { runs, flips, rest_flips } = point.audit;
        self.flips.runs = self.flips.runs.saturating_add(runs);
        self.flips.flips = self.flips.flips.saturating_add(flips);
        self.flips.rest_flips = self.flips.rest_flips.saturating_add(rest_flips);
        if let Some(json) = json {
            self.shown.push(self.study.shown(&point.swept));
            self.rows.push(point);
            self.json.push(json);
        }
    }

    /// Returns the audit counts of all points, in a study with an audit.
    pub fn flips(&self) -> Option<AuditCounts> {
        self.study.audit().map(|_| self.flips)
    }

    /// Returns the number of points at which the precision is not reached that the study asks for.
    pub fn not_precise(&self) -> Option<u64> {
        self.study.precision().map(|_| self.not_precise)
    }

    /// Returns a line on the precision that the study asks for; `None` if it asks for none.
    pub fn precision_line(&self) -> Option<String> {
        let precision = self.study.precision()?;
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
        let mut text = as_text(&self.columns()) + &self.more_line("") + &self.conclusion.text();
        if let Some(columns) = self.response_columns() {
            text += &format!("\n{}{}", as_text(&columns), self.about_responses("\n"));
        }
        text
    }

    /// Returns the table in Markdown, and what it says in words.
    pub fn markdown(&self) -> String {
        let mut text = as_markdown(&self.columns()) + &self.more_line("\n");
        let words = self.conclusion.text();
        if !words.is_empty() {
            // A blank line separates paragraphs.
            text += &format!("\n{}\n", words.lines().collect::<Vec<_>>().join("\n\n"));
        }
        if let Some(columns) = self.response_columns() {
            text += &format!("\n{}\n{}", as_markdown(&columns), self.about_responses("\n\n"));
        }
        text
    }

    fn response_columns(&self) -> Option<Vec<PrintedColumn>> {
        let (study, responses) = (self.study, self.study.responses());
        let rows = (&self.rows[..], study.swept(), &self.shown[..]);
        (!responses.is_empty()).then(|| response_columns(rows, responses, study.units()))
    }

    /// Returns what each response means, and why values are missing.
    fn about_responses(&self, end: &str) -> String {
        let mut text = String::new();
        for (index, response) in self.study.responses().iter().enumerate() {
            let meaning = response.meaning_in(&self.study.units().vibration());
            text += &format!("{}: {meaning}{end}", response.name);
            let estimates = self.rows.iter().filter_map(|row| row.responses.get(index));
            let missing = estimates.filter(|estimate| estimate.value.is_none());
            let reasons: BTreeSet<&str> = missing.filter_map(|gap| gap.reason.as_deref()).collect();
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
        let study = self.study;
        let vibrates = study.model().kind().offers.vibration;
        let vibration = vibrates.then(|| study.units().vibration());
        let rows = (&self.rows[..], study.swept(), &self.shown[..]);
        printed_columns(rows, vibration.as_ref(), study.audit().is_some())
    }

    /// Returns the result of a command as JSON: `facts` of the command, and the points.
    pub fn result_json(
        &self,
        out: Option<&Path>,
        [planned, finished]: [u64; 2],
        facts: Value,
    ) -> Value {
        let keys = json!({
            "study": self.study.name(),
            "out": out.map(|out| out.display().to_string()),
            "runs_planned": planned,
            "runs_finished": finished,
        });
        let mut report = merged(keys, facts);
        report["points"] = self.json.clone().into();
        add_known(&mut report, "points_not_precise", self.not_precise());
        report
    }

    /// Returns a point whose runs have finished as JSON.
    pub fn point_json(&self, row: &PointRow) -> Value {
        let batch = Batch::of(&self.columns, std::slice::from_ref(row));
        // The values fit the columns, or the table could not be written either.
        batch.map_or(Value::Null, |batch| point_json(self.study, &batch.row(0)))
    }
}

/// The columns of `points.parquet` in the JSON object of a point, and those that need a precision or an audit.
const COLUMNS: [&str; 12] = [
    "runs",
    "amplitude_p50_m",
    "amplitude_p95_m",
    "amplitude_without_balls_m",
    "relative_amplitude_p50",
    "relative_amplitude_p95",
    "worse_than_without_balls_fraction",
    "worse_than_without_balls_low",
    "worse_than_without_balls_high",
    "balance_quality_grade_p50_mm_s",
    "balance_quality_grade_p95_mm_s",
    "overlapping_rest_fraction",
];
const OF_REST: [&str; 5] =
    ["equilibrium_fraction", "ci_low", "ci_high", "ci_method", "time_to_rest_p50_s"];
const OF_PRECISION: [&str; 1] = ["precision_reached"];
const OF_AUDIT: [&str; 6] = [
    "audited_runs",
    "audit_flips",
    "audit_rest_flips",
    "audit_flip_rate",
    "audit_flip_low",
    "audit_flip_high",
];

/// Returns a row of `points.parquet` as JSON.
fn point_json(study: &Study, row: &Row<'_>) -> Value {
    let swept = study.swept().iter().map(|column| column.name.as_str());
    let of_labels: Vec<String> = Label::names().map(|label| format!("{label}_runs")).collect();
    let columns = ["point_id"].into_iter().chain(swept).chain(COLUMNS);
    let columns = columns.chain(of_labels.iter().map(String::as_str)).chain(OF_REST);
    let columns = columns.chain(study.precision().map(|_| OF_PRECISION).into_iter().flatten());
    let columns = columns.chain(study.audit().map(|_| OF_AUDIT).into_iter().flatten());
    let columns = columns.chain(["set_fraction"]);
    let mut object: Map<String, Value> =
        columns.map(|name| (name.to_owned(), row.json(name))).collect();
    let response = |response: &Response| {
        let mut estimate = json!(row.estimate(&response.column()));
        let without = || row.json(&response.column_without_balls());
        add_known(&mut estimate, "without_balls", response.has_value_without_balls().then(without));
        (response.name.clone(), estimate)
    };
    if !study.responses().is_empty() {
        let responses = study.responses().iter().map(response).collect();
        object.insert("responses".to_owned(), Value::Object(responses));
    }
    object.into()
}
