//! `stickslip equilibria`: computes equilibrium sets in closed form, without simulation.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use rayon::prelude::*;
use serde_json::json;

use super::arguments::{StudyArgument, ThreadsArgument, parsed, results_directory};
use super::equilibria_report::EquilibriaReport;
use super::output::{CliError, End, print_result};
use super::range::{EvenRange, speeds};
use crate::analysis::{
    EquilibriumSet, FEWEST_GRID_POINTS, FrictionlessEquilibrium, MOST_BALL_DAMPING, REPLICATES,
    Resolution, Resolutions, RestForm, SAMPLE_COUNTS, frictionless_equilibria, reference_amplitude,
};
use crate::engine::{ExclusiveDirectory, say};
use crate::model::Machine;
use crate::numbers::counted;
use crate::study::Study;
use crate::table::{EquilibriumTables, FrictionlessRow, PointKey, SetRow, SetSummaryRow};

const EXAMPLES: &str = "\
Examples:
  stickslip equilibria studies/preferred-equilibria.yaml
  stickslip equilibria study.yaml --grid 2048 --no-set
  stickslip equilibria study.yaml --speeds -150:-300:151     the thesis's figure 5.1 as a table
  stickslip equilibria three-balls.yaml --samples 262144

Computes where the balls can rest, in closed form, without simulation. The directory holds \
equilibrium_positions.parquet (a row per ball position: amplitude, required friction, margin), \
equilibrium_set_summary.parquet (a row per point of the sweep: fraction of all positions, connected components, \
amplitudes, balance), frictionless_equilibria.parquet (equilibria without dry friction and their stability) and \
files.json (the hash of each file). A table of more than 524,288 rows is a directory of that name, with files of \
524,288 rows each.

After an interruption the same command continues in the same directory; it overwrites no other file. At a \
speed of 0 no force acts, and every position is an equilibrium. Read the tables with any Parquet reader; \
`stickslip run` computes which of the equilibria a machine comes to rest at.";

/// Compute equilibrium sets, and equilibria without friction, in closed form
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Directory for the tables; never overwritten [default: results/<name of the study>-equilibria]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    /// One or two balls: grid points per axis, at 2π k/G [default: 512]
    #[arg(long, value_name = "G", value_parser = grid, allow_negative_numbers = true)]
    grid: Option<usize>,

    /// Three or more balls: number of quasi-random samples, a power of two [default: 65536]
    #[arg(long, value_name = "SAMPLES", value_parser = samples, allow_negative_numbers = true)]
    samples: Option<u32>,

    /// Compute the frictionless equilibria at COUNT speeds from FROM to TO [rad/s], with the parameters under
    /// `model`, instead of at the points of the sweep
    #[arg(long, value_name = "FROM:TO:COUNT", value_parser = speeds, allow_hyphen_values = true)]
    speeds: Option<EvenRange>,

    /// Viscous drag on the balls, divided by ball mass and natural frequency, which determines the stability of
    /// the frictionless equilibria
    ///
    /// The default is that of the thesis, so high that larger values do not change the stability.
    #[arg(long, value_name = "C", default_value = "1e4", value_parser = ball_damping)]
    #[arg(allow_negative_numbers = true)]
    ball_damping: f64,

    /// Do not write equilibrium_positions.parquet, the large table
    #[arg(long)]
    no_set: bool,

    #[command(flatten)]
    threads: ThreadsArgument,

    /// Print neither table nor messages
    #[arg(long, short)]
    quiet: bool,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// The largest number of rows of `equilibrium_positions.parquet`.
const MOST_ROWS: u64 = 1 << 30;

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

/// Computes the sets and writes their tables.
///
/// # Errors
/// Returns an error if the study, the options or the output directory cannot be used, or if a table cannot be
/// written.
pub fn equilibria(arguments: &Arguments) -> Result<End, CliError> {
    let study = arguments.study.load()?;
    check_model(&study)?;
    let resolutions = resolutions(arguments, &study)?;
    let directory = results_directory(arguments.out.as_ref(), &study, "-equilibria");
    let (positions, own_speeds) = (!arguments.no_set, arguments.speeds.is_some());
    let options = options(arguments, resolutions);
    let pool = arguments.threads.start()?;
    let started = Instant::now();
    let mut place = ExclusiveDirectory::open(&directory, &EquilibriumTables::names(positions))?;
    let mut tables =
        EquilibriumTables::create(&directory, &study, positions, own_speeds, &options)?;
    let report = pool.install(|| compute(arguments, &study, resolutions, &mut tables))?;
    tables.finish(&mut place.list)?;
    place.finish()?;
    if arguments.json || !arguments.quiet {
        let json = || report.json(&options, &directory);
        print_result(arguments.json, json, || report.text())?;
    }
    if !arguments.quiet {
        let (points, seconds) = (study.point_count(), started.elapsed().as_secs_f64());
        say(&format!("{} in {seconds:.1} s", counted(points, "equilibrium set")));
        if report.too_coarse > 0 {
            say(&format!(
                "warning: at {} of them the set has components that are smaller than the grid's spacing and \
                 therefore not all counted (column unresolved_equilibria); choose a finer --grid",
                report.too_coarse
            ));
        }
        say(&format!("tables in {}", directory.display()));
    }
    Ok(End::Well)
}

