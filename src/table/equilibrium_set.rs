//! `equilibrium_positions.parquet` with one row per position of the balls, and
//! `equilibrium_set_summary.parquet` with one row per point of the sweep.

use std::sync::Arc;

use super::column::{Column, Columns};
use super::point_key::{PointKey, add_point};
use crate::analysis::{AtRest, Balance, EquilibriumSet};
use crate::model::MAX_BALLS;
use crate::study::Study;

/// One position of the balls.
#[derive(Clone, Debug, PartialEq)]
pub struct SetRow {
    point: Arc<PointKey>,
    /// The angle of each ball; not a number for balls that the point does not have.
    beta_rad: [f64; MAX_BALLS],
    rest: AtRest,
}

impl SetRow {
    /// Creates the row of a position, which has one angle per ball.
    pub fn new(point: &Arc<PointKey>, beta_rad: &[f64], rest: AtRest) -> Self {
        let mut angles = [f64::NAN; MAX_BALLS];
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
    /// Amplitude of the same machine without balls, m.
    pub amplitude_without_balls_m: Option<f64>,
}

/// Returns the columns of `equilibrium_positions.parquet`.
pub fn set_columns(study: &Study) -> Vec<Column<SetRow>> {
    let mut list = Columns::<SetRow>::new();
    add_point(&mut list, study, |row| &row.point);
    for ball in 0..study.model().balls().min(MAX_BALLS) {
        list.number(format!("beta_{}_rad", ball + 1), "rad", move |row| row.beta_rad[ball])
            .meaning("angle at which the ball is held, from the imbalance, in [0, 2π)");
    }
    list.number("amplitude_m", "m", |row| row.rest.amplitude_m)
        .meaning("amplitude of the table's vibration with the balls held there");
    list.number("required_friction_coefficient", "1", |row| row.rest.required_friction).meaning(
        "smallest common friction coefficient that holds all balls there; null if a normal force \
         would have to pull, and where balls with contact overlap",
    );
    list.number("friction_margin", "1", |row| row.rest.friction_margin()).meaning(
        "smallest unused fraction of the friction limit: 0 on the boundary of the equilibrium set, \
         negative outside; null without a limit, and where balls with contact overlap",
    );
    list.boolean("in_set", |row| row.rest.in_set())
        .meaning("whether friction holds all balls there");
    list.finish()
}

/// Returns the columns of `equilibrium_set_summary.parquet`.
pub fn set_summary_columns(study: &Study) -> Vec<Column<SetSummaryRow>> {
    let mut list = Columns::<SetSummaryRow>::new();
    add_point(&mut list, study, |row| &row.point);
    list.count("grid_positions", |row| row.set.positions).meaning(
        "evaluated ball positions: grid points or samples; for one ball, fraction, components and \
         amplitudes are exact for any grid",
    );
    list.number("fraction", "1", |row| row.set.fraction).meaning(
        "fraction of all ball positions that are in the set; with contact, of those without overlap",
    );
    list.number("fraction_low", "1", |row| row.set.fraction_interval.map(|(low, _)| low)).meaning(
        "lower end of its 95 % confidence interval (Student's t over independent scrambles); null \
         on a grid",
    );
    list.number("fraction_high", "1", |row| row.set.fraction_interval.map(|(_, high)| high))
        .meaning("upper end of its 95 % confidence interval; null on a grid");
    list.number("touching_fraction", "1", |row| row.set.touching_fraction).meaning(
        "fraction of the positions in which two balls touch that are in the set, with the force \
         between the balls; null without contact",
    );
    list.count("components", |row| row.set.components)
        .meaning("connected components of the set on the torus of ball angles; null for samples");
    list.count("components_modulo_exchange", |row| row.set.components_modulo_exchange)
        .meaning("connected components up to exchange of identical balls; null for samples");
    list.count("unresolved_equilibria", |row| row.set.unseen).meaning(
        "frictionless equilibria that no grid point represents; above 0, the grid is too coarse to \
         resolve all components; null for samples",
    );
    list.number("amplitude_min_m", "m", |row| row.set.amplitude_m.map(|(least, _)| least)).meaning(
        "smallest amplitude in the set, 0 where the balls can balance; null in an empty set",
    );
    list.number("amplitude_max_m", "m", |row| row.set.amplitude_m.map(|(_, largest)| largest))
        .meaning("largest amplitude in the set; null in an empty set");
    list.number("amplitude_without_balls_m", "m", |row| row.amplitude_without_balls_m)
        .meaning("amplitude of the same machine without balls, whose mass is also removed");
    for ball in 0..study.model().balls() {
        list.number(format!("min_amplitude_beta_{}_rad", ball + 1), "rad", move |row| {
            row.set.min_amplitude_beta_rad.as_ref()?.get(ball).copied()
        })
        .meaning("angle of the ball where the amplitude in the set is smallest");
    }
    list.word("balance", |row| row.set.balance.name()).meaning(
        "where the balls balance the imbalance: nowhere, at a position and its mirror image, or in \
         a family of positions",
    );
    for ball in 0..study.model().balls() {
        list.number(format!("balance_beta_{}_rad", ball + 1), "rad", move |row| {
            match &row.set.balance {
                Balance::Position(beta) => beta.get(ball).copied(),
                Balance::Nowhere | Balance::Family { .. } => None,
            }
        })
        .meaning(
            "angle of the ball where all balls balance the imbalance; null if there is no such \
             position or a family of them",
        );
    }
    list.finish()
}
