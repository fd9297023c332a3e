//! `evaluations.parquet`: writes and reads the designs of a search with their responses.
//!
//! A search continues from this table: all its further steps are a function of the table and of the study.

use std::path::Path;

use serde_json::{Value, json};
use thiserror::Error;

use super::evaluation::{Evaluation, Origin};
use crate::analysis::LabelCounts;
use crate::classification::Label;
use crate::responses::Answer;
use crate::responses::columns::answer_columns;
use crate::study::{DesignValue, Study, changed_keys};
use crate::table::column::{Column, Columns};
use crate::table::{Batch, Kind, Table, TableError, estimate_kinds, read_estimate};

/// Returns the columns of `evaluations.parquet`: one row per design and point of the sweep.
pub fn evaluation_columns(study: &Study) -> Vec<Column<(Origin, Answer)>> {
    let mut columns = answer_columns(study, |row: &(Origin, Answer)| &row.1);
    let mut list = Columns::<(Origin, Answer)>::new();
    list.extend(columns.drain(..1));
    list.word("origin", |row| row.0.name()).meaning(
        "why the design was evaluated: compare_with, spread over all ranges and choices, chosen by \
         surrogates, or spread_instead if the surrogates proposed no new design",
    );
    list.extend(columns);
    list.finish()
}

/// The keys of `optimize` that do not determine the next design.
const FREE: [&str; 4] = ["designs", "finalists", "final_samples", "sensitivity"];

/// Returns the parts of a study that determine the next design. The number of designs and the finalists do not.
pub fn search_facts(study: &Study) -> Value {
    let file = study.resolved_file();
    let mut optimize = file["optimize"].clone();
    if let Some(fields) = optimize.as_object_mut() {
        for key in FREE {
            fields.remove(key);
        }
        let start = study.optimization().map(|one| one.start_designs);
        fields.insert("start_designs".to_owned(), json!(start));
    }
    json!({"design": file["design"], "responses": file["responses"], "optimize": optimize})
}

/// The reason why a search cannot continue from earlier evaluations.
#[derive(Debug, Error)]
pub enum EvaluationsError {
    /// The table cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The table is of another study or search, or has invalid rows.
    #[error("{0}")]
    Other(String),
}

/// Reads the evaluations in a directory, in their order; empty if it has no such table.
///
/// # Errors
/// Returns an error if the table cannot be read or is of another study or search.
pub fn read_evaluations(
    study: &Study,
    directory: &Path,
) -> Result<Vec<Evaluation>, EvaluationsError> {
    let path = directory.join("evaluations.parquet");
    if !path.exists() {
        return Ok(Vec::new());
    }
    let (table, about) = Table::of_itself(directory, "evaluations").map_err(|mut error| {
        error.allowed += "; or remove this table to begin the search anew, with the same designs";
        error
    })?;
    let other = |what: &str| {
        let mut differences = differences(study, &about);
        if differences.is_empty() {
            differences.push(format!("another {what}"));
        }
        EvaluationsError::Other(format!(
            "{}: evaluations of another search\n  found:   a search that differs in\n    {}\n  allowed: another \
             directory with --out, or the study of these evaluations",
            path.display(),
            differences.join("\n    ")
        ))
    };
    if about["study_hash"] != study.hash() {
        return Err(other("machine, sampling or simulation"));
    }
    let facts = search_facts(study);
    for key in ["design", "responses", "optimize"] {
        if about["options"][key] != facts[key] {
            return Err(other(&format!("`{key}`")));
        }
    }
    let mut rows = Vec::new();
    let columns = columns_to_read(study);
    let columns: Vec<(&str, Kind)> =
        columns.iter().map(|(name, kind)| (name.as_str(), *kind)).collect();
    for batch in table.read(&columns)? {
        let batch = batch?;
        for index in 0..batch.rows {
            let row = read_row(study, &batch, index).ok_or_else(|| {
                EvaluationsError::Other(format!(
                    "{}: row {} is not a row of a search\n  allowed: the unchanged table, or \
                     another directory with --out",
                    path.display(),
                    batch.first_row + index as u64 + 1
                ))
            })?;
            rows.push(row);
        }
    }
    grouped_by_design(study, rows).ok_or_else(|| {
        EvaluationsError::Other(format!(
            "{}: incomplete designs\n  allowed: the unchanged table, or another directory \
             with --out",
            path.display()
        ))
    })
}

