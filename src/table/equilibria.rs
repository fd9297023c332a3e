//! `equilibria.parquet`: the equilibria of the runs that came to rest.

use super::column::Column;
use super::run_record::RunRecord;
use super::runs::{drawn_columns, nominal_columns, position_columns};
use crate::analysis::{bin, sorted_where_identical};
use crate::classification::Label;
use crate::study::{ParameterValue, Study};

/// A run that ended in equilibrium, with identical balls in ascending order of their angles.
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
}

impl EquilibriumRow {
    /// Creates the row of a run, or returns `None` if the run did not end in equilibrium.
    pub fn of(record: &RunRecord) -> Option<Self> {
        let RunRecord { planned, outcome, .. } = record;
        if outcome.label() != Label::Equilibrium {
            return None;
        }
        let position = outcome.position.as_ref()?;
        let position = match planned.case.as_ref().ok()?.model.ball_balancer() {
            Some(machine) => sorted_where_identical(position, &machine.balls),
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
        })
    }
}

/// Returns the columns of `equilibria.parquet`.
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
        "angle at which the ball rests, from the imbalance, in [0, 2π); in ascending order for \
         identical balls",
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
            "smallest unused fraction of the friction limit; 0 on the boundary of the equilibrium \
             set, where balls creep",
            |row: &EquilibriumRow| row.friction_margin,
        ),
        Column::number(
            "time_to_rest_s",
            "s",
            "time at which the last ball, or the block, stopped for good",
            |row: &EquilibriumRow| row.time_to_rest_s,
        ),
        Column::word("evidence", "evidence for the equilibrium", |row: &EquilibriumRow| {
            row.evidence
        }),
    ]);
    columns.extend((0..study.model().balls()).map(|ball| {
        Column::count(
            &format!("bin_{}", ball + 1),
            "bin of the ball's angle in equilibrium_histogram.parquet, from 0, 10° wide",
            move |row: &EquilibriumRow| row.position.get(ball).map(|&angle| bin(angle) as u64),
        )
    }));
    columns
}
