//! `stickslip evaluate`: computes responses of designs for optimisers.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use clap::Args;

use super::arguments::{StudyArgument, ThreadsArgument};
use super::evaluate_server::serve;
use super::exit::{CliError, End};
use super::output::new_table;
use crate::classification::Label;
use crate::counted::counted;
use crate::engine::{Parts, Planned, Progress, Show, WorkerPool, say, stop_on_signals};
use crate::responses::{
    Answer, MOST_DESIGNS, check_answerable, respond_to_all, response_columns, run_count,
};
use crate::study::{DesignValue, Study};
use crate::table::provenance;

const EXAMPLES: &str = "\
Examples:
  stickslip evaluate studies/design.yaml --designs studies/designs.csv --out responses.parquet
  echo '{\"id\": 1, \"speed_rad_s\": -216, \"balls\": 2, \"material\": \"steel\"}' | stickslip evaluate studies/design.yaml --designs -

Computes the responses of each design. A design sets the variables that the study lists under `design`; \
`responses` lists what is computed. Sampling and uncertain parameters are those of the study, and each point of \
its sweep has its own row or answer. All designs share start states and draws, so that differences between \
designs are more precise than their values. `audit` and `expect` are ignored.

With --out the responses go to a Parquet file with a row per design and point. With --designs - the command is \
a server: it reads one JSON object per line from standard input and answers each with one line, in order, \
until its input ends or its output is closed. The answer to an invalid request is an object with `error`. \
`stickslip optimize` searches for the best design with the same responses.";

/// Compute responses of designs for optimisers, from a table or from requests on standard input
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct EvaluateArguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Table of designs, CSV or Parquet, with a column per variable; - for requests on standard input
    #[arg(long, value_name = "FILE")]
    designs: PathBuf,

    /// Parquet file to write, such as responses.parquet; required unless --designs is -
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,

    #[command(flatten)]
    threads: ThreadsArgument,

    /// Print no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Evaluates designs.
///
/// # Errors
/// Returns an error if the study or the table cannot be used, if the output file exists, or if it cannot be written.
pub fn evaluate(arguments: &EvaluateArguments) -> Result<End, CliError> {
    let study = arguments.study.load_and_warn(arguments.quiet)?;
    check(arguments, &study)?;
    match &arguments.out {
        None => serve(&study, &arguments.threads.start()?, &stop_on_signals()),
        Some(out) => {
            let designs = study.designs(&arguments.designs)?;
            let columns = response_columns(&study);
            let mut table = new_table(out, columns, &provenance(&study, "responses"))?;
            let show = if arguments.quiet { Show::Nothing } else { Show::auto() };
            let (workers, stop) = (arguments.threads.start()?, stop_on_signals());
            let Some(answers) = compute(&study, &designs, &workers, &stop, show)? else {
                table.abandon()?;
                say("interrupted; nothing is written");
                return Ok(End::Interrupted);
            };
            let mut failed = 0;
            for answer in answers {
                failed += answer.counts.of(Label::Failed);
                table.push(answer)?;
            }
            table.finish()?;
            if !arguments.quiet {
                let of = counted(designs.len(), "design");
                say(&format!("responses of {of} in {}", out.display()));
                if designs.len() > MOST_DESIGNS {
                    say(&format!(
                        "more than {MOST_DESIGNS} designs: `discontinuous` is not computed"
                    ));
                }
            }
            Ok(if failed > 0 { End::RunsFailed } else { End::Well })
        }
    }
}

/// Checks the combination of study and arguments.
fn check(arguments: &EvaluateArguments, study: &Study) -> Result<(), CliError> {
    let usage = |text: String| Err(CliError::Usage(text));
    check_answerable(study, &arguments.study.study).map_err(CliError::Usage)?;
    let requests = arguments.designs.as_os_str() == "-";
    match &arguments.out {
        Some(_) if requests => usage(
            "--out: answers to requests go to standard output\n  allowed: --out with a table of designs"
                .to_owned(),
        ),
        None if !requests => usage(
            "--out is missing\n  allowed: the name of a new Parquet file, or --designs -".to_owned(),
        ),
        _ => Ok(()),
    }
}

/// Returns the answers for all designs, in order; `None` if `stop` became true.
fn compute(
    study: &Study,
    designs: &[Vec<DesignValue>],
    workers: &WorkerPool,
    stop: &AtomicBool,
    show: Show,
) -> Result<Option<Vec<Answer>>, CliError> {
    let runs = run_count(study, designs).map_err(CliError::Usage)?;
    let parts = Parts::Designs(designs.len() as u64);
    let planned = Planned { study: study.name(), runs, at_most: false, parts };
    let progress = Progress::begin(planned, show);
    let finished = |label| progress.finished(label);
    let answers = respond_to_all(workers, study, designs, stop, &finished);
    progress.close();
    let answers = answers.map_err(CliError::Usage)?;
    progress.ended(answers.is_none());
    Ok(answers)
}
