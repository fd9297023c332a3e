//! `stickslip identify`: infers parameters from measured positions of rest.

use std::path::PathBuf;

use clap::Args;

use super::arguments::{StudyArgument, ThreadsArgument, results_directory};
use super::output::{CliError, End, print_result};
use crate::engine::{ProgressDisplay, say, stop_on_signals};
use crate::identify::Identify;
use crate::numbers::counted;
use crate::sanitize::{shell_word, shown_path};
use crate::study::{Study, implausible_angle};

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
pub struct Arguments {
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
pub fn identify(arguments: &Arguments) -> Result<End, CliError> {
    let study = arguments.study.load_and_warn(arguments.quiet)?;
    let out = results_directory(arguments.out.as_ref(), &study, "-identified");
    let (workers, stop) = (arguments.threads.start()?, stop_on_signals());
    let identify = Identify {
        study: &study,
        file: &arguments.study.study,
        measured: &arguments.measured,
        directory: &out,
        simulations: arguments.simulations.clone(),
        workers: &workers,
        stop: &stop,
        show: if arguments.quiet { ProgressDisplay::Nothing } else { ProgressDisplay::auto() },
    };
    let read = |study: &Study| {
        let runs = study.measured(&arguments.measured)?;
        if let Some(warning) = implausible_angle(&runs).filter(|_| !arguments.quiet) {
            say(&format!("warning: {}: {warning}", shown_path(&arguments.measured)));
        }
        Ok(runs)
    };
    let Some(identified) = identify.run(read)? else {
        let out = shell_word(&out);
        say(&format!("interrupted; run the same command with --out {out} to continue"));
        return Ok(End::Interrupted);
    };
    if !arguments.quiet {
        let warnings = identified.warnings.iter();
        warnings.for_each(|warning| {
            say(&format!("warning: {}: {warning}", shown_path(&arguments.study.study)))
        });
    }
    print_result(arguments.json, || identified.summary, || identified.in_words)?;
    if !arguments.quiet {
        say(&format!("results in {}", out.display()));
    }
    Ok(match identified.failed_runs {
        0 => End::Well,
        failed => {
            say(&format!("{} failed; the densities exclude them", counted(failed, "run")));
            End::RunsFailed
        }
    })
}
