//! `stickslip report`: results to look at, as a page, or as figures for papers.

use std::path::PathBuf;

use clap::Args;

use super::exit::{CliError, End};
use super::output::print;
use super::report_figures::{self, FigureFormat};
use super::report_page;

const EXAMPLES: &str = "\
Examples:
  stickslip report results/night                    writes results/night-report.html
  stickslip report results/night --out night.html
  stickslip report results/night --figures svg      writes results/night-figures/*.svg

The page is one file that needs no network: open it in a browser, or mail it. It says what was run and
what is missing or in doubt, has the table of points, and figures: where the balls come to rest over the
equilibrium set, how runs end over the sweep, time to rest, residual amplitude, which start states end
where, limit cycles, failures and doubt. What is known of a run is at its dot, with the command that
replays it. Nothing is computed again, and nothing in the directory is changed.

With --figures the figures are files of their own, 90 mm or 180 mm wide, with fonts of 8 points; also of
a directory that `stickslip equilibria` (sets, branches) or `stickslip replay` (the motion) has written.";

/// Write a page with figures of the results of a directory, or figures for papers
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ReportArguments {
    /// Directory with results; with --figures also one of `equilibria` or `replay`
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    /// The page [default: DIR-report.html]; with --figures their directory [default: DIR-figures]; only
    /// earlier pages and figures are replaced
    #[arg(short, long, value_name = "FILE|DIR")]
    out: Option<PathBuf>,

    /// Figures for papers instead of a page, one file each
    #[arg(long, value_name = "FORMAT", value_enum)]
    figures: Option<FigureFormat>,
}

/// Writes the report and prints its path, or those of its figures.
///
/// # Errors
/// Where the directory holds no results that can be read, or the page cannot be written.
pub fn report(arguments: &ReportArguments) -> Result<End, CliError> {
    let out = arguments.out.as_deref();
    if let Some(format) = arguments.figures {
        let files = report_figures::write(&arguments.directory, format, out)?;
        let lines: Vec<String> = files.iter().map(|file| format!("{}\n", file.display())).collect();
        print(&lines.concat())?;
        return Ok(End::Well);
    }
    let file = report_page::write(&arguments.directory, out)?;
    print(&format!("{}\n", file.display()))?;
    Ok(End::Well)
}