/// Returns an error for studies without balls: a block on a spring rests anywhere in `|x| ≤ μ F_n / k`, and on a
/// moving belt nowhere.
fn check_model(study: &Study) -> Result<(), CliError> {
    if study.model().kind().offers.equilibrium_set {
        return Ok(());
    }
    let kind = study.model().kind().name;
    let allowed = "kind ball_balancer; a block on a spring rests anywhere in |x| <= friction_coefficient * \
                   normal_force_n / stiffness_n_m";
    let found = format!("a study of kind {kind}");
    Err(CliError::refusal("this command serves the ball balancer", found, allowed))
}

/// Returns the resolutions of the sets, or an error if they do not fit the study.
fn resolutions(arguments: &Arguments, study: &Study) -> Result<Resolutions, CliError> {
    let resolutions =
        Resolutions::choose(study.numbers_of_balls(), arguments.grid, arguments.samples)
            .map_err(CliError::Usage)?;
    let positions = study.numbers_of_balls().map(|balls| resolutions.of(balls).positions(balls));
    // `None` is an overflow.
    let positions = positions.reduce(|left, right| Some(left?.max(right?))).flatten();
    let rows = positions.and_then(|positions| positions.checked_mul(study.point_count()));
    if !arguments.no_set && rows.is_none_or(|rows| rows > MOST_ROWS) {
        let found = format!(
            "{} positions at each of {} points of the sweep",
            positions.unwrap_or(u64::MAX),
            study.point_count()
        );
        let allowed = format!(
            "{MOST_ROWS} rows; use --no-set to leave that table out, or a coarser grid, fewer \
             samples or fewer points"
        );
        let what = "equilibrium_positions.parquet would be too large";
        return Err(CliError::refusal(what, found, allowed));
    }
    Ok(resolutions)
}

/// Returns the options that determine the tables besides the study.
fn options(arguments: &Arguments, resolutions: Resolutions) -> serde_json::Value {
    let both = [resolutions.few, resolutions.more];
    let grid = both.iter().find_map(|resolution| match resolution {
        Resolution::Grid(points) => Some(*points),
        Resolution::Samples(_) => None,
    });
    let samples = both.iter().find_map(|resolution| match resolution {
        Resolution::Grid(_) => None,
        Resolution::Samples(samples) => Some(u64::from(*samples) * u64::from(REPLICATES)),
    });
    let speeds = arguments.speeds.map(|speeds| {
        let ends = [speeds.values().next(), speeds.values().last()];
        json!({"from_rad_s": ends[0], "to_rad_s": ends[1], "count": speeds.count})
    });
    json!({
        "grid": grid,
        "samples": samples,
        "scrambles": samples.map(|_| REPLICATES),
        "ball_damping": arguments.ball_damping,
        "speeds": speeds,
    })
}

fn compute<'a>(
    arguments: &Arguments,
    study: &'a Study,
    resolutions: Resolutions,
    tables: &mut EquilibriumTables,
) -> Result<EquilibriaReport<'a>, CliError> {
    let unknown = || CliError::Usage(format!("no model for {} balls", study.model().balls()));
    let damping = arguments.ball_damping;
    let mut report = EquilibriaReport::new(study, arguments.json, arguments.speeds.is_some());
    for point_id in 0..study.point_count() {
        let point = study.point(point_id);
        let machine = point.model().ball_balancer().ok_or_else(unknown)?;
        let key = Arc::new(PointKey::of(&point));
        let resolution = resolutions.of(machine.balls.len());
        let set = EquilibriumSet::of(machine, resolution).ok_or_else(unknown)?;
        let amplitude_without_balls_m = reference_amplitude(machine);
        let row = SetSummaryRow { point: Arc::clone(&key), set, amplitude_without_balls_m };
        let frictionless = if arguments.speeds.is_some() {
            Vec::new()
        } else {
            frictionless_equilibria(machine, damping).ok_or_else(unknown)?
        };
        report.push_point(&row, &frictionless);
        tables.sets.push(row)?;
        push_frictionless(&key, machine, frictionless, &mut report, tables)?;
        if let Some(positions) = &mut tables.positions {
            let form = RestForm::new(machine).ok_or_else(unknown)?;
            resolution.visit(&form, |beta, rest| positions.push(SetRow::new(&key, beta, rest)))?;
        }
    }
    let Some(speeds) = arguments.speeds else { return Ok(report) };
    let key = FrictionlessRow::no_point();
    let base = study.model().ball_balancer().ok_or_else(unknown)?;
    let speeds: Vec<f64> = speeds.values().collect();
    for piece in speeds.chunks(1024) {
        let at = |speed_rad_s: &f64| {
            let machine = Machine { speed_rad_s: *speed_rad_s, ..base.clone() };
            frictionless_equilibria(&machine, damping).map(|found| (machine, found))
        };
        let found: Vec<Option<(Machine, Vec<_>)>> = piece.par_iter().map(at).collect();
        if found.iter().any(Option::is_none) {
            return Err(unknown());
        }
        for (machine, found) in found.into_iter().flatten() {
            push_frictionless(&key, &machine, found, &mut report, tables)?;
        }
    }
    Ok(report)
}

fn push_frictionless(
    point: &Arc<PointKey>,
    machine: &Machine,
    found: Vec<FrictionlessEquilibrium>,
    report: &mut EquilibriaReport,
    tables: &mut EquilibriumTables,
) -> Result<(), CliError> {
    let speed_rad_s = machine.speed_rad_s;
    for equilibrium in found {
        report.push_frictionless(speed_rad_s, &equilibrium);
        let point = Arc::clone(point);
        tables.frictionless.push(FrictionlessRow { point, speed_rad_s, equilibrium })?;
    }
    Ok(())
}
