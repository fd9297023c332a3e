//! A whole inference into a directory, with progress.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use serde_json::{Value, json};

use super::in_words::{identification_json, result_in_words, warnings};
use super::inference::{Inference, Inferred, infer};
use super::parameter_set::SetFiles;
use super::result_files::{ResultFiles, SIMULATIONS};
use super::set_densities::check_memory;
use super::site::sites;
use crate::engine::{CommandError, Parts, Planned, Progress, ProgressDisplay, WorkerPool};
use crate::study::{Identification, MeasuredRun, Study};

/// An inference: the study, where its results go, and how it is computed.
pub struct Identify<'a> {
    /// The study as it is written.
    pub study: &'a Study,
    /// The file of the study, for messages.
    pub file: &'a Path,
    /// The file of the measurements, for messages.
    pub measured: &'a Path,
    /// The directory of the results.
    pub directory: &'a Path,
    /// The directory of the ends of simulated runs; by default, a directory in that of the results.
    pub simulations: Option<PathBuf>,
    /// The workers that compute the runs.
    pub workers: &'a WorkerPool,
    /// Stops the inference when it becomes true.
    pub stop: &'a AtomicBool,
    /// How progress is shown.
    pub show: ProgressDisplay,
}

/// The result of an inference, which is also in its directory.
pub struct Identified {
    /// The content of `identification.json`.
    pub summary: Value,
    /// The result in words.
    pub in_words: String,
    /// Warnings with key, value and remedy, which the content of `identification.json` has too.
    pub warnings: Vec<String>,
    /// The number of failed runs.
    pub failed_runs: u64,
}

impl Identify<'_> {
    /// Returns the study with the parameters as variables, and what is to be inferred. Measurements belong to that study.
    ///
    /// # Errors
    /// Returns an error if the study has no `identify`, or cannot have it.
    pub fn study_of(study: &Study, file: &Path) -> Result<(Study, Identification), CommandError> {
        let file = file.display();
        if study.precision().is_some() {
            let allowed =
                "a study without `precision`, so that all parameter sets have the same runs";
            return Err(CommandError::Usage(format!(
                "{file}: parameter sets would have different numbers of runs\n  found:   `precision`\n  allowed: {allowed}"
            )));
        }
        if study.model().angle_contacts().is_empty() {
            return Err(CommandError::Usage(format!(
                "{file}: `identify` needs angles at which like bodies rest\n  found:   kind: {}\n  allowed: a machine with balls, \
                 such as ball_balancer and rotor_balancer",
                study.model().kind().name
            )));
        }
        study.for_identification().ok_or_else(|| {
            let allowed = "parameters in the study, such as identify: {parameters: {friction_coefficient: {from: \
                           0.001, to: 0.006}}}";
            CommandError::Usage(format!("{file}: `identify` is missing\n  allowed: {allowed}"))
        })
    }

    /// Infers the parameters from measurements, which `read` reads for the study of the inference; returns `None` if it was
    /// stopped.
    ///
    /// # Errors
    /// Returns an error if the study or the measurements cannot be used, if a directory holds other files, or if a table
    /// cannot be written.
    pub fn run(
        &self,
        read: impl FnOnce(&Study) -> Result<Vec<MeasuredRun>, CommandError>,
    ) -> Result<Option<Identified>, CommandError> {
        let (study, identification) = Self::study_of(self.study, self.file)?;
        let measured = read(&study)?;
        let refused =
            |problem| CommandError::Usage(format!("{}: {problem}", self.measured.display()));
        let sites = sites(&study, &measured).map_err(refused)?;
        check_memory(&sites, identification.designs).map_err(refused)?;
        let mut results = ResultFiles::open(&study, &measured, self.directory)?;
        let usual = || self.directory.join(SIMULATIONS);
        let simulations = self.simulations.clone().unwrap_or_else(usual);
        let mut sets = SetFiles::open(&study, &simulations)?;
        let Identify { workers, stop, .. } = *self;
        let inference = Inference {
            study: &study,
            identification: &identification,
            sites: &sites,
            workers,
            stop,
        };
        let Some(inferred) = self.with_progress(&inference, &mut sets)? else { return Ok(None) };
        let summary = identification_json(&inference, &inferred, &results.measured);
        results.write(&inference, &inferred, &summary)?;
        let in_words = result_in_words(&inference, &inferred);
        let warnings = warnings(&inference, &inferred);
        Ok(Some(Identified { summary, in_words, warnings, failed_runs: inferred.runs[1] }))
    }

    /// Infers the parameters and shows the progress.
    fn with_progress(
        &self,
        inference: &Inference,
        sets: &mut SetFiles,
    ) -> Result<Option<Inferred>, CommandError> {
        let Inference { study, identification, .. } = *inference;
        let designs = identification.designs;
        let runs = designs.saturating_mul(study.run_count());
        let parts = Parts::ParameterSets(designs);
        let planned = Planned { study: study.name(), runs, at_most: true, parts };
        let progress = Progress::begin(planned, self.show.clone());
        progress.keep_drawing();
        let finished = |label| progress.finished(label);
        let evaluated = |number| {
            progress.point(|| format!("parameter set {number} of {designs}"), || json!({}));
        };
        let impossible = |problem| {
            let file = self.file.display();
            let allowed = "parameters on which the measured positions of rest depend";
            CommandError::Usage(format!("{file}: `identify`: {problem}\n  allowed: {allowed}"))
        };
        let inferred = infer(inference, sets, &finished, evaluated, impossible);
        progress.close();
        inferred
    }
}
