//! `stickslip report`: writes the results of a study or of a search as one HTML page with figures.

use std::path::PathBuf;

use clap::Args;

use super::output::{CliError, End, print};
use crate::report::write_report;

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
pub struct Arguments {
    /// Directory with results of `stickslip run` or `stickslip optimize`
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    /// The page; only an unchanged earlier page is overwritten [default: DIR-report.html]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes the report and prints its path.
pub fn report(arguments: &Arguments) -> Result<End, CliError> {
    let file = write_report(&arguments.directory, arguments.out.as_deref())?;
    print(&format!("{}\n", file.display()))?;
    Ok(End::Well)
}
