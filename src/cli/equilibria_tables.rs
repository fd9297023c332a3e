//! The arguments of `stickslip equilibria`, and how it writes its tables.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use serde_json::Value;

use super::arguments::{StudyArgument, ThreadsArgument, parsed, results_directory};
use super::output::{CliError, End, print_result};
use super::range::{EvenRange, speeds};
use crate::analysis::{FEWEST_GRID_POINTS, MOST_BALL_DAMPING, SAMPLE_COUNTS};
use crate::engine::{ExclusiveDirectory, say};
use crate::numbers::counted;
use crate::study::Study;
use crate::table::{EquilibriumColumns, EquilibriumTables};

const EXAMPLES: &str = "\
Examples:
  stickslip equilibria studies/preferred-equilibria.yaml
  stickslip equilibria study.yaml --grid 2048 --no-set
  stickslip equilibria study.yaml --speeds -150:-300:151     the thesis's figure 5.1 as a table
  stickslip equilibria three-balls.yaml --samples 262144
  stickslip equilibria studies/block-on-belt.yaml            where a block slides steadily

Computes where the balls can rest, in closed form, without simulation. The directory holds \
equilibrium_positions.parquet (a row per ball position: amplitude, required friction, margin), \
equilibrium_set_summary.parquet (a row per point of the sweep: fraction of all positions, connected components, \
amplitudes, balance), frictionless_equilibria.parquet (equilibria without dry friction and their stability) and \
files.json (the hash of each file). A table of more than 524,288 rows is a directory of that name, with files of \
524,288 rows each.

Of any other system, it examines start positions with all speeds zero: friction holds the contacts at those in the \
equilibrium set. Instead of frictionless_equilibria.parquet it writes steady_states.parquet, with the states in which \
all contacts slide steadily, the equilibria without friction, and the eigenvalues of both.

After an interruption the same command continues in the same directory; it overwrites no other file. At a \
speed of 0 no force acts, and every position is an equilibrium. Read the tables with any Parquet reader; \
`stickslip run` computes which of the equilibria a machine comes to rest at.";

/// Compute equilibrium sets, steady sliding and equilibria without friction, without simulation
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    pub(super) study: StudyArgument,

    /// Directory for the tables; never overwritten [default: results/<name of the study>-equilibria]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    /// One or two balls: grid points per axis, at 2π k/G [default: 512]
    #[arg(long, value_name = "G", value_parser = grid, allow_negative_numbers = true)]
    pub(super) grid: Option<usize>,

    /// Three or more balls, and any other system: number of quasi-random samples, a power of two [default: 65536]
    #[arg(long, value_name = "SAMPLES", value_parser = samples, allow_negative_numbers = true)]
    pub(super) samples: Option<u32>,

    /// Compute the frictionless equilibria at COUNT speeds from FROM to TO [rad/s], with the parameters under
    /// `model`, instead of at the points of the sweep
    #[arg(long, value_name = "FROM:TO:COUNT", value_parser = speeds, allow_hyphen_values = true)]
    pub(super) speeds: Option<EvenRange>,

    /// Viscous drag on the balls, divided by ball mass and natural frequency, which determines the stability of
    /// the frictionless equilibria [default: 1e4]
    ///
    /// The default is that of the thesis, so high that larger values do not change the stability.
    #[arg(long, value_name = "C", value_parser = ball_damping, allow_negative_numbers = true)]
    pub(super) ball_damping: Option<f64>,

    /// Do not write equilibrium_positions.parquet, the large table
    #[arg(long)]
    pub(super) no_set: bool,

    #[command(flatten)]
    threads: ThreadsArgument,

    /// Print neither table nor messages
    #[arg(long, short)]
    pub(super) quiet: bool,

    /// Print the result as JSON
    #[arg(long)]
    pub(super) json: bool,
}

fn grid(text: &str) -> Result<usize, String> {
    let allowed = format!("a whole number from {FEWEST_GRID_POINTS}");
    parsed(text, allowed, |points| *points >= FEWEST_GRID_POINTS)
}

fn samples(text: &str) -> Result<u32, String> {
    let [fewest, most] = SAMPLE_COUNTS;
    parsed(text, format!("a power of two from {fewest} to {most}"), |samples: &u32| {
        (fewest..=most).contains(samples) && samples.is_power_of_two()
    })
}

fn ball_damping(text: &str) -> Result<f64, String> {
    let allowed = format!("a number above 0, up to {MOST_BALL_DAMPING}");
    parsed(text, allowed, |damping| *damping > 0.0 && *damping <= MOST_BALL_DAMPING)
}

/// The largest number of rows of `equilibrium_positions.parquet`.
const MOST_ROWS: u64 = 1 << 30;

/// Refuses a table of positions that would be too large; there are `positions` at each point, or too many to count.
///
/// # Errors
/// Returns an error if it would.
pub(super) fn check_rows(
    arguments: &Arguments,
    study: &Study,
    positions: Option<u64>,
) -> Result<(), CliError> {
    let rows = positions.and_then(|positions| positions.checked_mul(study.point_count()));
    if arguments.no_set || rows.is_some_and(|rows| rows <= MOST_ROWS) {
        return Ok(());
    }
    let (positions, points) = (positions.unwrap_or(u64::MAX), study.point_count());
    let found = format!("{positions} positions at each of {points} points of the sweep");
    let allowed = format!(
        "{MOST_ROWS} rows; use --no-set to leave that table out, or a coarser grid, fewer \
         samples or fewer points"
    );
    Err(CliError::refusal("equilibrium_positions.parquet would be too large", found, allowed))
}

/// What the command prints.
pub(super) struct Printed {
    /// The result as JSON, if it is printed so.
    pub(super) json: Value,
    pub(super) text: String,
    pub(super) warning: Option<String>,
}

/// Writes the tables that `compute` fills, and prints its result.
///
/// # Errors
/// Returns an error if the output directory cannot be used, or the error of `compute`.
pub(super) fn write<P: Send, S: Send, E: Send>(
    arguments: &Arguments,
    study: &Study,
    columns: EquilibriumColumns<P, S, E>,
    options: &Value,
    compute: impl FnOnce(&mut EquilibriumTables<P, S, E>, &Path) -> Result<Printed, CliError> + Send,
) -> Result<End, CliError> {
    let directory = results_directory(arguments.out.as_ref(), study, "-equilibria");
    let pool = arguments.threads.start()?;
    let started = Instant::now();
    let files = columns.files();
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let mut place = ExclusiveDirectory::open(&directory, &files)?;
    let mut tables = EquilibriumTables::create(&directory, study, columns, options)?;
    let Printed { json, text, warning } = pool.install(|| compute(&mut tables, &directory))?;
    tables.finish(&mut place.list)?;
    place.finish()?;
    if arguments.json || !arguments.quiet {
        print_result(arguments.json, || json, || text)?;
    }
    if !arguments.quiet {
        let (points, seconds) = (study.point_count(), started.elapsed().as_secs_f64());
        say(&format!("{} in {seconds:.1} s", counted(points, "equilibrium set")));
        if let Some(warning) = warning {
            say(&warning);
        }
        say(&format!("tables in {}", directory.display()));
    }
    Ok(End::Well)
}
