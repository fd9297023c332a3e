//! The output directory of a search, which the same search continues, and the columns of its tables of results.

use std::path::Path;

use serde_json::json;

use super::evaluations::{Evaluation, evaluation_columns, search_facts};
use super::finalists::{Finalist, FinalistRole};
use super::goal::Goal;
use super::sensitivity::{QuantitySurrogate, Sensitivity, SobolIndex};
use crate::engine::{CommandError, ContinuedDirectory};
use crate::responses::Answer;
use crate::responses::columns::{add_variables, answer_columns};
use crate::study::{Optimization, Study};
use crate::table::column::{Column, Columns};
use crate::table::{WriteError, add_estimate, provenance_with};

/// The output directory of a search.
pub(super) struct SearchDirectory<'a> {
    study: &'a Study,
    optimization: &'a Optimization,
    pub directory: ContinuedDirectory<'a>,
}

/// The files that a search writes.
const OWN: [&str; 6] = [
    EVALUATIONS,
    "finalists.parquet",
    "pareto.parquet",
    "sensitivities.parquet",
    "surrogates.json",
    "optimum.json",
];
const EVALUATIONS: &str = "evaluations.parquet";

impl<'a> SearchDirectory<'a> {
    /// Opens the directory. Returns an error if it holds anything but files of a search.
    pub fn new(
        study: &'a Study,
        optimization: &'a Optimization,
        directory: &'a Path,
    ) -> Result<Self, CommandError> {
        let reason = "this directory is not empty and holds no search";
        let directory = ContinuedDirectory::open(directory, reason, |name| OWN.contains(&name))?;
        Ok(SearchDirectory { study, optimization, directory })
    }

    /// Removes the results of an earlier end of the search, because there are more designs now.
    pub fn remove_ends(&mut self) {
        self.directory.remove(OWN.into_iter().filter(|name| *name != EVALUATIONS));
    }

    pub fn write<R>(
        &mut self,
        name: &str,
        columns: Vec<Column<R>>,
        rows: impl IntoIterator<Item = R>,
    ) -> Result<(), WriteError> {
        let about = provenance_with(self.study, name, &search_facts(self.study));
        self.directory.write(name, &about, columns, rows)
    }

    pub fn write_evaluations(&mut self, evaluations: &[Evaluation]) -> Result<(), WriteError> {
        let rows = evaluations
            .iter()
            .flat_map(|design| design.answers.iter().map(|answer| (design.origin, answer.clone())));
        self.write("evaluations", evaluation_columns(self.study), rows)
    }

    pub fn write_finals(&mut self, finalists: &[Finalist]) -> Result<(), WriteError> {
        let rows = finalists
            .iter()
            .flat_map(|design| design.answers.iter().map(|answer| (design.role, answer.clone())));
        self.write("finalists", finalist_columns(self.study), rows)?;
        if self.optimization.objectives.len() < 2 {
            return Ok(());
        }
        let front =
            finalists.iter().filter(|finalist| finalist.role == FinalistRole::Pareto).cloned();
        self.write("pareto", pareto_columns(self.study, self.optimization), front)
    }

    pub fn write_surrogates(&mut self, all: &[QuantitySurrogate]) -> Result<(), CommandError> {
        let states = all.iter().map(|(response, surrogate)| {
            let name = &self.study.responses()[*response].name;
            let state = match surrogate {
                Ok(surrogate) => surrogate.state(),
                Err(problem) => json!({"problem": problem}),
            };
            json!({"response": name, "state": state})
        });
        let states: Vec<_> = states.collect();
        self.directory.write_json("surrogates.json", &json!({"format": 1, "surrogates": states}))
    }
}

/// Returns the columns of `finalists.parquet`: one row per design of the finalists and point of the sweep. `design` is
/// null if the search did not evaluate the design.
pub fn finalist_columns(study: &Study) -> Vec<Column<(FinalistRole, Answer)>> {
    let mut list = Columns::<(FinalistRole, Answer)>::new();
    list.word("role", |row| row.0.name()).meaning(
        "what the design is: finalist, best, pareto or compare_with; all roles but pareto and \
         finalist have runs of their own",
    );
    list.extend(answer_columns(study, |row: &(FinalistRole, Answer)| &row.1));
    list.finish()
}

/// Returns the columns of `pareto.parquet`: one row per design of the search's Pareto front, with the estimates of its
/// final runs over all points of the sweep.
pub fn pareto_columns(study: &Study, optimization: &Optimization) -> Vec<Column<Finalist>> {
    let mut list = Columns::<Finalist>::new();
    list.count("design", |row| row.design).meaning("number of the design in the search");
    add_variables(&mut list, study, |row: &Finalist| row.values.as_slice());
    for (place, quantity) in Goal::new(study, optimization).quantities.iter().enumerate() {
        let response = &study.responses()[quantity.response];
        let (name, unit) = (&response.name, response.unit());
        // A response has several quantities if different points are its worst.
        if !list.contains(name) {
            let meaning = format!("{} over all points", response.meaning());
            add_estimate(&mut list, name, unit, &meaning, move |row: &Finalist| {
                row.estimates.get(place)
            });
        }
    }
    list.boolean("met", |row| row.met).meaning("whether all limits are met");
    list.boolean("on_front", |row| row.on_front)
        .meaning("whether it is also on the Pareto front of these runs");
    list.finish()
}

/// Returns the columns of `sensitivities.parquet`: one row per response and variable.
pub fn sensitivity_columns() -> Vec<Column<Sensitivity>> {
    let mut list = Columns::<Sensitivity>::new();
    list.text("response", |row| row.response.clone()).meaning("name of the response");
    list.text("variable", |row| row.variable.clone()).meaning("name of the variable");
    list.word("source", |row| row.source.name()).meaning(
        "where responses were taken from: runs of new designs, or the search's surrogates",
    );
    list.count("samples", |row| row.samples).meaning("base samples");
    let mut index = |name: &str, meaning: &str, of: fn(&Sensitivity) -> Option<SobolIndex>| {
        list.number(name, "1", move |row| Some(of(row)?.value)).meaning(meaning);
        list.number(format!("{name}_low"), "1", move |row| of(row)?.low)
            .meaning("lower end of its 95 % interval, null from surrogates");
        list.number(format!("{name}_high"), "1", move |row| of(row)?.high)
            .meaning("upper end of its 95 % interval, null from surrogates");
    };
    let alone = "fraction of the variance that the variable alone explains";
    index("first_order", alone, |row| row.first_order);
    let remaining = "fraction of the variance that remains if all other variables are known";
    index("total", remaining, |row| row.total);
    list.text("reason", |row| row.reason.clone())
        .meaning("why indices or their intervals are missing");
    list.finish()
}
