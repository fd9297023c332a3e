//! The command line: each command has its own file. This file calls the command and sets the exit code.
//!
//! Read `output` first: how a command ends and prints. `arguments` and `range` are arguments that commands
//! share.
//!
//! Each other file is a command or a part of one. `check_machine`, `check_points`, `existence`
//! and `design_cost` are parts of `check`. `run_on_engine` computes a study for `run`, `resume`, `merge` and
//! `verify`. `summary`, `report`, `compare`, `equilibria` and `replay` need results or closed forms only, and `evaluate`,
//! `optimize` and `identify` evaluate designs. `new`, `expand`, `schema` and `completions` help to write studies and
//! commands.

mod arguments;
mod check;
mod check_legend;
mod check_machine;
mod check_points;
mod compare;
mod completions;
mod cost;
mod design_cost;
mod equilibria;
mod equilibria_of_balancer;
mod equilibria_of_system;
mod equilibria_report;
mod equilibria_tables;
mod evaluate;
mod existence;
mod expand;
mod identify;
mod merge;
mod new;
mod new_table;
mod optimize;
mod output;
mod points_table;
mod range;
mod replay;
mod replay_text;
mod report;
mod result_lines;
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
pub use output::{CliError, End, print_message};
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

/// Defines the commands in the order of the help, and how each is carried out: by the function of its module.
macro_rules! commands {
    ($($name:ident: $module:ident,)+) => {
        #[derive(Debug, Subcommand)]
        enum Command {
            $($name($module::Arguments),)+
        }

        impl Command {
            fn carry_out(&self) -> Result<End, CliError> {
                match self {
                    $(Command::$name(arguments) => $module::$module(arguments),)+
                }
            }
        }
    };
}

commands! {
    New: new, Run: run, Resume: resume, Merge: merge, Replay: replay, Summary: summary, Compare: compare,
    Report: report, Check: check, Expand: expand, Verify: verify, Equilibria: equilibria, Evaluate: evaluate,
    Optimize: optimize, Identify: identify, Schema: schema, Completions: completions,
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

/// Runs the program like [`run()`] with these arguments; the first one is the name of the program. A process of another
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
    match command.carry_out() {
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
