//! `stickslip report`: writes results as one HTML page with figures.

use std::path::{Path, PathBuf};

use clap::Args;

use super::exit::{CliError, End};
use super::output::print;
use super::overwrite::{beside, outside, replace, replaceable, sealed};
use super::results_study::results_study;
use super::summary::no_tables;
use crate::report::{Budget, OWN, ReportData, ResultTables, of_results, page};

const EXAMPLES: &str = "\
Examples:
  stickslip report results/night                    writes results/night-report.html
  stickslip report results/night --out night.html

Writes one HTML file that needs no network; open it in a browser or mail it. The page lists what was run and the \
missing, failed and undecided runs, and shows the table of points and figures: where the balls come to rest on the \
equilibrium set, endings over the sweep, time to rest, residual amplitude, basins of attraction, limit cycles, \
failures and diagnostics. Each dot shows the results of its run and the command that replays it. The command \
computes nothing and changes nothing in the directory. The page saves each figure as SVG or PNG; the Python \
package's `stickslip-figures` draws figures for papers from the tables.";

/// Write an HTML page with figures of a directory of results
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ReportArguments {
    /// Directory with results of `stickslip run`
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    /// The page; only an unchanged earlier page is overwritten [default: DIR-report.html]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes the report and prints its path.
///
/// # Errors
/// Returns an error if the directory holds no readable results, or if the page cannot be written.
pub fn report(arguments: &ReportArguments) -> Result<End, CliError> {
    let file = write(&arguments.directory, arguments.out.as_deref())?;
    print(&format!("{}\n", file.display()))?;
    Ok(End::Well)
}

/// The largest page, in bytes, small enough to mail; pages of larger results show less detail.
const MOST_BYTES: usize = 4_900_000;

/// Writes the page of a directory of results and returns its path.
///
/// # Errors
/// Returns an error if the directory holds no readable results, or if the page cannot be written.
fn write(directory: &Path, out: Option<&Path>) -> Result<PathBuf, CliError> {
    let (study, manifest) = results_study(directory)?;
    if manifest.files.is_empty() {
        return Err(no_tables(directory, &study, &manifest)?);
    }
    let file = match out {
        Some(file) => file.to_owned(),
        None => beside(directory, "-report.html")?,
    };
    outside(directory, &file)?;
    replaceable(&file, is_page)?;
    let tables = ResultTables::open(directory, &manifest)?;
    let mut budget = Budget::SCREEN;
    let page = loop {
        let data = ReportData::read(&tables, &study, &manifest, budget)?;
        let page = page(directory, &data, &of_results(&data));
        if page.len() <= MOST_BYTES || budget == budget.halved() {
            break page;
        }
        budget = budget.halved();
    };
    replace(&file, sealed(&page).as_bytes())?;
    Ok(file)
}

fn is_page(content: &[u8]) -> bool {
    let head = &content[..content.len().min(4096)];
    String::from_utf8_lossy(head).contains(OWN)
}
