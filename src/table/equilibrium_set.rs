//! `equilibrium_positions.parquet` with one row per position of the balls, and
//! `equilibrium_set_summary.parquet` with one row per point of the sweep.

use std::sync::Arc;

use super::column::Column;
use super::runs::swept_columns;
use crate::analysis::{AtRest, Balance, EquilibriumSet};
use crate::model::MAX_BALLS;
use crate::study::{ParameterValue, Point, Study};

/// The point of the sweep that a row belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct PointKey {
    /// Number of the point, from 0.
    pub point_id: u64,
    /// Values of the swept parameters, in the order of [`Study::swept`].
    pub swept: Vec<ParameterValue>,
}

impl PointKey {
    /// Returns the key of a point.
    pub fn of(point: &Point) -> Self {
        PointKey { point_id: point.point_id, swept: point.swept.clone() }
    }
}

/// One position of the balls.
#[derive(Clone, Debug, PartialEq)]
pub struct SetRow {
    point: Arc<PointKey>,
    beta_rad: [f64; MAX_BALLS],
    rest: AtRest,
}

impl SetRow {
    /// Creates the row of a position, which has one angle per ball.
    pub fn new(point: &Arc<PointKey>, beta_rad: &[f64], rest: AtRest) -> Self {
        let mut angles = [0.0; MAX_BALLS];
        for (angle, beta) in angles.iter_mut().zip(beta_rad) {
            *angle = *beta;
        }
        SetRow { point: Arc::clone(point), beta_rad: angles, rest }
    }
}

/// One point of the sweep with its equilibrium set.
#[derive(Clone, Debug, PartialEq)]
pub struct SetSummaryRow {
    /// The point.
    pub point: Arc<PointKey>,
    /// Its equilibrium set.
    pub set: EquilibriumSet,
    /// Number of evaluated positions.
    pub positions: u64,
}

/// Returns the columns that identify the point of the sweep; `point` gets it from a row.
pub(super) fn key_columns<R: 'static>(study: &Study, point: fn(&R) -> &PointKey) -> Vec<Column<R>> {
    let mut columns =
        vec![Column::count("point_id", "number of the sweep's point, from 0", move |row| {
            Some(point(row).point_id)
        })];
    columns.extend(swept_columns(study, move |row| &point(row).swept));
    columns
}

/// Returns the columns of `equilibrium_positions.parquet`.
pub fn set_columns(study: &Study) -> Vec<Column<SetRow>> {
    let mut columns = key_columns(study, |row: &SetRow| &row.point);
    for ball in 0..study.model().balls().min(MAX_BALLS) {
        columns.push(Column::number(
            &format!("beta_{}_rad", ball + 1),
            "rad",
            "angle at which the ball is held, from the imbalance, in [0, 2π)",
            move |row: &SetRow| Some(row.beta_rad[ball]),
        ));
    }
    columns.extend([
        Column::number(
            "amplitude_m",
            "m",
            "amplitude of the table's vibration with the balls held there",
            |row: &SetRow| Some(row.rest.amplitude_m),
        ),
        Column::number(
            "required_friction_coefficient",
            "1",
            "smallest common friction coefficient that holds all balls there; null if a normal \
             force would have to pull",
            |row: &SetRow| Some(row.rest.required_friction),
        ),
        Column::number(
            "friction_margin",
            "1",
            "smallest unused fraction of the friction limit: 0 on the boundary of the equilibrium \
             set, negative outside; null without a limit",
            |row: &SetRow| Some(row.rest.friction_margin()),
        ),
        Column::truth("in_set", "whether friction holds all balls there", |row: &SetRow| {
            Some(row.rest.in_set())
        }),
    ]);
    columns
}

/// Returns the columns of `equilibrium_set_summary.parquet`.
pub fn set_summary_columns(study: &Study) -> Vec<Column<SetSummaryRow>> {
    let mut columns = key_columns(study, |row: &SetSummaryRow| &row.point);
    let number =
        |name: &str, unit: &str, meaning: &str, value: fn(&SetSummaryRow) -> Option<f64>| {
            Column::number(name, unit, meaning, value)
        };
    columns.extend([
        Column::count(
            "grid_positions",
            "evaluated ball positions: grid points or samples; for one ball, fraction, components \
             and amplitudes are exact for any grid",
            |row: &SetSummaryRow| Some(row.positions),
        ),
        number("fraction", "1", "fraction of all ball positions that are in the set", |row| {
            Some(row.set.fraction)
        }),
        number(
            "fraction_low",
            "1",
            "lower end of its 95 % confidence interval (Student's t over independent scrambles); \
             null on a grid",
            |row| row.set.fraction_interval.map(|(low, _)| low),
        ),
        number("fraction_high", "1", "upper end of its 95 % confidence interval; null on a \
                                      grid", |row| {
            row.set.fraction_interval.map(|(_, high)| high)
        }),
        Column::count(
            "components",
            "connected components of the set on the torus of ball angles; null for samples",
            |row: &SetSummaryRow| row.set.components,
        ),
        Column::count(
            "components_modulo_exchange",
            "connected components up to exchange of identical balls; null for samples",
            |row: &SetSummaryRow| row.set.components_modulo_exchange,
        ),
        Column::count(
            "unresolved_equilibria",
            "frictionless equilibria that no grid point represents; above 0, the grid is too coarse \
             to resolve all components; null for samples",
            |row: &SetSummaryRow| row.set.unseen,
        ),
        number(
            "amplitude_min_m",
            "m",
            "smallest amplitude in the set, 0 where the balls can balance; null in an empty set",
            |row| row.set.amplitude_m.map(|(smallest, _)| smallest),
        ),
        number(
            "amplitude_max_m",
            "m",
            "largest amplitude in the set; null in an empty set",
            |row| row.set.amplitude_m.map(|(_, largest)| largest),
        ),
    ]);
    columns.extend(angle_columns(
        study,
        "min_amplitude_beta",
        "angle of the ball where the amplitude in the set is smallest",
        |row| row.set.min_amplitude_beta_rad.as_deref(),
    ));
    columns.push(Column::word(
        "balance",
        "where the balls balance the imbalance: nowhere, at a position and its mirror image, or in \
         a family of positions",
        |row: &SetSummaryRow| row.set.balance.name(),
    ));
    columns.extend(angle_columns(
        study,
        "balance_beta",
        "angle of the ball where all balls balance the imbalance; null if there is no such \
         position or a family of them",
        |row| match &row.set.balance {
            Balance::Position(beta) => Some(beta),
            Balance::Nowhere | Balance::Family { .. } => None,
        },
    ));
    columns
}

fn angle_columns(
    study: &Study,
    name: &str,
    meaning: &str,
    angles: fn(&SetSummaryRow) -> Option<&[f64]>,
) -> Vec<Column<SetSummaryRow>> {
    let column = |ball: usize| {
        let name = format!("{name}_{}_rad", ball + 1);
        let value = move |row: &SetSummaryRow| angles(row)?.get(ball).copied();
        Column::number(&name, "rad", meaning, value)
    };
    (0..study.model().balls()).map(column).collect()
}
