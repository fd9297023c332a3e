//! `stickslip identify`: infers parameters from measured positions of rest.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::arguments::{StudyArgument, ThreadsArgument};
use super::continued_directory::ContinuedDirectory;
use super::exit::{CliError, End};
use super::output::{print, print_json};
use crate::counted::counted;
use crate::engine::{Parts, Planned, Progress, Show, say, stop_on_signals};
use crate::identify::{
    Inference, InferenceEnd, Inferred, ParameterSet, Sets, evaluated_set_columns, fit_columns,
    identification_json, infer, position_columns, position_rows, posterior_columns,
    read_parameter_set, result_in_words, set_columns, set_facts, set_name, sites,
};
use crate::sanitize::shell_word;
use crate::study::{DesignValue, Identification, MeasuredRun, Study};
use crate::table::provenance_with;

const EXAMPLES: &str = "\
Examples:
  stickslip identify studies/identify-contact.yaml --measured studies/rests.csv
  stickslip identify studies/identify-contact.yaml --measured rests.csv --out results/friction --json
  stickslip identify studies/identify-contact.yaml --measured later.csv --simulations results/friction/simulations

Infers the parameters that the study lists under `identify`, each with the range of its prior. FILE has a row per \
measured run: columns of the swept parameters, such as speed_rad_s, which select the point of the sweep; beta_1_rad, \
beta_2_rad and so on, the angles of the balls from the imbalance in any order, empty if the balls were seen to move; \
std_dev_rad, the standard deviation of a measured angle; and for studies with stages `stage`.

DIR holds posterior.parquet (samples of the posterior), parameter_sets.parquet (the log-likelihood of each parameter \
set), fit.parquet (whether the model explains the measurements, at each point), positions.parquet (measured and \
predicted positions), identification.json, files.json, and \
the directory simulations with the ends of all runs. The same command continues an interrupted inference. The same \
study, measurements and seed give the same bytes on any number of threads.";

/// Infer parameters from measured positions of rest
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct IdentifyArguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Table of measured runs, CSV or Parquet
    #[arg(long, value_name = "FILE")]
    measured: PathBuf,

    /// Directory for the results [default: results/<name of the study>-identified]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Directory for the ends of simulated runs, which all measurements of one study can share [default: DIR/simulations]
    #[arg(long, value_name = "DIR")]
    simulations: Option<PathBuf>,

    #[command(flatten)]
    threads: ThreadsArgument,

    /// Print no progress
    #[arg(long, short)]
    quiet: bool,

    /// Print the content of identification.json instead of the result in words
    #[arg(long)]
    json: bool,
}

/// Infers parameters.
///
/// # Errors
/// Returns an error if the study or the measurements cannot be used, if a directory holds other files, or if a table cannot
/// be written.
pub fn identify(arguments: &IdentifyArguments) -> Result<End, CliError> {
    let written = arguments.study.load_and_warn(arguments.quiet)?;
    let (study, identification) = identified(&written, &arguments.study.study)?;
    let measured = study.measured(&arguments.measured)?;
    let refused = |problem| CliError::Usage(format!("{}: {problem}", arguments.measured.display()));
    let sites = sites(&study, &measured).map_err(refused)?;
    let usual = || Path::new("results").join(format!("{}-identified", study.name()));
    let out = arguments.out.clone().unwrap_or_else(usual);
    let mut results = ResultFiles::open(&study, &measured, &out)?;
    let simulations = arguments.simulations.clone().unwrap_or_else(|| out.join(SIMULATIONS));
    let mut sets = SetFiles::open(&study, &simulations)?;
    let (workers, stop) = (arguments.threads.start()?, stop_on_signals());
    let inference = Inference {
        study: &study,
        identification: &identification,
        sites: &sites,
        workers: &workers,
        stop: &stop,
    };
    let show = if arguments.quiet { Show::Nothing } else { Show::auto() };
    let end = with_progress(&inference, &mut sets, show)?;
    let inferred = match end {
        InferenceEnd::Finished(inferred) => inferred,
        InferenceEnd::Stopped => {
            let out = shell_word(&out);
            say(&format!("interrupted; run the same command with --out {out} to continue"));
            return Ok(End::Interrupted);
        }
        InferenceEnd::Impossible(problem) => {
            let file = arguments.study.study.display();
            let allowed = "parameters on which the measured positions of rest depend";
            return Err(CliError::Usage(format!(
                "{file}: `identify`: {problem}\n  allowed: {allowed}"
            )));
        }
    };
    let summary = identification_json(&inference, &inferred, &results.measured);
    results.write(&inference, &inferred, &summary)?;
    if arguments.json {
        print_json(&format!("{summary:#}\n"))?;
    } else {
        print(&result_in_words(&inference, &inferred))?;
    }
    if !arguments.quiet {
        say(&format!("results in {}", out.display()));
    }
    Ok(match inferred.runs[1] {
        0 => End::Well,
        failed => {
            say(&format!("{} failed; the densities exclude them", counted(failed, "run")));
            End::RunsFailed
        }
    })
}

