//! The command line: one file per command; this file dispatches to them and turns ends into exit codes.

mod arguments;
mod check;
mod check_legend;
mod check_machine;
mod check_points;
mod check_run_up;
mod check_system;
mod compare;
mod completions;
mod cost;
mod design_cost;
mod equilibria;
mod equilibria_report;
mod evaluate;
mod evaluate_server;
mod existence;
mod exit;
mod expand;
mod failures;
mod identify;
mod merge;
mod new;
mod new_table;
mod optimize;
mod output;
mod point_words;
mod points_table;
mod range;
mod replay;
mod replay_text;
mod report;
mod resume;
mod run;
mod run_on_engine;
mod schema;
mod summary;
mod verify;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

pub use check::check_json;
pub use exit::{CliError, End};
pub use output::print_message;
pub use points_table::{MOST_LINES, PointsTable};

use crate::engine::{say, show_messages, survive_file_size_limit};
use crate::study::Registry;

const EXAMPLES: &str = "\
Examples:
  stickslip new study.yaml                              write a commented study to start from
  stickslip check studies/preferred-equilibria.yaml     check the study and its cost
  stickslip run studies/preferred-equilibria.yaml       compute it; tables in results/<study>
  stickslip run study.yaml --out results/night --threads 8
  stickslip resume results/night                        continue after an interruption
  stickslip replay results/night 17                     the motion of one run
  stickslip summary results/night                       print the table of results
  stickslip report results/night                        write a page of figures
  stickslip compare results/before results/after        how two answers differ
  stickslip verify studies/smoke.yaml                   compute it and check its expectations

Exit codes:
  0    success
  1    not completed, too many failed runs, or replay differs
  2    wrong usage, study or directory
  3    some runs failed
  4    verify: an expectation is not met; optimize: no design meets the limits
  130  interrupted or out of time; finished runs are saved";

/// Parallel parameter studies and Monte Carlo for mechanical systems with dry friction.
#[derive(Debug, Parser)]
#[command(name = "stickslip", version, about, after_help = EXAMPLES, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    New(new::NewArguments),
    Run(run::RunArguments),
    Resume(resume::ResumeArguments),
    Merge(merge::MergeArguments),
    Replay(replay::ReplayArguments),
    Summary(summary::SummaryArguments),
    Compare(compare::CompareArguments),
    Report(report::ReportArguments),
    Check(check::CheckArguments),
    Expand(expand::ExpandArguments),
    Verify(verify::VerifyArguments),
    Equilibria(equilibria::EquilibriaArguments),
    Evaluate(evaluate::EvaluateArguments),
    Optimize(optimize::OptimizeArguments),
    Identify(identify::IdentifyArguments),
    Schema(schema::SchemaArguments),
    Completions(completions::CompletionsArguments),
}

/// Runs the program with the built-in kinds of models, and returns the exit code.
pub fn main() -> ExitCode {
    run(Registry::new())
}

/// Runs the program with the kinds of models of a registry beside the built-in ones: parses the arguments of the process,
/// runs the command, and returns the exit code. A registry that is not sound ends the program with exit code 2.
pub fn run(registry: Registry) -> ExitCode {
    ExitCode::from(run_with(registry, std::env::args_os()))
}

/// Runs the program like [`run`] with these arguments; the first one is the name of the program. A process of another
/// language, such as Python, can call it; the handlers of signals stay installed afterwards.
pub fn run_with(registry: Registry, arguments: impl IntoIterator<Item = OsString>) -> u8 {
    show_messages(print_message);
    if let Err(error) = registry.install() {
        say(&format!("error: {error}"));
        return CliError::Usage(error.to_string()).code();
    }
    if let Err(error) = survive_file_size_limit() {
        say(&format!("warning: the file size limit may end the program: {error}"));
    }
    let command = match Cli::try_parse_from(arguments) {
        Ok(Cli { command }) => command,
        Err(help_or_error) => {
            // A closed stream has no reader to tell.
            let _ = help_or_error.print();
            return u8::try_from(help_or_error.exit_code()).unwrap_or(2);
        }
    };
    let result = match command {
        Command::New(arguments) => new::new(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Resume(arguments) => resume::resume(&arguments),
        Command::Merge(arguments) => merge::merge(&arguments),
        Command::Replay(arguments) => replay::replay(&arguments),
        Command::Summary(arguments) => summary::summary(&arguments),
        Command::Compare(arguments) => compare::compare(&arguments),
        Command::Report(arguments) => report::report(&arguments),
        Command::Check(arguments) => check::check(&arguments),
        Command::Expand(arguments) => expand::expand(&arguments),
        Command::Verify(arguments) => verify::verify(&arguments),
        Command::Equilibria(arguments) => equilibria::equilibria(&arguments),
        Command::Evaluate(arguments) => evaluate::evaluate(&arguments),
        Command::Optimize(arguments) => optimize::optimize(&arguments),
        Command::Identify(arguments) => identify::identify(&arguments),
        Command::Schema(arguments) => schema::schema(&arguments),
        Command::Completions(arguments) => completions::completions(&arguments),
    };
    match result {
        Ok(end) => end.code(),
        Err(error) => {
            say(&format!("error: {error}"));
            error.code()
        }
    }
}

/// Returns the definition of the command line, for completions and for tests of the help texts.
pub fn definition() -> clap::Command {
    <Cli as clap::CommandFactory>::command()
}
