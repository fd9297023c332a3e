//! `stickslip report`: results to look at, as one HTML page.

use std::path::PathBuf;

use clap::Args;

use super::exit::{CliError, End};
use super::output::print;
use super::report_page;

const EXAMPLES: &str = "\
Examples:
  stickslip report results/night                    writes results/night-report.html
  stickslip report results/night --out night.html

The page is one file that needs no network: open it in a browser, or mail it. It says what was run and
what is missing or in doubt, has the table of points, and figures: where the balls come to rest over the
equilibrium set, how runs end over the sweep, time to rest, residual amplitude, which start states end
where, limit cycles, failures and doubt. What is known of a run is at its dot, with the command that
replays it. Nothing is computed again, and nothing in the directory is changed. Each figure can be saved
as SVG or PNG; figures for papers are drawn from the tables by the Python package's `stickslip-figures`.";

/// Write an HTML page with figures of the results of a directory
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ReportArguments {
    /// Directory with results of `stickslip run`
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    /// The page; only an earlier page is replaced [default: DIR-report.html]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes the report and prints its path.
///
/// # Errors
/// Where the directory holds no results that can be read, or the page cannot be written.
pub fn report(arguments: &ReportArguments) -> Result<End, CliError> {
    let file = report_page::write(&arguments.directory, arguments.out.as_deref())?;
    print(&format!("{}\n", file.display()))?;
    Ok(End::Well)
}
