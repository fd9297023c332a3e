//! `stickslip evaluate`: responses of designs, for optimisers.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::Args;

use super::arguments::{StudyArgument, threads};
use super::evaluate_server::serve;
use super::exit::{CliError, End};
use crate::classification::Label;
use crate::engine::{Planned, Progress, Show, WorkerPool, say, stop_on_signals};
use crate::responses::{
    Answer, MOST_DESIGNS, check_answerable, respond_to_all, response_columns, run_count,
};
use crate::study::{DesignValue, Study};
use crate::table::{TableWriter, provenance};

const EXAMPLES: &str = "\
Examples:
  stickslip evaluate studies/design.yaml --designs designs.csv --out responses.parquet
  echo '{\"id\": 1, \"balls\": 2, \"material\": \"steel\"}' | stickslip evaluate studies/design.yaml --designs -

The study names variables under `design` and what is asked for under `responses`. A design is the study
with these set: it has the study's sampling and uncertain parameters, and at each point of its sweep a row
or answer of its own. All designs fraction start states and draws, so that differences between designs are
known better than the designs. `audit` and `expect` are left out.

With - it answers one JSON object per line of standard input with one per line, in order, until its input
ends or nobody reads its answers any more. What is wrong with a request is its answer.";

/// Responses of designs, for optimisers: a table of them, or requests one by one
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct EvaluateArguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Table of designs, CSV or Parquet, a column for each variable; - for requests on standard input
    #[arg(long, value_name = "FILE")]
    designs: PathBuf,

    /// Parquet file to write; not with --designs -
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Worker threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    threads: Option<NonZeroUsize>,

    /// No progress on the terminal
    #[arg(long, short)]
    quiet: bool,
}

/// Evaluates designs.
///
/// # Errors
/// Where study or table cannot be used, the file exists, or it cannot be written.
pub fn evaluate(arguments: &EvaluateArguments) -> Result<End, CliError> {
    let study = arguments.study.load()?;
    check(arguments, &study)?;
    let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let start = || {
        let workers = WorkerPool::new(arguments.threads.unwrap_or_else(cores).get());
        workers.map_err(CliError::Threads)
    };
    let stop = || {
        stop_on_signals().unwrap_or_else(|error| {
            say(&format!("warning: Ctrl-C will not be clean: {error}"));
            Arc::new(AtomicBool::new(false))
        })
    };
    match &arguments.out {
        None => serve(&study, &start()?, &stop()),
        Some(out) => {
            let designs = study.designs(&arguments.designs)?;
            let columns = response_columns(&study);
            let mut table = TableWriter::create(out, columns, &provenance(&study, "responses"))
                .map_err(|error| {
                    let allowed = "the name of a new file in a directory that can be written to";
                    CliError::Usage(format!("{error}\n  allowed: {allowed}"))
                })?;
            let show = if arguments.quiet { Show::Nothing } else { Show::auto() };
            let Some(answers) = compute(&study, &designs, &start()?, &stop(), show)? else {
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
                say(&format!("responses of {} designs in {}", designs.len(), out.display()));
                if designs.len() > MOST_DESIGNS {
                    say(&format!("more than {MOST_DESIGNS} designs: `discontinuous` is left out"));
                }
            }
            Ok(if failed > 0 { End::RunsFailed } else { End::Well })
        }
    }
}

/// What study and arguments must have together.
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
        Some(path) if path.exists() => usage(format!(
            "{}: exists already\n  allowed: the name of a new file",
            path.display()
        )),
        _ => Ok(()),
    }
}

/// The answers for all designs, in order; none where `stop` became true.
fn compute(
    study: &Study,
    designs: &[Vec<DesignValue>],
    workers: &WorkerPool,
    stop: &AtomicBool,
    show: Show,
) -> Result<Option<Vec<Answer>>, CliError> {
    let runs = run_count(study, designs).map_err(CliError::Usage)?;
    let points = designs.len() as u64 * study.point_count();
    let planned = Planned { study: study.name(), runs, at_most: false, points };
    let progress = Progress::begin(planned, show);
    let finished = |label| progress.finished(label);
    let answers = respond_to_all(workers, study, designs, stop, &finished);
    progress.close();
    let answers = answers.map_err(CliError::Usage)?;
    progress.ended(answers.is_none());
    Ok(answers)
}
