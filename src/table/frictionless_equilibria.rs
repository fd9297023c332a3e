//! `frictionless_equilibria.parquet`: the equilibria without dry friction and their stability.

use std::sync::Arc;

use super::column::Column;
use super::equilibrium_set::{PointKey, key_columns};
use crate::analysis::FrictionlessEquilibrium;
use crate::study::{ParameterValue, Study};

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

/// Returns the columns of `frictionless_equilibria.parquet`, with the swept parameters, or with the
/// speed alone for `own_speeds`.
pub fn frictionless_columns(study: &Study, own_speeds: bool) -> Vec<Column<FrictionlessRow>> {
    let mut columns = Vec::new();
    if !own_speeds {
        columns = key_columns(study, |row: &FrictionlessRow| &row.point);
    }
    let speed = "speed_rad_s";
    if own_speeds || study.swept().iter().all(|column| column.name != speed) {
        let meaning = "speed of the disc; a negative speed is clockwise";
        columns.push(number(speed, "rad/s", meaning, |row| Some(row.speed_rad_s)));
    }
    columns.push(Column::word(
        "kind",
        "kind: a1_plus and a1_minus (all balls together), a2 (two balls opposite each other), b1 \
         (balanced), other (balls on one line), everywhere (the disc is at rest)",
        |row: &FrictionlessRow| row.equilibrium.kind.name(),
    ));
    for ball in 0..study.model().balls() {
        columns.push(Column::number(
            &format!("beta_{}_rad", ball + 1),
            "rad",
            "angle of the ball from the imbalance, in [0, 2π), in ascending order for identical \
             balls; for a family, one position",
            move |row: &FrictionlessRow| row.equilibrium.beta_rad.as_ref()?.get(ball).copied(),
        ));
    }
    columns.extend([
        number("x_m", "m", "position of the ring's centre towards the imbalance", |row| {
            Some(row.equilibrium.position_m[0])
        }),
        number("y_m", "m", "position of the ring's centre perpendicular to x", |row| {
            Some(row.equilibrium.position_m[1])
        }),
        number("amplitude_m", "m", "amplitude of the table's vibration", |row| {
            Some(row.equilibrium.amplitude_m())
        }),
        Column::count(
            "family_dimension",
            "dimension of the family of equilibria that it belongs to; 0 if isolated",
            |row: &FrictionlessRow| Some(row.equilibrium.family_dimension as u64),
        ),
        Column::word(
            "stability",
            "stable, unstable, marginal or unknown, from the linearised equations with viscous \
             drag on the balls, excluding the directions along a family",
            |row: &FrictionlessRow| row.equilibrium.stability.name(),
        ),
    ]);
    for index in 0..2 * (2 + study.model().balls()) {
        let value = move |row: &FrictionlessRow| {
            row.equilibrium.eigenvalues_per_s.get(index).map(|value| (value.re, value.im))
        };
        let number = index + 1;
        columns.push(Column::number(
            &format!("eigenvalue_{number}_real_per_s"),
            "1/s",
            "growth rate of a small disturbance, in descending order",
            move |row| value(row).map(|(real, _)| real),
        ));
        columns.push(Column::number(
            &format!("eigenvalue_{number}_imag_rad_s"),
            "rad/s",
            "its angular frequency in the rotating frame",
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
    /// Returns the key of a speed that is not a point of the sweep.
    pub fn no_point() -> Arc<PointKey> {
        Arc::new(PointKey { point_id: 0, swept: Vec::<ParameterValue>::new() })
    }
}
