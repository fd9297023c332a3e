//! `stickslip report`: writes the results of a study or of a search as one HTML page with figures.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use clap::Args;

use super::exit::{CliError, End};
use super::output::print;
use super::overwrite::{beside, outside, replace, replaceable, sealed};
use super::unfinished::{Readable, readable_results};
use crate::optimize::EvaluationsError;
use crate::report::{
    Budget, OWN, OptimumData, ReportData, ResultTables, of_results, of_search, optimum_page, page,
};
use crate::table::MANIFEST;

const EXAMPLES: &str = "\
Examples:
  stickslip report results/night                    writes results/night-report.html
  stickslip report results/night --out night.html
  stickslip report results/quiet                    of `stickslip optimize`

Writes one HTML file that needs no network; open it in a browser or mail it. The page lists what was run and the \
missing, failed and undecided runs, and shows the table of points and figures: the residual vibration and that \
without balls, the influence of uncertain parameters, endings over the sweep, time to rest, where the balls come to \
rest on the equilibrium set, basins of attraction, limit cycles and diagnostics. While a study is running, and after \
it was killed, the page shows the finished runs. The page of a search shows its convergence, the Pareto front, Sobol' \
indices, and the best design beside the reference. Each dot shows the results of its run and the command that replays it. The command \
changes nothing in the directory, and computes nothing but, for a disc that starts or a table that is kicked, the motion of \
a few runs. The page saves each figure as SVG or PNG; the Python \
package's `stickslip-figures` draws figures for papers from the tables.";

/// Write an HTML page with figures of a directory of results
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ReportArguments {
    /// Directory with results of `stickslip run` or `stickslip optimize`
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
    let is_search = is_search(directory);
    // Results are opened first, so that the error for anything else names them.
    let results = if is_search { None } else { Some(readable_results(directory)?) };
    let file = match out {
        Some(file) => file.to_owned(),
        None => beside(directory, "-report.html")?,
    };
    outside(directory, &file)?;
    replaceable(&file, is_page)?;
    let page = match results {
        Some(results) => page_of_results(directory, &results)?,
        None => page_of_search(directory)?,
    };
    replace(&file, sealed(&page).as_bytes())?;
    Ok(file)
}

/// Returns the page of a study, with as much detail as fits.
fn page_of_results(directory: &Path, results: &Readable) -> Result<String, CliError> {
    let Readable { study, manifest, tables, .. } = results;
    let tables = ResultTables::open(tables, manifest)?;
    let mut budget = Budget::SCREEN;
    loop {
        let data = ReportData::read(&tables, study, manifest, budget)?;
        let page = page(directory, &data, &of_results(&data));
        if page.len() <= MOST_BYTES || budget == budget.halved() {
            return Ok(page);
        }
        budget = budget.halved();
    }
}

/// The number of attempts to read the tables of a search.
///
/// A report reads the list of files first and the tables after it. A running search may replace or remove a table in
/// between, so that list and table disagree although both are sound; the next attempt reads the new list. A running
/// search replaces its tables at most once for each batch of designs, which takes longer than an attempt. Damage is
/// permanent: the last attempt reports it, less than half a second later.
const ATTEMPTS: u32 = 5;
/// The time between attempts.
const BETWEEN: Duration = Duration::from_millis(100);

/// Whether a directory was written by `stickslip optimize`.
fn is_search(directory: &Path) -> bool {
    let is_there = |name: &str| directory.join(name).exists();
    is_there("evaluations.parquet") && !is_there(MANIFEST)
}

/// Returns the page of a search.
fn page_of_search(directory: &Path) -> Result<String, CliError> {
    let mut attempt = 1;
    let data = loop {
        match OptimumData::read(directory) {
            // The search may have replaced a table during the reading.
            Err(_) if attempt < ATTEMPTS => thread::sleep(BETWEEN),
            Err(EvaluationsError::Table(error)) => return Err(error.into()),
            Err(EvaluationsError::Other(error)) => return Err(CliError::Usage(error)),
            Ok(data) => break data,
        }
        attempt += 1;
    };
    Ok(optimum_page(directory, &data, &of_search(&data)))
}

fn is_page(content: &[u8]) -> bool {
    let head = &content[..content.len().min(4096)];
    String::from_utf8_lossy(head).contains(OWN)
}
