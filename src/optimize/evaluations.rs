//! The evaluated designs of a search, and `evaluations.parquet`, which holds them with their responses.
//!
//! A search continues from this table: all its further steps are a function of the table and of the study.

use std::path::Path;

use serde_json::{Value, json};

use crate::analysis::LabelCounts;
use crate::classification::Label;
use crate::engine::CommandError;
use crate::named::named;
use crate::responses::Answer;
use crate::responses::columns::answer_columns;
use crate::study::{DesignValue, Study, changed_keys};
use crate::table::column::{Column, Columns};
use crate::table::{Row, Table};

/// Why a design was evaluated.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum DesignOrigin {
    /// The design that the best one is compared with.
    CompareWith,
    /// A space-filling design over all ranges and choices.
    SpaceFilling,
    /// A design that the surrogates proposed.
    Surrogates,
    /// The next space-filling design, because the surrogates proposed none or a repeated one.
    SpaceFillingInstead,
}

named!(DesignOrigin {
    CompareWith: "compare_with",
    SpaceFilling: "spread",
    Surrogates: "surrogates",
    SpaceFillingInstead: "spread_instead",
});

/// A design with its responses at every point of the sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Why the design was evaluated.
    pub origin: DesignOrigin,
    /// One value per variable of the study.
    pub values: Vec<DesignValue>,
    /// One answer per point.
    pub answers: Vec<Answer>,
}

/// Returns the columns of `evaluations.parquet`: one row per design and point of the sweep.
pub fn evaluation_columns(study: &Study) -> Vec<Column<(DesignOrigin, Answer)>> {
    let mut columns = answer_columns(study, |row: &(DesignOrigin, Answer)| &row.1);
    let mut list = Columns::<(DesignOrigin, Answer)>::new();
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
        let start = study.optimization().map(|optimization| optimization.start_designs);
        fields.insert("start_designs".to_owned(), json!(start));
    }
    json!({"design": file["design"], "responses": file["responses"], "optimize": optimize})
}

/// Reads the evaluations in a directory, in their order; empty if it has no such table.
///
/// # Errors
/// Returns an error if the table cannot be read or is of another study or search.
pub fn read_evaluations(study: &Study, directory: &Path) -> Result<Vec<Evaluation>, CommandError> {
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
        CommandError::Usage(format!(
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
    let refused = |what: &str| {
        let allowed = "the unchanged table, or another directory with --out";
        CommandError::Usage(format!("{}: {what}\n  allowed: {allowed}", path.display()))
    };
    let mut rows = Vec::new();
    for (number, row) in table.read_rows(|row| read_row(study, row))?.enumerate() {
        let not_own = || refused(&format!("row {} is not a row of a search", number + 1));
        rows.push(row?.ok_or_else(not_own)?);
    }
    grouped_by_design(study, rows).ok_or_else(|| refused("incomplete designs"))
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
fn grouped_by_design(study: &Study, rows: Vec<(DesignOrigin, Answer)>) -> Option<Vec<Evaluation>> {
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
    let complete = evaluations.last().is_none_or(|last| last.answers.len() as u64 == points);
    complete.then_some(evaluations)
}

/// More runs than any design has.
const MOST_RUNS: u64 = 1 << 60;

/// Returns the design in a row with its answer at a point; `None` if it is none.
fn read_row(study: &Study, row: &Row<'_>) -> Option<(DesignOrigin, Answer)> {
    let (design, point_id) = (row.count("design"), row.count("point_id"));
    let origin = row.text("origin");
    let values = study.variables().iter().map(|variable| match variable.unit() {
        Some(_) => Some(variable.number(row.number(variable.name())?)),
        None => Some(variable.word(&row.text(variable.name())?)),
    });
    let values: Vec<Option<_>> = values.collect();
    let runs = Label::ALL.map(|label| row.count(label.name()));
    let estimates = study.responses().iter().map(|response| row.estimate(&response.name)).collect();
    let mut counts = LabelCounts::default();
    for (label, runs) in Label::ALL.into_iter().zip(runs) {
        counts.add_many(label, runs.filter(|runs| *runs < MOST_RUNS)?);
    }
    let point_id = point_id.filter(|point| *point < study.point_count())?;
    let answer = Answer {
        design: design?,
        values: values.into_iter().map(|value| value?.ok()).collect::<Option<_>>()?,
        point_id,
        swept: study.point(point_id).swept,
        estimates,
        counts,
        discontinuous: None,
    };
    let is_named = |candidate: &&DesignOrigin| Some(candidate.name()) == origin.as_deref();
    Some((*DesignOrigin::ALL.iter().find(is_named)?, answer))
}