/// Returns the study with the parameters as variables, and what is to be inferred.
fn identified(study: &Study, file: &Path) -> Result<(Study, Identification), CliError> {
    let file = file.display();
    if study.precision().is_some() {
        let allowed = "a study without `precision`, so that all parameter sets have the same runs";
        return Err(CliError::Usage(format!(
            "{file}: parameter sets would have different numbers of runs\n  found:   `precision`\n  allowed: {allowed}"
        )));
    }
    if study.model().ball_balancer().is_none() {
        return Err(CliError::Usage(format!(
            "{file}: `identify` needs positions of balls\n  found:   kind: {}\n  allowed: kind: ball_balancer",
            study.model().kind().name
        )));
    }
    study.for_identification().ok_or_else(|| {
        let allowed = "parameters in the study, such as identify: {parameters: {friction_coefficient: {from: 0.001, \
                       to: 0.006}}}";
        CliError::Usage(format!("{file}: `identify` is missing\n  allowed: {allowed}"))
    })
}

/// Infers the parameters and shows the progress.
fn with_progress(
    inference: &Inference,
    sets: &mut SetFiles,
    show: Show,
) -> Result<InferenceEnd, CliError> {
    let Inference { study, identification, .. } = *inference;
    let runs = identification.designs.saturating_mul(study.run_count());
    let parts = Parts::Designs(identification.designs);
    let progress =
        Progress::begin(Planned { study: study.name(), runs, at_most: true, parts }, show);
    progress.keep_drawing();
    let finished = |label| progress.finished(label);
    let designs = identification.designs;
    let end = infer(inference, sets, &finished, |number| {
        progress.point(|| format!("parameter set {number} of {designs}"), || json!({}));
    });
    progress.close();
    end
}

/// The name of the directory with the ends of simulated runs.
const SIMULATIONS: &str = "simulations";

/// The files with the ends of simulated runs.
struct SetFiles<'a> {
    study: &'a Study,
    directory: ContinuedDirectory<'a>,
}

impl<'a> SetFiles<'a> {
    fn open(study: &'a Study, path: &'a Path) -> Result<Self, CliError> {
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

impl Sets<CliError> for SetFiles<'_> {
    fn find(&mut self, values: &[DesignValue]) -> Result<Option<ParameterSet>, CliError> {
        let name = format!("{}.parquet", set_name(self.study, values));
        if self.directory.changed.contains(&name) || !self.directory.list.has(&name) {
            return Ok(None);
        }
        read_parameter_set(self.study, self.directory.path, values)
            .map_err(|error| CliError::Usage(error.to_string()))
    }

    fn keep(&mut self, set: &ParameterSet) -> Result<(), CliError> {
        let (name, facts) = (set_name(self.study, &set.values), set_facts(self.study, &set.values));
        let about = provenance_with(self.study, &name, &facts);
        self.directory.write(&name, &about, set_columns(self.study), set.ends.clone())?;
        Ok(())
    }
}

/// The files with the results.
struct ResultFiles<'a> {
    study: &'a Study,
    /// The hash of the measured runs.
    measured: String,
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
    fn open(study: &'a Study, measured: &[MeasuredRun], path: &'a Path) -> Result<Self, CliError> {
        let reason = "this directory is not empty and holds no inference";
        let directory = ContinuedDirectory::open(path, reason, |name| OWN.contains(&name))?;
        let measured = hash(measured);
        let summary = std::fs::read(path.join(SUMMARY)).ok();
        let before: Option<Value> = summary.and_then(|text| serde_json::from_slice(&text).ok());
        if let Some(before) = before
            && (before["measured_sha256"] != measured || before["study_hash"] != study.hash())
        {
            let simulations = shell_word(&path.join(SIMULATIONS));
            return Err(CliError::Usage(format!(
                "{}: this directory holds another inference\n  found:   results of other measurements or of another \
                 study\n  allowed: another directory with --out; --simulations {simulations} uses the simulated runs of \
                 the same study again",
                path.display()
            )));
        }
        Ok(ResultFiles { study, measured, directory })
    }

    fn write(
        &mut self,
        inference: &Inference,
        inferred: &Inferred,
        summary: &Value,
    ) -> Result<(), CliError> {
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
    digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
