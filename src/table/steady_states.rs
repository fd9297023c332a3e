//! The tables of `stickslip equilibria` for a system of one's own: `equilibrium_positions.parquet` with one row per start position,
//! `equilibrium_set_summary.parquet` with one row per point of the sweep, and `steady_states.parquet` with the states in which all
//! contacts slide steadily and the equilibria without friction.

use std::sync::Arc;

use super::column::{Column, Columns};
use super::equilibrium_set::EquilibriumColumns;
use super::of_point::{PointKey, add_point};
use crate::check::{HeldPosition, HeldSet, SteadyValues};
use crate::model::{Model, OutputName};
use crate::study::Study;

/// The places of the coordinates of the study in the coordinates of a point, which may have fewer bodies.
pub type Places = Arc<[Option<usize>]>;

/// Returns the places of the coordinates of a study in those of the model at a point.
pub fn places(study: &Study, model: &Model) -> Places {
    let there = coordinates(model);
    let place = |name: &OutputName| there.iter().position(|other| other.name == name.name);
    coordinates(study.model()).iter().map(place).collect()
}

/// Returns the names of the coordinates of a model.
fn coordinates(model: &Model) -> Vec<OutputName> {
    model.output_names().into_iter().take(model.coordinate_count() / 2).collect()
}

/// A start position.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldPositionRow {
    /// The point of the sweep.
    pub point: Arc<PointKey>,
    /// The places of the coordinates of the study.
    pub places: Places,
    /// The position.
    pub position: HeldPosition,
}

/// A point of the sweep with its equilibrium set.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldSetRow {
    /// The point.
    pub point: Arc<PointKey>,
    /// The places of the coordinates of the study.
    pub places: Places,
    /// The number of positions that were examined.
    pub examined: u64,
    /// The fraction of the positions in the set, with its 95 % interval.
    pub fraction: Option<(f64, (f64, f64))>,
    /// The least and the greatest value of each coordinate in the set.
    pub extremes: Vec<[f64; 2]>,
}

impl HeldSetRow {
    /// Creates the row of a point.
    pub fn new(point: &Arc<PointKey>, places: &Places, set: &HeldSet) -> Self {
        HeldSetRow {
            point: Arc::clone(point),
            places: Arc::clone(places),
            examined: set.examined,
            fraction: set.fraction,
            extremes: set.extremes(),
        }
    }
}

/// A state of steady sliding, or an equilibrium without friction.
#[derive(Clone, Debug, PartialEq)]
pub struct SteadyStateRow {
    /// The point of the sweep.
    pub point: Arc<PointKey>,
    /// `sliding` or `without_dry_friction`.
    pub kind: &'static str,
    /// The state.
    pub state: SteadyValues,
}

/// Returns the columns of the tables, with those of the positions if they are written.
pub fn steady_columns(
    study: &Study,
    positions: bool,
) -> EquilibriumColumns<HeldPositionRow, HeldSetRow, SteadyStateRow> {
    EquilibriumColumns {
        positions: positions.then(|| position_columns(study)),
        sets: held_set_columns(study),
        states: ("steady_states", steady_state_columns(study)),
    }
}

fn position_columns(study: &Study) -> Vec<Column<HeldPositionRow>> {
    let mut list = Columns::<HeldPositionRow>::new();
    add_point(&mut list, study, |row| &row.point);
    for (place, OutputName { name, unit, meaning }) in
        coordinates(study.model()).into_iter().enumerate()
    {
        let value =
            move |row: &HeldPositionRow| row.position.coordinates.get(row.places[place]?).copied();
        list.number(name, &unit, value).meaning(meaning);
    }
    list.number("friction_margin", "1", |row| row.position.friction_margin).meaning(
        "smallest unused fraction of the friction limit of a contact that sticks: 0 on the boundary of the equilibrium set, \
         negative outside; null if other coordinates have no equilibrium or a contact is not pressed together",
    );
    list.boolean("in_set", |row| row.position.is_held())
        .meaning("whether friction holds all contacts that do not slide");
    list.finish()
}

fn held_set_columns(study: &Study) -> Vec<Column<HeldSetRow>> {
    let mut list = Columns::<HeldSetRow>::new();
    add_point(&mut list, study, |row| &row.point);
    list.count("examined_positions", |row| row.examined)
        .meaning("examined start positions, with all speeds zero");
    list.number("fraction", "1", |row| Some(row.fraction?.0)).meaning(
        "fraction of the start positions that are in the set; null if all contacts slide there",
    );
    list.number("fraction_low", "1", |row| Some(row.fraction?.1.0)).meaning(
        "lower end of its 95 % confidence interval (Student's t over independent scrambles)",
    );
    list.number("fraction_high", "1", |row| Some(row.fraction?.1.1))
        .meaning("upper end of its 95 % confidence interval");
    for (place, OutputName { name, unit, .. }) in coordinates(study.model()).into_iter().enumerate()
    {
        for (side, word) in ["least", "greatest"].into_iter().enumerate() {
            let value =
                move |row: &HeldSetRow| row.extremes.get(row.places[place]?).map(|of| of[side]);
            list.number(format!("{word}_{name}"), &unit, value).meaning(format!(
                "{word} value of a position in the set; null for an angle that goes round"
            ));
        }
    }
    list.finish()
}

fn steady_state_columns(study: &Study) -> Vec<Column<SteadyStateRow>> {
    let mut list = Columns::<SteadyStateRow>::new();
    add_point(&mut list, study, |row| &row.point);
    list.word("kind", |row| row.kind).meaning(
        "sliding (all contacts slide) or without_dry_friction (an equilibrium of the same system without dry friction)",
    );
    let count = study.model().coordinate_count();
    for OutputName { name, unit, .. } in study.model().output_names().into_iter().take(count) {
        let column = name.clone();
        list.number(name, &unit, move |row| row.state.coordinates.get(&column).copied()).meaning(
            "value of the coordinate, or the speed at which it moves on; the other one is null",
        );
    }
    list.count("family_dimension", |row| row.state.family_dimension as u64)
        .meaning("dimension of the family of states that it belongs to; 0 if isolated");
    list.word("stability", |row| row.state.stability.name()).meaning(
        "stable, unstable or marginal against small motions, excluding those along a family",
    );
    for index in 0..count {
        let number = index + 1;
        let value = move |row: &SteadyStateRow| row.state.eigenvalues_1_s.get(index).copied();
        list.number(format!("eigenvalue_{number}_real_per_s"), "1/s", move |row| {
            Some(value(row)?.re)
        })
        .meaning("growth rate of a small motion, in descending order");
        list.number(format!("eigenvalue_{number}_imag_rad_s"), "rad/s", move |row| {
            Some(value(row)?.im)
        })
        .meaning("angular frequency of that motion");
    }
    list.finish()
}
