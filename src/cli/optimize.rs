//! `stickslip optimize`: searches for the best design.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use clap::Args;
use serde_json::json;

use super::arguments::{StudyArgument, ThreadsArgument};
use super::continued_directory::ContinuedDirectory;
use super::exit::{CliError, End};
use super::output::{print, print_json};
use crate::classification::Label;
use crate::counted::counted;
use crate::engine::{Parts, Planned, Progress, Show, say, stop_on_signals};
use crate::optimize::{
    Evaluation, FinalistRole, Finalists, Origin, QuantitySurrogate, Search, SearchEnd,
    evaluation_columns, final_runs, finalist_columns, finalists, nearest_unmet, optimum_json,
    pareto_columns, read_evaluations, result_in_words, search, search_facts, search_line,
    sensitivities, sensitivity_columns, surrogates,
};
use crate::responses::check_answerable;
use crate::sanitize::shell_word;
use crate::study::{Optimization, SensitivityFrom, Study};
use crate::table::column::Column;
use crate::table::{WriteError, provenance_with};

const EXAMPLES: &str = "\
Examples:
  stickslip optimize studies/cd-rom.yaml
  stickslip optimize studies/cd-rom.yaml --out results/quiet --threads 8
  stickslip optimize studies/cd-rom.yaml --json > optimum.json

Searches for the design with the best objectives. The study lists variables under `design`, responses under \
`responses`, and under `optimize` the responses to minimize or maximize, with limits to others. The search \
prints a line for each evaluated design: first designs spread over all ranges and choices, then designs chosen by \
surrogate models, four at a time. The same study and seed give the same designs on any number of threads. \
The best designs are evaluated again with independent runs, so that the reported values have no selection bias.

DIR holds evaluations.parquet (every design), finalists.parquet, pareto.parquet (with two objectives), \
sensitivities.parquet (Sobol' indices), surrogates.json, optimum.json, and files.json (the hash of each file). \
The same command with the same DIR continues the search, also with a larger number of designs, unless \
evaluations.parquet has been changed. `stickslip evaluate` computes further designs.";

/// Search for the best design with surrogate models
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct OptimizeArguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Directory for the results [default: results/<name of the study>-optimum]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    threads: ThreadsArgument,

    /// Print no progress
    #[arg(long, short)]
    quiet: bool,

    /// Print the content of optimum.json instead of the result in words
    #[arg(long)]
    json: bool,
}

/// Searches for the best design.
///
/// # Errors
/// Returns an error if the study cannot be used or has no `optimize`, if the directory holds other files, if a
/// table cannot be written, or if an objective does not depend on the design.
pub fn optimize(arguments: &OptimizeArguments) -> Result<End, CliError> {
    let study = arguments.study.load_and_warn(arguments.quiet)?;
    let file = arguments.study.study.display();
    let Some(optimization) = study.optimization() else {
        let allowed = "an objective in the study, such as optimize: {minimize: vibration}";
        return Err(CliError::Usage(format!(
            "{file}: `optimize` is missing\n  allowed: {allowed}"
        )));
    };
    check_answerable(&study, &arguments.study.study).map_err(CliError::Usage)?;
    let usual = || Path::new("results").join(format!("{}-optimum", study.name()));
    let directory = arguments.out.clone().unwrap_or_else(usual);
    let mut search_directory = SearchDirectory::new(&study, optimization, &directory)?;
    let mut evaluations =
        read_evaluations(&study, &directory).map_err(|error| CliError::Usage(error.to_string()))?;
    for name in &search_directory.directory.changed {
        say(&format!("{name} has been changed since it was written; writing it anew"));
    }
    let (workers, stop) = (arguments.threads.start()?, stop_on_signals());
    let what = Search { study: &study, optimization, workers: &workers, stop: &stop };
    let show = if arguments.quiet { Show::Nothing } else { Show::auto() };
    let report = |text: String| {
        if !arguments.quiet {
            say(&text);
        }
    };
    if !evaluations.is_empty() {
        let designs = counted(evaluations.len(), "design");
        report(format!("continuing after {designs} in {}", directory.display()));
    }
    // The two parts differ in speed, so that each has its own progress.
    let mut end = SearchEnd::Finished;
    for until in [optimization.start_designs.min(optimization.designs), optimization.designs] {
        if end == SearchEnd::Finished {
            end = search_until(&what, &mut evaluations, until, show, &mut search_directory)?;
        }
    }
    match &end {
        SearchEnd::Stopped => return Ok(interrupted(&directory)),
        SearchEnd::Constant(problem) => {
            let allowed =
                "an objective that has a value for these designs and depends on the design";
            return Err(CliError::Usage(format!(
                "{file}: `optimize`: {problem}\n  allowed: {allowed}"
            )));
        }
        SearchEnd::NoMoreDesigns => report("all possible designs have been evaluated".to_owned()),
        SearchEnd::Finished => {}
    }
    let instead =
        evaluations.iter().filter(|one| one.origin == Origin::SpaceFillingInstead).count();
    if instead > 0 {
        let all = evaluations.len();
        report(format!(
            "{instead} of {all} designs are space-filling: the surrogates proposed no new design"
        ));
    }
    if stop.load(Ordering::Relaxed) {
        return Ok(interrupted(&directory));
    }
    let Some(surrogates) = surrogates(&what, &evaluations) else {
        return Ok(interrupted(&directory));
    };
    search_directory.write_surrogates(&surrogates)?;
    let Some(sensitivities) = with_progress(&what, sensitivity_runs(&what), show, |finished| {
        sensitivities(&what, &surrogates, finished)
    }) else {
        return Ok(interrupted(&directory));
    };
    search_directory.write("sensitivities", sensitivity_columns(), sensitivities.clone())?;
    let Some(finalists) = with_progress(&what, final_runs(&what), show, |finished| {
        finalists(&what, &evaluations, finished)
    }) else {
        return Ok(interrupted(&directory));
    };
    search_directory.write_finals(&finalists)?;
    let summary = optimum_json(&what, &end, &evaluations, &finalists, &sensitivities);
    search_directory.directory.write_json("optimum.json", &summary)?;
    if arguments.json {
        print_json(&format!("{summary:#}\n"))?;
    } else {
        print(&result_in_words(&what, &finalists))?;
    }
    report(format!("results in {}", directory.display()));
    Ok(how_it_ends(&what, &evaluations, &finalists))
}

