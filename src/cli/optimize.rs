//! `stickslip optimize`: searches for the best design.

use std::path::PathBuf;

use clap::Args;

use super::arguments::{StudyArgument, ThreadsArgument, results_directory};
use super::output::{CliError, End, print_result};
use crate::engine::{ProgressDisplay, say, stop_on_signals};
use crate::numbers::counted;
use crate::optimize::{Optimize, Optimized};
use crate::sanitize::shell_word;

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
pub struct Arguments {
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
pub fn optimize(arguments: &Arguments) -> Result<End, CliError> {
    let study = arguments.study.load_and_warn(arguments.quiet)?;
    let directory = results_directory(arguments.out.as_ref(), &study, "-optimum");
    let (workers, stop) = (arguments.threads.start()?, stop_on_signals());
    let optimize = Optimize {
        study: &study,
        file: &arguments.study.study,
        directory: &directory,
        workers: &workers,
        stop: &stop,
        show: if arguments.quiet { ProgressDisplay::Nothing } else { ProgressDisplay::auto() },
        quiet: arguments.quiet,
    };
    let Some(optimized) = optimize.run()? else {
        let out = shell_word(&directory);
        say(&format!("interrupted; run the same command with --out {out} to continue"));
        return Ok(End::Interrupted);
    };
    let Optimized { summary, in_words, .. } = &optimized;
    print_result(arguments.json, || summary.clone(), || in_words.clone())?;
    if !arguments.quiet {
        say(&format!("results in {}", directory.display()));
    }
    Ok(how_it_ends(&optimized))
}

fn how_it_ends(optimized: &Optimized) -> End {
    if let Some(unmet) = &optimized.unmet {
        say(&format!("no design meets all limits; the nearest one: {}", unmet.join("; ")));
        return End::ExpectationNotMet;
    }
    match optimized.failed_runs {
        0 => End::Well,
        failed => {
            let failed = counted(failed, "run");
            say(&format!("{failed} failed; amplitudes and times exclude them"));
            End::RunsFailed
        }
    }
}
