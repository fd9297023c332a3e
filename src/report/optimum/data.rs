//! The results of a search, read from its directory.

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use crate::analysis::Estimate;
use crate::engine::CommandError;
use crate::optimize::{Evaluation, FinalistRole, Goal, Sensitivity, read_evaluations};
use crate::study::{Optimization, Study, Unit};
use crate::table::{FILES, FileList, Row, Table, TableError};

/// The results of a search.
#[derive(Clone, Debug)]
pub struct OptimumData {
    /// The study.
    pub study: Study,
    /// Its objectives, limits and effort.
    pub optimization: Optimization,
    /// Objectives and limits as numbers.
    pub goal: Goal,
    /// The evaluated designs.
    pub evaluations: Vec<Evaluation>,
    /// `optimum.json`; `None` before the search has ended.
    pub optimum: Option<Value>,
    /// The number of each point, and the responses of the final runs of the best design there.
    pub best: Vec<(u64, Vec<Estimate>)>,
    /// With two objectives: the designs of the search's Pareto front, with their final runs.
    pub front: Vec<FrontDesign>,
    /// Sobol' indices.
    pub sensitivities: Vec<Sensitivity>,
}

/// A design of the Pareto front.
#[derive(Clone, Debug, PartialEq)]
pub struct FrontDesign {
    /// Number of the design in the search.
    pub design: Option<u64>,
    /// One estimate per objective, over all points.
    pub objectives: Vec<Estimate>,
    /// Whether the final runs meet all limits.
    pub met: bool,
    /// Whether the design is also on the front of the final runs.
    pub on_front: bool,
}

impl OptimumData {
    /// Reads the directory of a search, finished or not. The study is the one in the metadata of `evaluations.parquet`.
    ///
    /// # Errors
    /// Returns an error if a file is missing or has been changed, or if the study has no `optimize`.
    pub fn read(directory: &Path) -> Result<Self, CommandError> {
        let (_, about) = Table::of_itself(directory, "evaluations")?;
        let path = directory.join("evaluations.parquet");
        let refuse = |problem: String| {
            CommandError::Usage(format!(
                "{}: {problem}\n  allowed: a table that this version of `stickslip optimize` has written",
                path.display()
            ))
        };
        let text = about["study_yaml"].as_str().unwrap_or_default().to_owned();
        let study = Study::parse(Path::new("study.yaml"), text);
        let study = study.map_err(|error| refuse(format!("the study in its metadata: {error}")))?;
        let Some(optimization) = study.optimization().cloned() else {
            return Err(refuse("the study in its metadata has no `optimize`".to_owned()));
        };
        let evaluations = read_evaluations(&study, directory)?;
        let list = FileList::read(directory)?.unwrap_or_default();
        let unreadable = |error: serde_json::Error| {
            refuse(format!("optimum.json beside it, listed in {FILES}: {error}"))
        };
        let optimum = list.read_file(directory, "optimum.json")?;
        let optimum = optimum.map(|bytes| serde_json::from_slice::<Value>(&bytes)).transpose();
        let optimum = optimum.map_err(unreadable)?;
        let sensitivities = optimum.as_ref().map(|json| Vec::deserialize(&json["sensitivities"]));
        let sensitivities = sensitivities.transpose().map_err(unreadable)?.unwrap_or_default();
        let goal = Goal::new(&study, &optimization);
        let mut data = OptimumData {
            study,
            optimization,
            goal,
            evaluations,
            optimum,
            best: Vec::new(),
            front: Vec::new(),
            sensitivities,
        };
        // Without optimum.json the other tables are of an unfinished end of the search.
        if data.optimum.is_some() {
            let open = |name: &str| match list.has(&format!("{name}.parquet")) {
                true => Table::of_itself(directory, name).map(|(table, _)| Some(table)),
                false => Ok(None),
            };
            // The indices are those of optimum.json. A damaged table of them is refused, too.
            open("sensitivities")?;
            if let Some(table) = open("finalists")? {
                data.best = data.read_best(&table)?;
            }
            if let Some(table) = open("pareto")? {
                data.front = data.read_front(&table)?;
            }
        }
        Ok(data)
    }

    /// Returns name and unit of a response.
    pub fn response(&self, index: usize) -> (&str, Unit) {
        let response = &self.study.responses()[index];
        (&*response.name, self.study.units().of_response(response.unit()))
    }

    /// Returns the name of a variable in words, without its unit.
    pub fn variable_in_words(&self, name: &str) -> String {
        let variable = self.study.variables().iter().find(|variable| variable.name() == name);
        variable.map_or_else(|| name.to_owned(), |variable| variable.short_name()).replace('_', " ")
    }

    /// Returns the largest total index of a response, with its variable in words.
    pub fn largest_total(&self, response: &str) -> Option<(String, f64)> {
        let rows = self.sensitivities.iter().filter(|row| row.response == response);
        let known = rows.filter_map(|row| Some((row, row.total?.value)));
        let (row, total) = known.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        Some((self.variable_in_words(&row.variable), total))
    }

    /// Returns the values of the goal's quantities of a design.
    pub fn values(&self, evaluation: &Evaluation) -> Vec<Option<f64>> {
        let estimates = self.goal.estimates(&evaluation.answers);
        estimates.iter().map(|estimate| estimate.value).collect()
    }

    /// Returns the final responses of a design in `optimum.json`, `best` or `compare_with`.
    pub fn design(&self, role: &str) -> Option<&Value> {
        self.optimum.as_ref().and_then(|optimum| optimum.get(role)).filter(|json| json.is_object())
    }

    fn read_best(&self, table: &Table) -> Result<Vec<(u64, Vec<Estimate>)>, TableError> {
        let mut best = Vec::new();
        table.for_each(|row| {
            let (role, point_id) = (row.text("role"), row.count("point_id").unwrap_or(0));
            let responses = self.study.responses().iter();
            let estimates = responses.map(|response| row.estimate(&response.name)).collect();
            if role.as_deref() == Some(FinalistRole::Best.name()) {
                best.push((point_id, estimates));
            }
        })?;
        Ok(best)
    }

    fn read_front(&self, table: &Table) -> Result<Vec<FrontDesign>, TableError> {
        let objectives = &self.optimization.objectives;
        let facts = |row: &Row<'_>| FrontDesign {
            design: row.count("design"),
            objectives: objectives
                .iter()
                .map(|objective| row.estimate(self.response(objective.response).0))
                .collect(),
            met: row.truth("met") == Some(true),
            on_front: row.truth("on_front") == Some(true),
        };
        table.read_rows(facts)?.collect()
    }
}
