//! The results of a search, read from its directory.

use std::path::Path;

use serde_json::Value;

use crate::analysis::Estimate;
use crate::engine::CommandError;
use crate::optimize::{Evaluation, FinalistRole, Goal, read_evaluations};
use crate::study::{Optimization, Study, Unit, Variable};
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
    pub sensitivities: Vec<SensitivityFacts>,
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

/// The Sobol' indices of a variable for a response: value, lower and upper end.
#[derive(Clone, Debug, PartialEq)]
pub struct SensitivityFacts {
    /// Name of the response.
    pub response: String,
    /// Name of the variable.
    pub variable: String,
    /// Where the responses come from: `surrogates` or `runs`.
    pub source: String,
    /// First-order index.
    pub first_order: [Option<f64>; 3],
    /// Total index.
    pub total: [Option<f64>; 3],
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
        let optimum = match list.read_file(directory, "optimum.json")? {
            Some(bytes) => Some(serde_json::from_slice(&bytes).map_err(|error| {
                refuse(format!("optimum.json beside it, listed in {FILES}: {error}"))
            })?),
            None => None,
        };
        let goal = Goal::new(&study, &optimization);
        let mut data = OptimumData {
            study,
            optimization,
            goal,
            evaluations,
            optimum,
            best: Vec::new(),
            front: Vec::new(),
            sensitivities: Vec::new(),
        };
        // Without optimum.json the other tables are of an unfinished end of the search.
        if data.optimum.is_some() {
            let open = |name: &str| match list.has(&format!("{name}.parquet")) {
                true => Table::of_itself(directory, name).map(|(table, _)| Some(table)),
                false => Ok(None),
            };
            if let Some(table) = open("finalists")? {
                data.best = data.read_best(&table)?;
            }
            if let Some(table) = open("pareto")? {
                data.front = data.read_front(&table)?;
            }
            if let Some(table) = open("sensitivities")? {
                data.sensitivities = read_sensitivities(&table)?;
            }
        }
        Ok(data)
    }

    /// Returns name and unit of a response.
    pub fn response(&self, index: usize) -> (&str, Unit) {
        let response = self.study.responses().get(index);
        let (name, unit) =
            response.map_or(("", "1"), |response| (&*response.name, response.unit()));
        (name, self.study.units().of_response(unit))
    }

    /// Returns the name of a variable in words, without its unit.
    pub fn variable_in_words(&self, name: &str) -> String {
        let variable = self.study.variables().iter().find(|variable| variable.name() == name);
        variable.map_or_else(|| name.to_owned(), Variable::short_name).replace('_', " ")
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

fn read_sensitivities(table: &Table) -> Result<Vec<SensitivityFacts>, TableError> {
    let facts = |row: &Row<'_>| {
        let text = |name: &str| row.text(name).unwrap_or_default();
        let index =
            |name: &str| ["", "_low", "_high"].map(|end| row.number(&format!("{name}{end}")));
        SensitivityFacts {
            response: text("response"),
            variable: text("variable"),
            source: text("source"),
            first_order: index("first_order"),
            total: index("total"),
        }
    };
    table.read_rows(facts)?.collect()
}
