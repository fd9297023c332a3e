//! The output directory with the results of an inference, and the columns of its tables.

use std::path::Path;

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::fit_test::{SeenRun, SiteFit};
use super::inference::{Inference, Inferred};
use super::site::Site;
use crate::engine::{CommandError, ContinuedDirectory};
use crate::responses::columns::add_variables;
use crate::sanitize::shell_word;
use crate::study::{DesignValue, MeasuredRun, Study};
use crate::table::column::{Column, Columns};
use crate::table::{PointKey, add_point, hexadecimal, provenance_with};

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

/// A row of `parameter_sets.parquet`: number, values, and log-likelihood of a parameter set with its
/// standard error.
type SetRow = (u64, Vec<DesignValue>, [f64; 2]);

/// Returns the columns of `posterior.parquet`: one row per sample.
pub fn posterior_columns(study: &Study) -> Vec<Column<Vec<f64>>> {
    let mut list = Columns::<Vec<f64>>::new();
    for (index, parameter) in study.variables().iter().enumerate() {
        let value = move |row: &Vec<f64>| row.get(index).copied();
        list.number(parameter.name(), parameter.unit().unwrap_or("1"), value)
            .meaning(parameter.meaning());
    }
    list.finish()
}

/// Returns the columns of `parameter_sets.parquet`: one row per parameter set.
pub fn evaluated_set_columns(study: &Study, start_designs: u64) -> Vec<Column<SetRow>> {
    let mut list = Columns::<SetRow>::new();
    list.count("parameter_set", |row| row.0).meaning("number of the parameter set, from 0");
    list.word("origin", move |row| if row.0 < start_designs { "prior" } else { "posterior" })
        .meaning("whether the set fills the prior, or lies where the posterior is");
    add_variables(&mut list, study, |row: &SetRow| row.1.as_slice());
    list.number("log_likelihood", "1", |row| row.2[0])
        .meaning("log-likelihood of all measured runs, up to a constant");
    list.number("log_likelihood_std_error", "1", |row| row.2[1])
        .meaning("its standard error, which comes from the number of simulated runs");
    list.finish()
}

/// Returns the columns of `fit.parquet`: one row per point and stage with measured runs.
pub fn fit_columns(study: &Study) -> Vec<Column<SiteFit>> {
    let mut list = Columns::<SiteFit>::new();
    add_point(&mut list, study, |row: &SiteFit| &row.point);
    list.count("stage", |row| row.stage).meaning("number of the stage, from 1");
    list.count("measured_rests", |row| row.measured[0]).meaning("measured runs that rest");
    list.count("measured_moving", |row| row.measured[1]).meaning("measured runs that move");
    list.count("tested_runs", |row| row.tested)
        .meaning("measured runs that the test compares: all, or a random sample of them");
    list.number("predicted_rest_fraction", "1", |row| row.predicted_rest_fraction)
        .meaning("fraction of the runs of the posterior predictive distribution that rest");
    list.number("p_positions", "1", |row| row.p_positions).meaning(
        "probability of an energy distance between measured and predicted positions that is at least as large",
    );
    list.number("p_neighbours", "1", |row| row.p_neighbours)
        .meaning("the same for the angles between neighbouring balls; null for one ball");
    list.number("p_value", "1", |row| row.p_value())
        .meaning("the smaller of both probabilities, corrected for two tests (Bonferroni)");
    list.finish()
}

/// A row of `positions.parquet`.
#[derive(Clone, Debug, PartialEq)]
pub struct PositionRow {
    point: PointKey,
    stage: u64,
    is_measured: bool,
    seen: SeenRun,
}

/// Returns the rows of `positions.parquet`: at each site the measured runs, then the predicted ones.
pub fn position_rows<'a>(
    sites: &'a [Site],
    fits: &'a [SiteFit],
) -> impl Iterator<Item = PositionRow> + 'a {
    let of_fit = |fit: &'a SiteFit| {
        let here =
            move |site: &&Site| (site.point_id, site.stage) == (fit.point.point_id, fit.stage);
        let rests = sites.iter().filter(here).flat_map(|site| &site.rests);
        let rests = rests.map(|rest| Some(rest.angles.clone()));
        let measured = rests.chain((0..fit.measured[1]).map(|_| None)).map(|seen| (true, seen));
        let predicted = fit.predicted.iter().map(|seen| (false, seen.clone()));
        measured.chain(predicted).map(|(is_measured, seen)| PositionRow {
            point: fit.point.clone(),
            stage: fit.stage,
            is_measured,
            seen,
        })
    };
    fits.iter().flat_map(of_fit)
}

/// Returns the columns of `positions.parquet`: one row per measured run, and per run of the predictive distribution.
pub fn position_columns(study: &Study) -> Vec<Column<PositionRow>> {
    let mut list = Columns::<PositionRow>::new();
    list.word("source", |row| if row.is_measured { "measured" } else { "predicted" }).meaning(
        "a measured run, or a run of the posterior predictive distribution with the error of the measurements",
    );
    add_point(&mut list, study, |row: &PositionRow| &row.point);
    list.count("stage", |row| row.stage).meaning("number of the stage, from 1");
    list.boolean("at_rest", |row| row.seen.is_some()).meaning("whether the balls rest");
    for ball in 0..study.model().angle_contacts().len() {
        let angle = move |row: &PositionRow| row.seen.as_ref()?.get(ball).copied();
        list.number(format!("beta_{}_rad", ball + 1), "rad", angle)
            .meaning("angle of a ball from the imbalance; balls are not told apart");
    }
    list.finish()
}
