//! `stickslip evaluate`: computes responses of designs for optimisers.

use std::io::{self, IsTerminal};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use clap::Args;

use super::arguments::{StudyArgument, ThreadsArgument};
use super::evaluate_server::serve;
use super::exit::{CliError, End};
use super::new_table::NewTable;
use super::output::{csv_header, csv_rows, print};
use crate::classification::Label;
use crate::engine::{Parts, Planned, Progress, ProgressDisplay, WorkerPool, say, stop_on_signals};
use crate::numbers::counted;
use crate::printed_table::{PrintedTable, as_text};
use crate::report::{Estimates, estimate_columns};
use crate::responses::{
    Answer, MOST_DESIGNS, check_answerable, respond_to_all, response_columns, run_count,
};
use crate::study::{DesignValue, Study};
use crate::table::provenance;

const EXAMPLES: &str = "\
Examples:
  stickslip evaluate studies/design.yaml --designs studies/designs.csv
  stickslip evaluate studies/design.yaml --designs studies/designs.csv --out responses.parquet
  echo '{\"id\": 1, \"speed_rad_s\": -216, \"balls\": 2, \"material\": \"steel\"}' | stickslip evaluate studies/design.yaml --designs -

Computes the responses of each design. A design sets the variables that the study lists under `design`; \
`responses` lists what is computed. Sampling and uncertain parameters are those of the study, and each point of \
its sweep has its own row or answer. All designs share start states and draws, so that differences between \
designs are more precise than their values. `audit` and `expect` are ignored.

The table of responses has a row per design and point. With --out it goes to a Parquet file, or to a CSV file if the \
name ends in .csv. Otherwise it goes to standard output, as CSV; on a terminal as aligned columns with rounded \
numbers. With --designs - the command is a server: it reads one JSON object per line from standard input and answers each with one line, in order, \
until its input ends or its output is closed. The answer to an invalid request is an object with `error`. \
`stickslip optimize` searches for the best design with the same responses.";

/// Compute responses of designs for optimisers, from a table or from requests on standard input
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Table of designs, CSV or Parquet, with a column per variable; - for requests on standard input
    #[arg(long, value_name = "FILE")]
    designs: PathBuf,

    /// Parquet or CSV file to write, such as responses.parquet or responses.csv
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,

    #[command(flatten)]
    threads: ThreadsArgument,

    /// Print no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Evaluates designs.
pub fn evaluate(arguments: &Arguments) -> Result<End, CliError> {
    let study = arguments.study.load_and_warn(arguments.quiet)?;
    check_answerable(&study, &arguments.study.study).map_err(CliError::Usage)?;
    if arguments.designs.as_os_str() == "-" {
        if arguments.out.is_some() {
            let refused = "--out: answers to requests go to standard output\n  allowed: --out with a table of designs";
            return Err(CliError::Usage(refused.to_owned()));
        }
        return serve(&study, &arguments.threads.start()?, &stop_on_signals());
    }
    let designs = study.designs(&arguments.designs)?;
    let create = |out: &PathBuf| {
        NewTable::create(out, response_columns(&study), &provenance(&study, "responses"))
    };
    let table = arguments.out.as_ref().map(create).transpose()?;
    let show = if arguments.quiet { ProgressDisplay::Nothing } else { ProgressDisplay::auto() };
    let (workers, stop) = (arguments.threads.start()?, stop_on_signals());
    let Some(answers) = compute(&study, &designs, &workers, &stop, show)? else {
        table.map_or(Ok(()), NewTable::abandon)?;
        say("interrupted; nothing is written");
        return Ok(End::Interrupted);
    };
    let failed: u64 = answers.iter().map(|answer| answer.counts.of(Label::Failed)).sum();
    if let Some(mut table) = table {
        answers.into_iter().try_for_each(|answer| table.push(answer))?;
        table.finish()?;
    } else if io::stdout().is_terminal() {
        print(&printed(&study, &answers))?;
    } else {
        let columns = response_columns(&study);
        print(&(csv_header(&columns)? + &csv_rows(&columns, &answers)?))?;
    }
    if !arguments.quiet {
        if let Some(out) = &arguments.out {
            let of = counted(designs.len(), "design");
            say(&format!("responses of {of} in {}", out.display()));
        }
        if designs.len() > MOST_DESIGNS {
            say(&format!("more than {MOST_DESIGNS} designs: `discontinuous` is not computed"));
        }
    }
    Ok(if failed > 0 { End::RunsFailed } else { End::Well })
}

/// Returns the answers as aligned columns: variables, point of the sweep, responses with their intervals, and failed runs.
fn printed(study: &Study, answers: &[Answer]) -> String {
    let mut table = PrintedTable::new(answers, "");
    table.add("design", |answer| answer.design.to_string());
    for (index, variable) in study.variables().iter().enumerate() {
        let value = |answer: &Answer| Some(variable.describe(*answer.values.get(index)?));
        table.add_known(variable.shown_name(), value);
    }
    for (index, swept) in study.swept().iter().enumerate() {
        let value = |answer: &Answer| study.shown(&answer.swept).get(index).cloned();
        table.add_known(swept.shown_name(), value);
    }
    let estimates: Vec<Estimates<'_>> =
        answers.iter().map(|answer| (&answer.estimates[..], &[][..])).collect();
    table.columns.extend(estimate_columns(study.responses(), &estimates, study.units()));
    table.add("failed", |answer| answer.counts.of(Label::Failed).to_string());
    as_text(&table.columns)
}

/// Returns the answers for all designs, in order; `None` if `stop` became true.
fn compute(
    study: &Study,
    designs: &[Vec<DesignValue>],
    workers: &WorkerPool,
    stop: &AtomicBool,
    show: ProgressDisplay,
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
