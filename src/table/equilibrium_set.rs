//! The output directory of `stickslip equilibria`: `equilibrium_positions.parquet` with one row per position of the balls,
//! `equilibrium_set_summary.parquet` with one row per point of the sweep, and `frictionless_equilibria.parquet` with the
//! equilibria without dry friction and their stability.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;

use super::column::{Column, Columns};
use super::file_list::FileList;
use super::of_point::{PointKey, add_point};
use super::provenance::provenance_with;
use super::table_files::TableFiles;
use super::writer::{TableWriter, WriteError};
use crate::analysis::{AtRest, Balance, EquilibriumSet, FrictionlessEquilibrium};
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

/// A frictionless equilibrium at a point of the sweep or at a speed.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionlessRow {
    /// The point of the sweep; at given speeds, an empty point.
    pub point: Arc<PointKey>,
    /// Speed of the disc, rad/s.
    pub speed_rad_s: f64,
    /// The equilibrium.
    pub equilibrium: FrictionlessEquilibrium,
}

impl FrictionlessRow {
    /// Returns the key of a speed that is not a point of the sweep.
    pub fn no_point() -> Arc<PointKey> {
        Arc::new(PointKey { point_id: 0, swept: Vec::new() })
    }
}

/// Returns the columns of `frictionless_equilibria.parquet`, with the swept parameters, or with the
/// speed alone for `own_speeds`.
pub fn frictionless_columns(study: &Study, own_speeds: bool) -> Vec<Column<FrictionlessRow>> {
    let mut list = Columns::<FrictionlessRow>::new();
    if !own_speeds {
        add_point(&mut list, study, |row| &row.point);
    }
    let speed = "speed_rad_s";
    if own_speeds || study.swept().iter().all(|column| column.name != speed) {
        list.number(speed, "rad/s", |row| row.speed_rad_s)
            .meaning("speed of the disc; a negative speed is clockwise");
    }
    list.word("kind", |row| row.equilibrium.kind.name()).meaning(
        "kind: a1_plus and a1_minus (all balls together), a2 (two balls opposite each other), b1 \
         (balanced), other (balls on one line), everywhere (the disc is at rest)",
    );
    for ball in 0..study.model().balls() {
        list.number(format!("beta_{}_rad", ball + 1), "rad", move |row| {
            row.equilibrium.beta_rad.as_ref()?.get(ball).copied()
        })
        .meaning(
            "angle of the ball from the imbalance, in [0, 2π), in ascending order for identical \
             balls; for a family, one position",
        );
    }
    list.number("x_m", "m", |row| row.equilibrium.position_m[0])
        .meaning("position of the disc's centre towards the imbalance");
    list.number("y_m", "m", |row| row.equilibrium.position_m[1])
        .meaning("position of the disc's centre perpendicular to x");
    list.number("amplitude_m", "m", |row| row.equilibrium.amplitude_m())
        .meaning("amplitude of the table's vibration");
    list.count("family_dimension", |row| row.equilibrium.family_dimension as u64)
        .meaning("dimension of the family of equilibria that it belongs to; 0 if isolated");
    list.word("stability", |row| row.equilibrium.stability.name()).meaning(
        "stable, unstable, marginal or unknown, from the linearised equations with viscous drag on \
         the balls, excluding the directions along a family",
    );
    for index in 0..2 * (2 + study.model().balls()) {
        let number = index + 1;
        list.number(format!("eigenvalue_{number}_real_per_s"), "1/s", move |row| {
            row.equilibrium.eigenvalues_per_s.get(index).map(|value| value.re)
        })
        .meaning("growth rate of a small disturbance, in descending order");
        list.number(format!("eigenvalue_{number}_imag_rad_s"), "rad/s", move |row| {
            row.equilibrium.eigenvalues_per_s.get(index).map(|value| value.im)
        })
        .meaning("angular frequency of that disturbance in the rotating frame");
    }
    list.finish()
}

/// The tables, open for writing: rows of positions, of points, and of states.
pub struct EquilibriumTables<P, S, E> {
    directory: PathBuf,
    /// `equilibrium_positions.parquet`, if it is written.
    pub positions: Option<TableWriter<P, TableFiles>>,
    /// `equilibrium_set_summary.parquet`.
    pub sets: TableWriter<S, TableFiles>,
    /// The table of the states.
    pub states: TableWriter<E, TableFiles>,
}

/// The columns of [`EquilibriumTables`].
pub struct EquilibriumColumns<P, S, E> {
    /// The columns of the positions, if their table, which is large, is written.
    pub positions: Option<Vec<Column<P>>>,
    /// The columns of the points.
    pub sets: Vec<Column<S>>,
    /// The name of the table of the states, and its columns.
    pub states: (&'static str, Vec<Column<E>>),
}

impl<P, S, E> EquilibriumColumns<P, S, E> {
    /// Returns the file names of the tables.
    pub fn files(&self) -> Vec<String> {
        let positions = self.positions.is_some().then_some("equilibrium_positions");
        let names = positions.into_iter().chain(["equilibrium_set_summary", self.states.0]);
        names.map(|name| format!("{name}.parquet")).collect()
    }
}

impl<P, S, E> EquilibriumTables<P, S, E> {
    /// Starts the tables in a directory. The `options` determine the tables and are part of their metadata.
    ///
    /// # Errors
    /// Returns an error if the directory is not writable.
    pub fn create(
        directory: &Path,
        study: &Study,
        columns: EquilibriumColumns<P, S, E>,
        options: &Value,
    ) -> Result<Self, WriteError> {
        let place = |name: &str| {
            let path = directory.join(format!("{name}.parquet"));
            (path, provenance_with(study, name, options))
        };
        let positions = columns.positions.map(|columns| {
            let (path, about) = place("equilibrium_positions");
            TableWriter::create(&path, columns, &about)
        });
        let (sets, of_sets) = place("equilibrium_set_summary");
        let (states, of_states) = place(columns.states.0);
        Ok(EquilibriumTables {
            directory: directory.to_owned(),
            positions: positions.transpose()?,
            sets: TableWriter::create(&sets, columns.sets, &of_sets)?,
            states: TableWriter::create(&states, columns.states.1, &of_states)?,
        })
    }

    /// Finishes all tables and adds their files to the list of the directory. No existing table is
    /// replaced.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written, or if its name is taken.
    pub fn finish(self, list: &mut FileList) -> Result<(), WriteError> {
        let directory = self.directory.as_path();
        if let Some(positions) = self.positions {
            positions.finish_after(false, |files| list.announce(directory, files))?;
        }
        self.sets.finish_after(false, |files| list.announce(directory, files))?;
        self.states.finish_after(false, |files| list.announce(directory, files))
    }
}