/// The largest number of differences that a message lists.
const MOST_DIFFERENCES: usize = 20;

/// Returns the changed keys that prevent the search from continuing. Each line has a key, its value in the earlier
/// search and its value in this search. The list is empty if the study of the earlier search cannot be read.
fn differences(study: &Study, about: &Value) -> Vec<String> {
    let text = about["study_yaml"].as_str().unwrap_or_default().to_owned();
    let Ok(before) = Study::parse(Path::new("study.yaml"), text) else { return Vec::new() };
    let free = ["name", "expect"].map(str::to_owned).into_iter();
    let free: Vec<String> = free.chain(FREE.map(|key| format!("optimize.{key}"))).collect();
    let is_free = |line: &String| {
        let key = line.split(':').next().unwrap_or_default();
        free.iter().any(|free| {
            key.strip_prefix(free.as_str())
                .is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        })
    };
    let mut lines = changed_keys(&before, study);
    lines.retain(|line| !is_free(line));
    let more = lines.len().saturating_sub(MOST_DIFFERENCES);
    lines.truncate(MOST_DIFFERENCES);
    if more > 0 {
        lines.push(format!("and {more} more"));
    }
    lines
}

/// Groups the rows of each design; returns `None` if they are not complete designs in order.
fn grouped_by_design(study: &Study, rows: Vec<(Origin, Answer)>) -> Option<Vec<Evaluation>> {
    let mut evaluations: Vec<Evaluation> = Vec::new();
    let points = study.point_count();
    for (number, (origin, answer)) in (0..).zip(rows) {
        if (answer.design, answer.point_id) != (number / points, number % points) {
            return None;
        }
        match evaluations.last_mut().filter(|_| answer.point_id > 0) {
            Some(last) => last.answers.push(answer),
            None => {
                let values = answer.values.clone();
                evaluations.push(Evaluation { origin, values, answers: vec![answer] });
            }
        }
    }
    let complete = evaluations.last().is_none_or(|one| one.answers.len() as u64 == points);
    complete.then_some(evaluations)
}

/// More runs than any design has.
const MOST_RUNS: u64 = 1 << 60;

fn columns_to_read(study: &Study) -> Vec<(String, Kind)> {
    let mut columns: Vec<(String, Kind)> =
        [("design", Kind::Count), ("origin", Kind::Text), ("point_id", Kind::Count)]
            .map(|(name, kind)| (name.to_owned(), kind))
            .into();
    for variable in study.variables() {
        let kind = if variable.unit().is_some() { Kind::Number } else { Kind::Text };
        columns.push((variable.name().to_owned(), kind));
    }
    columns.extend(Label::ALL.map(|label| (label.name().to_owned(), Kind::Count)));
    for response in study.responses() {
        columns.extend(estimate_kinds(&response.name));
    }
    columns
}

fn read_row(study: &Study, batch: &Batch, index: usize) -> Option<(Origin, Answer)> {
    let at = |values: Option<&Option<u64>>| values.copied().flatten();
    let count = |name: &str| at(batch.counts(name).ok()?.get(index));
    let number = |name: &str| batch.numbers(name).ok()?.get(index).copied().flatten();
    let text = |name: &str| batch.texts(name).ok()?.get(index)?.as_deref();
    let values = study.variables().iter().map(|variable| {
        let value = match variable.unit() {
            Some(_) => variable.number(number(variable.name())?),
            None => variable.word(text(variable.name())?),
        };
        value.ok()
    });
    let values: Vec<DesignValue> = values.collect::<Option<_>>()?;
    let mut counts = LabelCounts::default();
    for label in Label::ALL {
        counts.add_many(label, count(label.name()).filter(|count| *count < MOST_RUNS)?);
    }
    let responses = study.responses().iter();
    let estimates = responses.map(|response| read_estimate(batch, &response.name, index).ok());
    let point_id = count("point_id").filter(|point| *point < study.point_count())?;
    let answer = Answer {
        design: count("design")?,
        values,
        point_id,
        swept: study.point(point_id).swept,
        estimates: estimates.collect::<Option<_>>()?,
        counts,
        discontinuous: None,
    };
    Some((Origin::named(text("origin")?)?, answer))
}
