//! The output directory with the ends of simulated runs, which inferences can share.

use std::path::Path;

use super::parameter_set::{ParameterSet, read_parameter_set, set_columns, set_facts, set_name};
use crate::engine::{CommandError, ContinuedDirectory};
use crate::study::{DesignValue, Study};
use crate::table::provenance_with;

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
}

impl SetFiles<'_> {
    /// Returns the runs of a parameter set, if they have been computed before.
    pub(super) fn find(
        &mut self,
        values: &[DesignValue],
    ) -> Result<Option<ParameterSet>, CommandError> {
        let name = format!("{}.parquet", set_name(self.study, values));
        if self.directory.changed.contains(&name) || !self.directory.list.has(&name) {
            return Ok(None);
        }
        read_parameter_set(self.study, self.directory.path, values)
            .map_err(|error| CommandError::Usage(error.to_string()))
    }

    /// Keeps the runs of a parameter set.
    pub(super) fn keep(&mut self, set: &ParameterSet) -> Result<(), CommandError> {
        let (name, facts) = (set_name(self.study, &set.values), set_facts(self.study, &set.values));
        let about = provenance_with(self.study, &name, &facts);
        self.directory.write(&name, &about, set_columns(self.study), set.ends.clone())?;
        Ok(())
    }
}
