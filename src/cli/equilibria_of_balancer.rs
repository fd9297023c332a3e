//! The equilibria of ball balancers, in closed form.

use std::sync::Arc;

use rayon::prelude::*;
use serde_json::json;

use super::equilibria_report::EquilibriaReport;
use super::equilibria_tables::{Arguments, Printed, check_rows, write};
use super::output::{CliError, End};
use crate::analysis::{
    EquilibriumSet, FrictionlessEquilibrium, REPLICATES, Resolution, Resolutions, RestForm,
    frictionless_equilibria, reference_amplitude,
};
use crate::model::Machine;
use crate::study::Study;
use crate::table::{
    EquilibriumColumns, EquilibriumTables, FrictionlessRow, PointKey, SetRow, SetSummaryRow,
    frictionless_columns, set_columns, set_summary_columns,
};

/// The viscous drag on the balls of the thesis.
const BALL_DAMPING: f64 = 1e4;

type Tables = EquilibriumTables<SetRow, SetSummaryRow, FrictionlessRow>;

/// Computes the sets of ball balancers and writes their tables.
pub(super) fn equilibria_of_balancer(
    arguments: &Arguments,
    study: &Study,
) -> Result<End, CliError> {
    let resolutions = resolutions(arguments, study)?;
    let options = options(arguments, resolutions);
    let columns = EquilibriumColumns {
        positions: (!arguments.no_set).then(|| set_columns(study)),
        sets: set_summary_columns(study),
        states: (
            "frictionless_equilibria",
            frictionless_columns(study, arguments.speeds.is_some()),
        ),
    };
    write(arguments, study, columns, &options, |tables, directory| {
        let report = compute(arguments, study, resolutions, tables)?;
        let warning = (report.too_coarse > 0).then(|| {
            format!(
                "warning: at {} of them the set has components that are smaller than the grid's spacing and \
                 therefore not all counted (column unresolved_equilibria); choose a finer --grid",
                report.too_coarse
            )
        });
        let json = if arguments.json { report.json(&options, directory) } else { json!(null) };
        Ok(Printed { json, text: report.text(), warning })
    })
}

/// Returns the resolutions of the sets, or an error if they do not fit the study.
fn resolutions(arguments: &Arguments, study: &Study) -> Result<Resolutions, CliError> {
    let resolutions =
        Resolutions::choose(study.numbers_of_balls(), arguments.grid, arguments.samples)
            .map_err(CliError::Usage)?;
    let positions = study.numbers_of_balls().map(|balls| resolutions.of(balls).positions(balls));
    // `None` is an overflow.
    let positions = positions.reduce(|left, right| Some(left?.max(right?))).flatten();
    check_rows(arguments, study, positions)?;
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
        "ball_damping": arguments.ball_damping.unwrap_or(BALL_DAMPING),
        "speeds": speeds,
    })
}

fn compute<'a>(
    arguments: &Arguments,
    study: &'a Study,
    resolutions: Resolutions,
    tables: &mut Tables,
) -> Result<EquilibriaReport<'a>, CliError> {
    let unknown = || CliError::Usage(format!("no model for {} balls", study.model().balls()));
    let damping = arguments.ball_damping.unwrap_or(BALL_DAMPING);
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
    tables: &mut Tables,
) -> Result<(), CliError> {
    let speed_rad_s = machine.speed_rad_s;
    for equilibrium in found {
        report.push_frictionless(speed_rad_s, &equilibrium);
        let point = Arc::clone(point);
        tables.states.push(FrictionlessRow { point, speed_rad_s, equilibrium })?;
    }
    Ok(())
}
