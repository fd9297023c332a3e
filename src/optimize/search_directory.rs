//! The output directory of a search, which the same search continues.

use std::path::Path;

use serde_json::json;

use super::evaluations::{Evaluation, evaluation_columns, search_facts};
use super::finalists::{FinalistRole, Finalists};
use super::sensitivity::QuantitySurrogate;
use super::tables::{finalist_columns, pareto_columns};
use crate::engine::{CommandError, ContinuedDirectory};
use crate::study::{Optimization, Study};
use crate::table::column::Column;
use crate::table::{WriteError, provenance_with};

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

    pub fn write_finals(&mut self, finalists: &Finalists) -> Result<(), WriteError> {
        let rows = finalists
            .all
            .iter()
            .flat_map(|design| design.answers.iter().map(|answer| (design.role, answer.clone())));
        self.write("finalists", finalist_columns(self.study), rows)?;
        if self.optimization.objectives.len() < 2 {
            return Ok(());
        }
        let front =
            finalists.all.iter().filter(|finalist| finalist.role == FinalistRole::Pareto).cloned();
        self.write("pareto", pareto_columns(self.study, self.optimization), front)
    }

    pub fn write_surrogates(&mut self, all: &[QuantitySurrogate]) -> Result<(), CommandError> {
        let states = all.iter().filter_map(|(response, surrogate)| {
            let name = &self.study.responses().get(*response)?.name;
            let state = match surrogate {
                Ok(surrogate) => surrogate.state(),
                Err(problem) => json!({"problem": problem}),
            };
            Some(json!({"response": name, "state": state}))
        });
        let states: Vec<_> = states.collect();
        self.directory.write_json("surrogates.json", &json!({"format": 1, "surrogates": states}))
    }
}
