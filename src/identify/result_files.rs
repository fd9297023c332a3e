//! The output directory with the results of an inference.

use std::path::Path;

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::inference::{Inference, Inferred};
use super::tables::{
    evaluated_set_columns, fit_columns, position_columns, position_rows, posterior_columns,
};
use crate::engine::{CommandError, ContinuedDirectory};
use crate::sanitize::shell_word;
use crate::study::{MeasuredRun, Study};
use crate::table::{hexadecimal, provenance_with};

/// The name of the directory with the ends of simulated runs.
pub(super) const SIMULATIONS: &str = "simulations";

/// The files with the results.
pub(super) struct ResultFiles<'a> {
    study: &'a Study,
    /// The hash of the measured runs.
    pub measured: String,
    directory: ContinuedDirectory<'a>,
}

/// The files of an inference.
const OWN: [&str; 6] = [
    "posterior.parquet",
    "parameter_sets.parquet",
    "fit.parquet",
    "positions.parquet",
    SUMMARY,
    SIMULATIONS,
];
const SUMMARY: &str = "identification.json";

impl<'a> ResultFiles<'a> {
    /// Opens the directory. Returns an error if it holds anything but the files of an inference, or if they are of other
    /// measurements.
    pub fn open(
        study: &'a Study,
        measured: &[MeasuredRun],
        path: &'a Path,
    ) -> Result<Self, CommandError> {
        let reason = "this directory is not empty and holds no inference";
        let directory = ContinuedDirectory::open(path, reason, |name| OWN.contains(&name))?;
        let measured = hash(measured);
        let summary = std::fs::read(path.join(SUMMARY)).ok();
        let before: Option<Value> = summary.and_then(|text| serde_json::from_slice(&text).ok());
        if let Some(before) = before
            && (before["measured_sha256"] != measured || before["study_hash"] != study.hash())
        {
            let simulations = shell_word(&path.join(SIMULATIONS));
            return Err(CommandError::Usage(format!(
                "{}: this directory holds another inference\n  found:   results of other measurements or of another \
                 study\n  allowed: another directory with --out; --simulations {simulations} uses the simulated runs of \
                 the same study again",
                path.display()
            )));
        }
        Ok(ResultFiles { study, measured, directory })
    }

    pub fn write(
        &mut self,
        inference: &Inference,
        inferred: &Inferred,
        summary: &Value,
    ) -> Result<(), CommandError> {
        let study = self.study;
        let file = study.resolved_file();
        let facts = json!({"identify": file["identify"], "measured_sha256": self.measured});
        let about = |name: &str| provenance_with(study, name, &facts);
        let directory = &mut self.directory;
        let samples = inferred.posterior.samples.iter().cloned();
        directory.write("posterior", &about("posterior"), posterior_columns(study), samples)?;
        let sets = (0..)
            .zip(&inferred.sets)
            .map(|(number, (values, likelihood))| (number, values.clone(), *likelihood));
        let columns = evaluated_set_columns(study, inference.identification.start_designs);
        directory.write("parameter_sets", &about("parameter_sets"), columns, sets)?;
        let fits = inferred.fits.iter().cloned();
        directory.write("fit", &about("fit"), fit_columns(study), fits)?;
        let positions = position_rows(inference.sites, &inferred.fits);
        directory.write("positions", &about("positions"), position_columns(study), positions)?;
        directory.write_json(SUMMARY, summary)
    }
}

/// Returns the hash of measured runs.
fn hash(measured: &[MeasuredRun]) -> String {
    let mut digest = Sha256::new();
    for run in measured {
        let MeasuredRun { point_id, stage, rest, std_dev_rad } = run;
        digest.update(format!("{point_id} {stage:?} {rest:?} {std_dev_rad:?}\n"));
    }
    hexadecimal(&digest.finalize())
}