/// Continues the search up to a number of designs and shows its progress.
fn search_until(
    what: &Search,
    evaluations: &mut Vec<Evaluation>,
    until: u64,
    show: Show,
    search_directory: &mut SearchDirectory,
) -> Result<SearchEnd, CliError> {
    let missing = until.saturating_sub(evaluations.len() as u64);
    if missing == 0 {
        return Ok(SearchEnd::Finished);
    }
    let runs = missing.saturating_mul(what.study.most_runs_of_a_design());
    let parts = Parts::Designs(missing);
    let planned = Planned { study: what.study.name(), runs, at_most: true, parts };
    let progress = Progress::begin(planned, show);
    progress.keep_drawing();
    let finished = |label| progress.finished(label);
    let end = search(what, evaluations, until, &finished, |evaluations| {
        search_directory.remove_ends();
        search_directory.write_evaluations(evaluations)?;
        progress.point(|| search_line(what, evaluations), || json!({}));
        Ok::<(), CliError>(())
    });
    progress.close();
    end
}

fn interrupted(directory: &Path) -> End {
    say(&format!(
        "interrupted; run the same command with --out {} to continue",
        shell_word(directory)
    ));
    End::Interrupted
}

fn how_it_ends(what: &Search, evaluations: &[Evaluation], finalists: &Finalists) -> End {
    let met = |role| finalists.of(role).is_some_and(|one| one.met);
    if !met(FinalistRole::Best) && !finalists.all.iter().any(|one| one.on_front == Some(true)) {
        let unmet = nearest_unmet(what.study, what.optimization, evaluations, finalists);
        say(&format!("no design meets all limits; the nearest one: {}", unmet.join("; ")));
        return End::ExpectationNotMet;
    }
    let of_search = evaluations.iter().flat_map(|one| &one.answers);
    let of_finals = finalists.all.iter().flat_map(|one| &one.answers);
    let failed = of_search.chain(of_finals).map(|answer| answer.counts.of(Label::Failed));
    match failed.sum::<u64>() {
        0 => End::Well,
        failed => {
            let failed = counted(failed, "run");
            say(&format!("{failed} failed; amplitudes and times exclude them"));
            End::RunsFailed
        }
    }
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

/// Does work of at most `runs` runs and shows its progress.
fn with_progress<T>(
    what: &Search,
    runs: u64,
    show: Show,
    work: impl FnOnce(&(dyn Fn(Label) + Sync)) -> Option<T>,
) -> Option<T> {
    if runs == 0 {
        return work(&|_| {});
    }
    let study = what.study.name();
    // The parts of this work do not report that they have finished.
    let parts = Parts::Designs(0);
    Progress::during(Planned { study, runs, at_most: true, parts }, show, work)
}

/// The output directory of a search.
struct SearchDirectory<'a> {
    study: &'a Study,
    optimization: &'a Optimization,
    directory: ContinuedDirectory<'a>,
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
    fn new(
        study: &'a Study,
        optimization: &'a Optimization,
        directory: &'a Path,
    ) -> Result<Self, CliError> {
        let reason = "this directory is not empty and holds no search";
        let directory = ContinuedDirectory::open(directory, reason, |name| OWN.contains(&name))?;
        Ok(SearchDirectory { study, optimization, directory })
    }

    /// Removes the results of an earlier end of the search, because there are more designs now.
    fn remove_ends(&mut self) {
        self.directory.remove(OWN.into_iter().filter(|name| *name != EVALUATIONS));
    }

    fn write<R>(
        &mut self,
        name: &str,
        columns: Vec<Column<R>>,
        rows: impl IntoIterator<Item = R>,
    ) -> Result<(), WriteError> {
        let about = provenance_with(self.study, name, &search_facts(self.study));
        self.directory.write(name, &about, columns, rows)
    }

    fn write_evaluations(&mut self, evaluations: &[Evaluation]) -> Result<(), WriteError> {
        let rows = evaluations
            .iter()
            .flat_map(|one| one.answers.iter().map(|answer| (one.origin, answer.clone())));
        self.write("evaluations", evaluation_columns(self.study), rows)
    }

    fn write_finals(&mut self, finalists: &Finalists) -> Result<(), WriteError> {
        let rows = finalists
            .all
            .iter()
            .flat_map(|one| one.answers.iter().map(|answer| (one.role, answer.clone())));
        self.write("finalists", finalist_columns(self.study), rows)?;
        if self.optimization.objectives.len() < 2 {
            return Ok(());
        }
        let front = finalists.all.iter().filter(|one| one.role == FinalistRole::Pareto).cloned();
        self.write("pareto", pareto_columns(self.study, self.optimization), front)
    }

    fn write_surrogates(&mut self, all: &[QuantitySurrogate]) -> Result<(), CliError> {
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
