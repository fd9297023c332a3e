//! `equilibria.parquet`: the equilibria of the runs that came to rest.

use super::column::{Column, Columns};
use super::point_key::add_point_id;
use super::run_record::RunRecord;
use super::runs::{add_angles, add_drawn, add_nominal};
use crate::analysis::{balance_quality_grade, bin, overlaps, sorted_where_identical};
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
    balance_quality_grade_mm_s: Option<f64>,
    overlapping: Option<bool>,
}

impl EquilibriumRow {
    /// Creates the row of a run, or returns `None` if the run did not end in equilibrium.
    pub fn of(record: &RunRecord) -> Option<Self> {
        let RunRecord { planned, outcome, .. } = record;
        if outcome.label() != Label::Equilibrium {
            return None;
        }
        let position = outcome.position.as_ref()?;
        let machine = planned.case.as_ref().ok()?.model.ball_balancer();
        let grade = machine.map(|machine| balance_quality_grade(machine, position));
        let overlapping = machine.map(|machine| overlaps(machine, position));
        let position = match machine {
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
            friction_margin: outcome.evidence.friction_margin(),
            time_to_rest_s: outcome.time_to_rest_s(),
            evidence: outcome.evidence.name(),
            balance_quality_grade_mm_s: grade,
            overlapping,
        })
    }
}

/// Returns the columns of `equilibria.parquet`.
pub fn equilibrium_columns(study: &Study) -> Vec<Column<EquilibriumRow>> {
    let mut list = Columns::<EquilibriumRow>::new();
    list.count("run_id", |row| row.run_id).meaning("number of the run in the study, from 0");
    add_point_id(&mut list, |row| row.point_id);
    add_nominal(&mut list, study, |row: &EquilibriumRow| &row.swept);
    add_drawn(&mut list, study, |row: &EquilibriumRow| &row.uncertain);
    let meaning = "angle at which the ball rests, from the imbalance, in [0, 2π); in ascending \
                   order for identical balls";
    add_angles(&mut list, study, meaning, |row: &EquilibriumRow| Some(&row.position));
    list.number("amplitude_m", "m", |row| row.amplitude_m)
        .meaning("amplitude of the table's vibration");
    list.number("friction_margin", "1", |row| row.friction_margin).meaning(
        "smallest unused fraction of the friction limit; 0 on the boundary of the equilibrium set, \
         where balls creep",
    );
    list.number("time_to_rest_s", "s", |row| row.time_to_rest_s)
        .meaning("time at which the last ball, or the block, stopped for good");
    list.word("evidence", |row| row.evidence).meaning("evidence for the equilibrium");
    for ball in 0..study.model().balls() {
        list.count(format!("bin_{}", ball + 1), move |row| {
            row.position.get(ball).map(|&angle| bin(angle) as u64)
        })
        .meaning("interval of the ball's angle in equilibrium_histogram.parquet, from 0, 10° wide");
    }
    if study.model().kind().offers.vibration {
        list.number("balance_quality_grade_mm_s", "mm/s", |row| row.balance_quality_grade_mm_s)
            .meaning(
                "balance quality grade G that is left (ISO 21940-11): the residual unbalance over \
                 the whole vibrating mass, with imbalance and balls, times the speed",
            );
        list.boolean("overlapping", |row| row.overlapping).meaning(
            "whether two balls are nearer to each other than their diameters allow; the model has \
             no contact between balls",
        );
    }
    list.finish()
}
