//! `frictionless_equilibria.parquet`: the equilibria without dry friction and their stability, one row each.

use std::sync::Arc;

use super::column::Column;
use super::set::{PointKey, key_columns};
use crate::analysis::FrictionlessEquilibrium;
use crate::study::{ParameterValue, Study};

/// An equilibrium without friction at a point of the sweep or at a speed.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionlessRow {
    /// The point of the sweep; at speeds of its own one with nothing swept.
    pub point: Arc<PointKey>,
    /// Speed of the disc, rad/s.
    pub speed_rad_s: f64,
    /// The equilibrium.
    pub equilibrium: FrictionlessEquilibrium,
}

/// The columns of `frictionless_equilibria.parquet`: with those of the sweep, or for `own_speeds` with the
/// speed alone.
pub fn frictionless_columns(study: &Study, own_speeds: bool) -> Vec<Column<FrictionlessRow>> {
    let mut columns = Vec::new();
    if !own_speeds {
        columns = key_columns(study, |row: &FrictionlessRow| &row.point);
    }
    let speed = "speed_rad_s";
    if own_speeds || study.swept().iter().all(|column| column.name != speed) {
        let meaning = "speed of the disc; negative turns clockwise";
        columns.push(number(speed, "rad/s", meaning, |row| Some(row.speed_rad_s)));
    }
    columns.push(Column::word(
        "kind",
        "a1_plus and a1_minus (balls together), a2 (two balls opposite each other), b1 (balanced), \
         other (balls on one line), everywhere (the disc stands still)",
        |row: &FrictionlessRow| row.equilibrium.kind.name(),
    ));
    for ball in 0..study.model().balls() {
        columns.push(Column::number(
            &format!("beta_{}_rad", ball + 1),
            "rad",
            "angle of the ball from the imbalance, in [0, 2π), ascending among balls that are \
             alike; of a family one position",
            move |row: &FrictionlessRow| row.equilibrium.beta_rad.as_ref()?.get(ball).copied(),
        ));
    }
    columns.extend([
        number("x_m", "m", "position of the ring's centre towards the imbalance", |row| {
            Some(row.equilibrium.position_m[0])
        }),
        number("y_m", "m", "position of the ring's centre at right angles to that", |row| {
            Some(row.equilibrium.position_m[1])
        }),
        number("amplitude_m", "m", "amplitude of the table's vibration", |row| {
            Some(row.equilibrium.amplitude_m())
        }),
        Column::count(
            "family_dimension",
            "dimensions of the family of equilibria that it belongs to, 0 if isolated",
            |row: &FrictionlessRow| Some(row.equilibrium.family_dimension as u64),
        ),
        Column::word(
            "stability",
            "stable, unstable, marginal or unknown, by the linearised equations with viscous drag \
             on the balls; without what lies along a family",
            |row: &FrictionlessRow| row.equilibrium.stability.name(),
        ),
    ]);
    for index in 0..2 * (2 + study.model().balls()) {
        let value = move |row: &FrictionlessRow| {
            row.equilibrium.eigenvalues_1_s.get(index).map(|value| (value.re, value.im))
        };
        let number = index + 1;
        columns.push(Column::number(
            &format!("eigenvalue_{number}_real_per_s"),
            "1/s",
            "growth rate of a small disturbance, the largest first",
            move |row| value(row).map(|(real, _)| real),
        ));
        columns.push(Column::number(
            &format!("eigenvalue_{number}_imag_rad_s"),
            "rad/s",
            "its angular frequency in the turning frame",
            move |row| value(row).map(|(_, imaginary)| imaginary),
        ));
    }
    columns
}

fn number(
    name: &str,
    unit: &str,
    meaning: &str,
    value: fn(&FrictionlessRow) -> Option<f64>,
) -> Column<FrictionlessRow> {
    Column::number(name, unit, meaning, value)
}

impl FrictionlessRow {
    /// A key for speeds of their own, which are no points of the sweep.
    pub fn no_point() -> Arc<PointKey> {
        Arc::new(PointKey { point_id: 0, swept: Vec::<ParameterValue>::new() })
    }
}
