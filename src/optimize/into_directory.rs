//! A whole optimisation into a directory: the search, the sensitivities, and the finalists, with progress.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::{Value, json};

use super::evaluations::{DesignOrigin, Evaluation, read_evaluations};
use super::finalists::{Finalist, final_runs, finalists};
use super::goal::Goal;
use super::report::{optimum_json, result_in_words, search_line, unmet};
use super::search::{Search, SearchEnd, search};
use super::search_directory::{SearchDirectory, sensitivity_columns};
use super::sensitivity::{sensitivities, surrogates};
use crate::classification::Label;
use crate::engine::{CommandError, Parts, Planned, Progress, ProgressDisplay, WorkerPool, say};
use crate::numbers::counted;
use crate::responses::check_answerable;
use crate::study::{SensitivityFrom, Study};

/// An optimisation: the study, where its results go, and how it is computed.
pub struct Optimize<'a> {
    /// The study.
    pub study: &'a Study,
    /// The file of the study, for messages.
    pub file: &'a Path,
    /// The directory of the results, which is continued.
    pub directory: &'a Path,
    /// The workers that compute the runs.
    pub workers: &'a WorkerPool,
    /// Stops the optimisation when it becomes true.
    pub stop: &'a AtomicBool,
    /// How progress is shown.
    pub show: ProgressDisplay,
    /// Whether to print only warnings.
    pub quiet: bool,
}

/// The result of an optimisation, which is also in its directory.
pub struct Optimized {
    /// The content of `optimum.json`.
    pub summary: Value,
    /// The result in words.
    pub in_words: String,
    /// The limits that the nearest design does not meet; `None` if a design meets all limits.
    pub unmet: Option<Vec<String>>,
    /// The number of failed runs.
    pub failed_runs: u64,
}

impl Optimize<'_> {
    /// Searches for the best design; returns `None` if it was stopped.
    ///
    /// # Errors
    /// Returns an error if the study has no `optimize`, if the directory holds other files, if a table cannot be written, or
    /// if an objective does not depend on the design.
    pub fn run(&self) -> Result<Option<Optimized>, CommandError> {
        let Optimize { study, directory, workers, stop, .. } = *self;
        let file = self.file.display();
        let Some(optimization) = study.optimization() else {
            let allowed = "an objective in the study, such as optimize: {minimize: vibration}";
            return Err(CommandError::Usage(format!(
                "{file}: `optimize` is missing\n  allowed: {allowed}"
            )));
        };
        check_answerable(study, self.file).map_err(CommandError::Usage)?;
        let mut results = SearchDirectory::new(study, optimization, directory)?;
        let mut evaluations = read_evaluations(study, directory)
            .map_err(|error| CommandError::Usage(error.to_string()))?;
        for name in &results.directory.changed {
            say(&format!("{name} has been changed since it was written; writing it anew"));
        }
        let goal = Goal::new(study, optimization);
        let what = Search { study, optimization, goal, workers, stop };
        if !evaluations.is_empty() {
            let designs = counted(evaluations.len(), "design");
            self.report(&format!("continuing after {designs} in {}", directory.display()));
        }
        // The two parts differ in speed, so that each has its own progress.
        let mut end = SearchEnd::Finished;
        for until in [optimization.start_designs.min(optimization.designs), optimization.designs] {
            if end == SearchEnd::Finished {
                let ended = self.search_until(&what, &mut evaluations, until, &mut results)?;
                let Some(ended) = ended else { return Ok(None) };
                end = ended;
            }
        }
        if end == SearchEnd::NoMoreDesigns {
            self.report(end.in_words());
        }
        let instead = evaluations
            .iter()
            .filter(|evaluation| evaluation.origin == DesignOrigin::SpaceFillingInstead)
            .count();
        if instead > 0 {
            let all = evaluations.len();
            self.report(&format!(
                "{instead} of {all} designs are space-filling: the surrogates proposed no new design"
            ));
        }
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let Some(surrogates) = surrogates(&what, &evaluations) else { return Ok(None) };
        results.write_surrogates(&surrogates)?;
        let Some(sensitivities) = self.with_progress(sensitivity_runs(&what), |finished| {
            sensitivities(&what, &surrogates, finished)
        }) else {
            return Ok(None);
        };
        results.write("sensitivities", sensitivity_columns(), sensitivities.clone())?;
        let Some(finalists) = self
            .with_progress(final_runs(&what), |finished| finalists(&what, &evaluations, finished))
        else {
            return Ok(None);
        };
        results.write_finals(&finalists)?;
        let summary = optimum_json(&what, end, &evaluations, &finalists, &sensitivities);
        results.directory.write_json("optimum.json", &summary)?;
        Ok(Some(Optimized {
            summary,
            in_words: result_in_words(&what, &finalists),
            unmet: unmet(&what, &evaluations, &finalists),
            failed_runs: failed_runs(&evaluations, &finalists),
        }))
    }

    fn report(&self, text: &str) {
        if !self.quiet {
            say(text);
        }
    }

    /// Continues the search up to a number of designs and shows its progress.
    fn search_until(
        &self,
        what: &Search,
        evaluations: &mut Vec<Evaluation>,
        until: u64,
        results: &mut SearchDirectory,
    ) -> Result<Option<SearchEnd>, CommandError> {
        let missing = until.saturating_sub(evaluations.len() as u64);
        if missing == 0 {
            return Ok(Some(SearchEnd::Finished));
        }
        let runs = missing.saturating_mul(what.study.most_runs_of_a_design());
        let progress = Progress::begin(self.planned(runs, missing), self.show.clone());
        progress.keep_drawing();
        let finished = |label| progress.finished(label);
        let end = search(what, self.file, evaluations, until, &finished, |evaluations| {
            results.remove_ends();
            results.write_evaluations(evaluations)?;
            progress.point(|| search_line(what, evaluations), || json!({}));
            Ok(())
        });
        progress.close();
        end
    }

    /// Does work of at most `runs` runs and shows its progress.
    fn with_progress<T>(
        &self,
        runs: u64,
        work: impl FnOnce(&(dyn Fn(Label) + Sync)) -> Option<T>,
    ) -> Option<T> {
        if runs == 0 {
            return work(&|_| {});
        }
        // The parts of this work do not report that they have finished.
        Progress::during(self.planned(runs, 0), self.show.clone(), work)
    }

    fn planned(&self, runs: u64, designs: u64) -> Planned<'_> {
        Planned { study: self.study.name(), runs, at_most: true, parts: Parts::Designs(designs) }
    }
}

fn failed_runs(evaluations: &[Evaluation], finalists: &[Finalist]) -> u64 {
    let of_search = evaluations.iter().flat_map(|evaluation| &evaluation.answers);
    let of_finals = finalists.iter().flat_map(|finalist| &finalist.answers);
    of_search.chain(of_finals).map(|answer| answer.counts.of(Label::Failed)).sum()
}

/// Returns the number of runs for the Sobol' indices.
fn sensitivity_runs(what: &Search) -> u64 {
    let Search { study, optimization, .. } = what;
    match optimization.sensitivity_from {
        SensitivityFrom::Surrogates => 0,
        SensitivityFrom::Runs => {
            let designs = optimization.sensitivity_samples * (study.variables().len() as u64 + 2);
            designs.saturating_mul(study.most_runs_of_a_design())
        }
    }
}
