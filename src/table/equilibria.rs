//! `equilibria.parquet`: the preferred equilibria, where runs came to rest.

use super::column::Column;
use super::record::RunRecord;
use super::runs::{position_columns, swept_columns};
use crate::ending::Label;
use crate::model::Ball;
use crate::study::{ParameterValue, Study};

/// A run that ended in equilibrium, balls that are alike in ascending order of their angles.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibriumRow {
    run_id: u64,
    point_id: u64,
    swept: Vec<ParameterValue>,
    position: Vec<f64>,
    amplitude_m: Option<f64>,
    friction_margin: Option<f64>,
    time_to_rest_s: Option<f64>,
    evidence: &'static str,
}

impl EquilibriumRow {
    /// The row of a run; none for one that did not end in equilibrium.
    pub fn of(record: &RunRecord) -> Option<Self> {
        let RunRecord { planned, outcome } = record;
        if outcome.label() != Label::Equilibrium {
            return None;
        }
        let position = outcome.position.as_ref()?;
        let position = match planned.case.as_ref().ok()?.model.ball_balancer() {
            Some(machine) => sorted_where_alike(position, &machine.balls),
            None => position.clone(),
        };
        Some(EquilibriumRow {
            run_id: planned.run_id,
            point_id: planned.point_id,
            swept: planned.swept.clone(),
            position,
            amplitude_m: outcome.amplitude_m,
            friction_margin: outcome.friction_margin,
            time_to_rest_s: outcome.time_to_rest_s,
            evidence: outcome.evidence.name(),
        })
    }
}

/// Angles with those of balls that are alike in ascending order among the places of those balls.
fn sorted_where_alike(beta: &[f64], balls: &[Ball]) -> Vec<f64> {
    let mut sorted = beta.to_vec();
    for (first, kind) in balls.iter().enumerate() {
        if balls[..first].contains(kind) {
            continue;
        }
        let places: Vec<usize> = (first..balls.len()).filter(|&i| balls[i] == *kind).collect();
        let mut angles: Vec<f64> = places.iter().map(|&place| beta[place]).collect();
        angles.sort_by(f64::total_cmp);
        for (place, angle) in places.into_iter().zip(angles) {
            sorted[place] = angle;
        }
    }
    sorted
}

/// The columns of `equilibria.parquet`.
pub fn equilibrium_columns(study: &Study) -> Vec<Column<EquilibriumRow>> {
    let mut columns = vec![
        Column::count(
            "run_id",
            "number of the run in the study, from 0",
            |row: &EquilibriumRow| Some(row.run_id),
        ),
        Column::count("point_id", "number of the sweep's point, from 0", |row: &EquilibriumRow| {
            Some(row.point_id)
        }),
    ];
    columns.extend(swept_columns(study, |row: &EquilibriumRow| &row.swept));
    columns.extend(position_columns(
        study,
        "angle at which the ball rests, from the imbalance, in [0, 2π); ascending among balls that \
         are alike",
        |row: &EquilibriumRow| Some(&row.position),
    ));
    columns.extend([
        Column::number(
            "amplitude_m",
            "m",
            "amplitude of the table's vibration",
            |row: &EquilibriumRow| row.amplitude_m,
        ),
        Column::number(
            "friction_margin",
            "1",
            "least part of the friction limit that is left, 0 on the edge of the equilibrium set",
            |row: &EquilibriumRow| row.friction_margin,
        ),
        Column::number(
            "time_to_rest_s",
            "s",
            "when the last ball came to rest for good",
            |row: &EquilibriumRow| row.time_to_rest_s,
        ),
        Column::word("evidence", "why it is an equilibrium", |row: &EquilibriumRow| row.evidence),
    ]);
    columns
}

#[cfg(test)]
mod tests {
    use super::sorted_where_alike;
    use crate::model::Ball;

    #[test]
    fn only_balls_that_are_alike_change_places() {
        let light = Ball::default();
        let heavy = Ball { mass_kg: 1.0, ..light };
        assert_eq!(sorted_where_alike(&[3.0, 1.0], &[light, light]), [1.0, 3.0]);
        assert_eq!(sorted_where_alike(&[3.0, 1.0], &[light, heavy]), [3.0, 1.0]);
        let mixed = [light, heavy, light, heavy];
        assert_eq!(sorted_where_alike(&[3.0, 9.0, 1.0, 2.0], &mixed), [1.0, 2.0, 3.0, 9.0]);
    }
}
