//! The equilibrium sets, steady sliding and frictionless equilibria of any system but a ball balancer.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};

use super::check_points::in_words;
use super::equilibria_tables::{Arguments, Printed, check_rows, write};
use super::output::{CliError, End};
use super::points_table::MOST_LINES;
use crate::analysis::REPLICATES;
use crate::check::{HeldSet, SteadySearch, SteadyValues};
use crate::model::Model;
use crate::printed_table::{PrintedTable, as_text};
use crate::responses::{merged, point_keys};
use crate::study::Study;
use crate::table::{
    EquilibriumTables, HeldPositionRow, HeldSetRow, PointKey, SteadyStateRow, places,
    steady_columns,
};

/// The number of samples without `--samples`.
const SAMPLES: u32 = 1 << 16;

/// The kinds of states in `steady_states.parquet`.
const SLIDING: &str = "sliding";
const WITHOUT_FRICTION: &str = "without_dry_friction";

/// Computes the sets and steady states of a system and writes their tables.
pub(super) fn equilibria_of_system(arguments: &Arguments, study: &Study) -> Result<End, CliError> {
    let of_balls = [
        ("--grid", arguments.grid.is_some()),
        ("--speeds", arguments.speeds.is_some()),
        ("--ball-damping", arguments.ball_damping.is_some()),
    ];
    if let Some((option, _)) = of_balls.iter().find(|(_, is_given)| *is_given) {
        let found = format!("a study of kind {}", study.model().kind().name);
        let what = format!("{option} serves the ball balancer");
        return Err(CliError::refusal(what, found, "--samples SAMPLES, --no-set"));
    }
    examined(study, 0, |_, _| ())?;
    let samples = arguments.samples.unwrap_or(SAMPLES);
    check_rows(arguments, study, Some(u64::from(samples)))?;
    let options = json!({"samples": samples, "scrambles": REPLICATES});
    let columns = steady_columns(study, !arguments.no_set);
    write(arguments, study, columns, &options, |tables, directory| {
        let points = compute(study, samples / REPLICATES, tables)?;
        let json = arguments.json.then(|| as_json(study, &points, &options, directory));
        Ok(Printed {
            json: json.unwrap_or_default(),
            text: as_words(study, &points),
            warning: None,
        })
    })
}

/// A point of the sweep.
struct PointStates {
    row: HeldSetRow,
    sliding: Vec<SteadyValues>,
    without_friction: Vec<SteadyValues>,
}

fn compute(
    study: &Study,
    samples: u32,
    tables: &mut EquilibriumTables<HeldPositionRow, HeldSetRow, SteadyStateRow>,
) -> Result<Vec<PointStates>, CliError> {
    let compute = |point_id: u64| {
        let key = Arc::new(PointKey::of(&study.point(point_id)));
        let (set, places, states) = examined(study, point_id, |search, model| {
            let set = HeldSet::of(search, samples);
            let places = places(study, model);
            let row = HeldSetRow::new(&key, &places, &set);
            let (sliding, without_friction) = (search.sliding(), search.without_dry_friction());
            (set, places, PointStates { row, sliding, without_friction })
        })?;
        tables.sets.push(states.row.clone())?;
        let kinds = [(SLIDING, &states.sliding), (WITHOUT_FRICTION, &states.without_friction)];
        for (kind, of) in kinds {
            let row = |state: &SteadyValues| SteadyStateRow {
                point: Arc::clone(&key),
                kind,
                state: state.clone(),
            };
            tables.states.extend(of.iter().map(row))?;
        }
        if let Some(positions) = &mut tables.positions {
            positions.extend(set.positions.into_iter().map(|position| HeldPositionRow {
                point: Arc::clone(&key),
                places: Arc::clone(&places),
                position,
            }))?;
        }
        Ok(states)
    };
    (0..study.point_count()).map(compute).collect()
}

/// Passes the search at a point of the sweep, and its model, to a function.
///
/// # Errors
/// Returns an error if the search does not serve the system, or if the medians of uncertain parameters are impossible.
fn examined<T>(
    study: &Study,
    point_id: u64,
    examine: impl FnOnce(&SteadySearch<'_>, &Model) -> T,
) -> Result<T, CliError> {
    let (model, ranges) = (study.median_model(point_id), study.point(point_id).start_ranges);
    let model = model.map_err(|error| {
        let found = format!("{error}, with uncertain parameters at their medians");
        CliError::refusal("a point of the sweep is impossible", found, "possible medians")
    })?;
    let search = SteadySearch::new(&model, &ranges).map_err(|reason| {
        let found = format!("a system with {reason}, at point {point_id}");
        let allowed = "a system without these; `stickslip run` finds where its runs end";
        let what = "this command does not examine such a system";
        CliError::refusal(what, found, allowed)
    })?;
    Ok(examine(&search, &model))
}

fn as_words(study: &Study, points: &[PointStates]) -> String {
    let rows = &points[..points.len().min(MOST_LINES)];
    let shown: Vec<_> = rows.iter().map(|point| study.shown(&point.row.point.swept)).collect();
    let mut table = PrintedTable::new(rows, "none");
    table.add_point(|point| point.row.point.point_id, study.swept(), &shown);
    table.add_if_any("held", |point| Some(format!("{:.4}", point.row.fraction?.0)));
    table.add_if_any("95 % interval", |point| {
        let (_, (low, high)) = point.row.fraction?;
        Some(format!("{low:.4} .. {high:.4}"))
    });
    table.add_if_any("steady sliding", |point| in_words(&point.sliding));
    table.add_known("without dry friction", |point| in_words(&point.without_friction));
    let mut text = as_text(&table.columns);
    if points.len() > rows.len() {
        let more = points.len() - rows.len();
        text += &format!("... and {more} more points in equilibrium_set_summary.parquet\n");
    }
    text + LEGEND
}

const LEGEND: &str = "held: fraction of the start positions, with all speeds zero, at which friction holds the contacts\n";

fn as_json(study: &Study, points: &[PointStates], options: &Value, directory: &Path) -> Value {
    let point = |PointStates { row, sliding, without_friction }: &PointStates| {
        let keys = point_keys(row.point.point_id, study.swept(), &row.point.swept);
        let facts = json!({
            "examined_positions": row.examined,
            "fraction": row.fraction.map(|(fraction, _)| fraction),
            "fraction_low": row.fraction.map(|(_, (low, _))| low),
            "fraction_high": row.fraction.map(|(_, (_, high))| high),
            SLIDING: sliding,
            WITHOUT_FRICTION: without_friction,
        });
        merged(keys, facts)
    };
    json!({
        "study": study.name(),
        "out": directory.display().to_string(),
        "options": options,
        "points": points.iter().map(point).collect::<Vec<_>>(),
    })
}
