//! `equilibria.parquet`: the preferred equilibria, where runs came to rest.

use super::column::Column;
use super::record::RunRecord;
use super::runs::{drawn_columns, nominal_columns, position_columns};
use crate::analysis::{Nearest, bin, sorted_where_alike};
use crate::ending::Label;
use crate::study::{ParameterValue, Study};

/// A run that ended in equilibrium, balls that are alike in ascending order of their angles.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibriumRow {
    run_id: u64,
    point_id: u64,
    swept: Vec<ParameterValue>,
    uncertain: Vec<f64>,
    position: Vec<f64>,
    amplitude_m: Option<f64>,
    friction_margin: Option<f64>,
    time_to_rest_s: Option<f64>,
    evidence: &'static str,
    nearest: Option<Nearest>,
}

impl EquilibriumRow {
    /// The row of a run; none for one that did not end in equilibrium.
    pub fn of(record: &RunRecord) -> Option<Self> {
        let RunRecord { planned, outcome, nearest, .. } = record;
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
            uncertain: planned.uncertain.clone(),
            position,
            amplitude_m: outcome.amplitude_m,
            friction_margin: outcome.friction_margin,
            time_to_rest_s: outcome.time_to_rest_s,
            evidence: outcome.evidence.name(),
            nearest: *nearest,
        })
    }
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
    columns.extend(nominal_columns(study, |row: &EquilibriumRow| &row.swept));
    columns.extend(drawn_columns(study, |row: &EquilibriumRow| &row.uncertain));
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
            "least part of the friction limit that is left, 0 on the edge of the equilibrium set, where \
             balls creep",
            |row: &EquilibriumRow| row.friction_margin,
        ),
        Column::number(
            "time_to_rest_s",
            "s",
            "when the last ball, or the block, came to rest for good",
            |row: &EquilibriumRow| row.time_to_rest_s,
        ),
        Column::word("evidence", "why it is an equilibrium", |row: &EquilibriumRow| row.evidence),
    ]);
    columns.extend(preferred_columns(study.model().balls()));
    columns
}

/// How near the equilibria without friction are, and the bins of `density.parquet`.
fn preferred_columns(balls: usize) -> Vec<Column<EquilibriumRow>> {
    if balls == 0 {
        return Vec::new();
    }
    let mut columns = vec![
        Column::optional_word(
            "nearest_frictionless",
            "the nearest stable equilibrium without friction, with a drag of 1e4 on the balls: a1_plus, \
             a1_minus (all balls together), a2, other (on one line), b1 (balanced); null where none \
             is stable, where four balls and more balance, and for five and more that differ with \
             parameters drawn for each run",
            |row: &EquilibriumRow| row.nearest.map(|nearest| nearest.kind.name()),
        ),
        Column::number(
            "distance_to_frictionless_rad",
            "rad",
            "root mean square over the balls of the angles to it, least over exchanges of balls that \
             are alike; of three balls that are balanced, to all positions that balance",
            |row: &EquilibriumRow| row.nearest.map(|nearest| nearest.distance_rad),
        ),
    ];
    columns.extend((0..balls).map(|ball| {
        Column::count(
            &format!("bin_{}", ball + 1),
            "bin of the ball's angle in density.parquet, from 0, 10° wide",
            move |row: &EquilibriumRow| row.position.get(ball).map(|&angle| bin(angle) as u64),
        )
    }));
    columns
}
