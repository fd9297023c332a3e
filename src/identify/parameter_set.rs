//! A parameter set with the ends of all its runs, and the directory with the files of parameter sets.
//!
//! A file is named by the values of the parameters: every inference of the same study finds the runs that it needs,
//! whatever the measurements are.

use std::path::Path;

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::site::{BallsEnd, SimulatedEnd};
use crate::engine::{CommandError, ContinuedDirectory};
use crate::responses::design_json;
use crate::study::{DesignValue, Study};
use crate::table::column::{Column, Columns};
use crate::table::{Row, Table, TableError, provenance_with, sha256};

/// A parameter set with the ends of all its runs.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterSet {
    /// One value per parameter.
    pub values: Vec<DesignValue>,
    /// The ends of all stages of all runs, in the order of runs and stages.
    pub ends: Vec<SimulatedEnd>,
}

/// Returns the name of the table with the runs of a parameter set, without `.parquet`.
pub fn set_name(study: &Study, values: &[DesignValue]) -> String {
    format!("set-{}", &sha256(set_facts(study, values).to_string())[..16])
}

/// Returns what determines the runs of a parameter set besides the study's hash.
pub fn set_facts(study: &Study, values: &[DesignValue]) -> Value {
    json!({ "parameters": design_json(study, values), "seed": set_seed(study, values) })
}

/// Returns the master seed of the runs of a parameter set, which depends on its values.
pub fn set_seed(study: &Study, values: &[DesignValue]) -> u64 {
    let digest = Sha256::digest(design_json(study, values).to_string());
    let number = digest.iter().take(8).fold(0, |number, byte| (number << 8) | u64::from(*byte));
    study.derived_seed("identify set", number)
}

/// Returns the columns of the table of a parameter set: one row per run and stage.
pub fn set_columns(study: &Study) -> Vec<Column<SimulatedEnd>> {
    let mut list = Columns::<SimulatedEnd>::new();
    list.count("run_id", |row| row.run_id).meaning("number of the run in the study, from 0");
    list.count("point_id", |row| row.point_id).meaning("number of the point of the sweep");
    list.count("stage", |row| row.stage).meaning("number of the stage in the run, from 1");
    list.word("end", |row| row.end.name())
        .meaning("rest, moving, or unknown if the run failed or the speed changes");
    for ball in 0..study.model().angle_contacts().len() {
        let angle = move |row: &SimulatedEnd| match &row.end {
            BallsEnd::Rest { angles, .. } => angles.get(ball).copied(),
            BallsEnd::Moving | BallsEnd::Unknown => None,
        };
        list.number(format!("beta_{}_rad", ball + 1), "rad", angle)
            .meaning("angle of the ball from the imbalance at rest");
    }
    for ball in 0..study.model().angle_contacts().len() {
        let group = move |row: &SimulatedEnd| match &row.end {
            BallsEnd::Rest { groups, .. } => groups.get(ball).map(|group| u64::from(*group)),
            BallsEnd::Moving | BallsEnd::Unknown => None,
        };
        list.count(format!("group_{}", ball + 1), group)
            .meaning("the group of the ball; balls of one group rest in touch");
    }
    list.finish()
}

/// Reads the runs of a parameter set from a directory.
///
/// # Errors
/// Returns an error if the table was changed or belongs to another study.
pub fn read_parameter_set(
    study: &Study,
    directory: &Path,
    values: &[DesignValue],
) -> Result<ParameterSet, TableError> {
    let name = set_name(study, values);
    let (table, about) = Table::of_itself(directory, &name)?;
    let other = || {
        let fault = crate::tabular::Fault::new(
            "runs of another study",
            "another study or other parameters in the metadata",
            "another directory for the simulated runs, with --simulations DIR",
        );
        TableError::new(&directory.join(format!("{name}.parquet")), None, fault)
    };
    if about["study_hash"] != study.hash() || about["options"] != set_facts(study, values) {
        return Err(other());
    }
    let balls = study.model().angle_contacts().len();
    let ends = table.read_rows(|row| read_end(row, balls))?;
    let ends = ends.map(|end| end?.ok_or_else(other)).collect::<Result<_, _>>()?;
    Ok(ParameterSet { values: values.to_vec(), ends })
}

/// Returns the end in a row; `None` if it is none.
fn read_end(row: &Row<'_>, balls: usize) -> Option<SimulatedEnd> {
    let ids = ["run_id", "point_id", "stage"].map(|name| row.count(name));
    let angles = (1..=balls).map(|ball| row.number(&format!("beta_{ball}_rad")));
    let angles: Vec<Option<f64>> = angles.collect();
    let groups = (1..=balls).map(|ball| row.count(&format!("group_{ball}")));
    let groups: Vec<Option<u64>> = groups.collect();
    let end = match row.text("end")?.as_str() {
        "rest" => BallsEnd::Rest {
            angles: angles.into_iter().collect::<Option<_>>()?,
            groups: groups
                .into_iter()
                .map(|group| u8::try_from(group?).ok())
                .collect::<Option<_>>()?,
        },
        "moving" => BallsEnd::Moving,
        "unknown" => BallsEnd::Unknown,
        _ => return None,
    };
    let [run_id, point_id, stage] = ids;
    Some(SimulatedEnd { run_id: run_id?, point_id: point_id?, stage: stage?, end })
}

/// The files with the ends of simulated runs.
pub(super) struct SetFiles<'a> {
    study: &'a Study,
    directory: ContinuedDirectory<'a>,
}

impl<'a> SetFiles<'a> {
    pub fn open(study: &'a Study, path: &'a Path) -> Result<Self, CommandError> {
        let is_set = |name: &str| {
            let digits = name.strip_prefix("set-").and_then(|rest| rest.strip_suffix(".parquet"));
            digits.is_some_and(|digits| {
                digits.len() == 16 && digits.bytes().all(|byte| byte.is_ascii_hexdigit())
            })
        };
        let reason = "this directory is not empty and holds no simulated runs";
        let directory = ContinuedDirectory::open(path, reason, is_set)?;
        Ok(SetFiles { study, directory })
    }

    /// Returns the runs of a parameter set, if they have been computed before.
    pub(super) fn find(
        &self,
        values: &[DesignValue],
    ) -> Result<Option<ParameterSet>, CommandError> {
        let name = format!("{}.parquet", set_name(self.study, values));
        if self.directory.changed.contains(&name) || !self.directory.list.has(&name) {
            return Ok(None);
        }
        let read = read_parameter_set(self.study, self.directory.path, values);
        read.map(Some).map_err(|error| CommandError::Usage(error.to_string()))
    }

    /// Keeps the runs of a parameter set.
    pub(super) fn keep(&mut self, set: &ParameterSet) -> Result<(), CommandError> {
        let (name, facts) = (set_name(self.study, &set.values), set_facts(self.study, &set.values));
        let about = provenance_with(self.study, &name, &facts);
        self.directory.write(&name, &about, set_columns(self.study), set.ends.clone())?;
        Ok(())
    }
}
