//! `frictionless_equilibria.parquet`: the equilibria without dry friction and their stability.

use std::sync::Arc;

use super::column::{Column, Columns};
use super::point_key::{PointKey, add_point};
use crate::analysis::FrictionlessEquilibrium;
use crate::study::Study;

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
