//! Further tables of the runs of a study: `stages.parquet`, and `equilibria.parquet` of the runs that came to rest.

use super::column::{Column, Columns};
use super::run_record::RunRecord;
use super::runs::{add_angles, add_drawn, add_nominal};
use crate::analysis::{balance_quality_grade, bin, overlaps, sorted_where_identical};
use crate::classification::{Label, StageOutcome};
use crate::model::OutputName;
use crate::study::{ParameterValue, Study};

/// A stage of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct StageRow {
    run_id: u64,
    point_id: u64,
    /// The number of the stage, from 1.
    stage: u64,
    outcome: StageOutcome,
}

impl StageRow {
    /// Returns the rows of a run.
    pub fn of(record: &RunRecord) -> impl Iterator<Item = StageRow> + '_ {
        let (run_id, point_id) = (record.planned.run_id, record.planned.point_id);
        let stages = (1..).zip(&record.outcome.stages);
        stages.map(move |(stage, outcome)| StageRow {
            run_id,
            point_id,
            stage,
            outcome: outcome.clone(),
        })
    }

    /// Returns what the stage is, in a word.
    fn kind(&self) -> &'static str {
        let [begin, end] = self.outcome.speed_rad_s;
        if begin.to_bits() == end.to_bits() { "hold" } else { "ramp" }
    }
}

/// Returns the columns of `stages.parquet`.
pub fn stage_columns(study: &Study) -> Vec<Column<StageRow>> {
    let model = study.model();
    let mut list = Columns::<StageRow>::new();
    list.count("run_id", |row| row.run_id).meaning("number of the run in the study, from 0");
    list.point_id(|row| row.point_id);
    list.count("stage", |row| row.stage).meaning("number of the stage in the run, from 1");
    let turns = model.disc_motion().is_some();
    if turns {
        list.word("kind", StageRow::kind)
            .meaning("ramp, in which the speed of the disc changes, or hold, at constant speed");
    }
    if model.kind().offers.vibration {
        list.boolean("kicked", |row| row.outcome.is_kicked)
            .meaning("whether the table is kicked at the begin of the stage");
    }
    list.number("begin_s", "s", |row| row.outcome.time_s[0]).meaning("begin of the stage");
    list.number("end_s", "s", |row| row.outcome.time_s[1])
        .meaning("end of the stage, or of the run in it");
    if turns {
        list.number("begin_speed_rad_s", "rad/s", |row| row.outcome.speed_rad_s[0])
            .meaning("speed of the disc at the begin of the stage");
        list.number("end_speed_rad_s", "rad/s", |row| row.outcome.speed_rad_s[1])
            .meaning("speed of the disc at the end of the stage");
    }
    for ball in 0..model.balls() {
        list.number(format!("beta_{}_rad", ball + 1), "rad", move |row| {
            row.outcome.position.get(ball).copied()
        })
        .meaning("angle of the ball from the imbalance at the end of the stage, in [0, 2π)");
    }
    for ball in 0..model.balls() {
        list.number(format!("ball_speed_{}_rad_s", ball + 1), "rad/s", move |row| {
            row.outcome.ball_speed_rad_s.get(ball).copied()
        })
        .meaning("speed of the ball relative to the ring at the end of the stage");
    }
    for (place, OutputName { name, unit, meaning }) in model.output_names().into_iter().enumerate()
    {
        let of = if meaning.is_empty() { &name } else { &meaning };
        list.number(format!("end_{name}"), &unit, move |row| {
            row.outcome.outputs.get(place).copied()
        })
        .meaning(format!("{of}: at the end of the stage"));
    }
    list.boolean("at_rest", |row| row.outcome.is_at_rest).meaning(
        "whether friction holds all balls for good at the end of the stage; null while the speed changes, and without a certificate",
    );
    if model.kind().offers.vibration {
        add_vibration(&mut list);
    }
    list.finish()
}

/// Adds the columns of stages of a balancer.
fn add_vibration(list: &mut Columns<StageRow>) {
    list.number("displacement_m", "m", |row| row.outcome.amplitude_m)
        .meaning("distance of the table from its place at rest at the end of the stage");
    list.number("peak_amplitude_m", "m", |row| row.outcome.peak.amplitude_m)
        .meaning("largest displacement of the table in the stage");
    list.number("peak_time_s", "s", |row| row.outcome.peak.time_s)
        .meaning("time of that, since the start of the run");
    list.count("lifted_off", |row| u64::from(row.outcome.lifted_off)).meaning(
        "balls that the kick at the begin of the stage lifts off the ring, which the model does not follow",
    );
}

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
    list.point_id(|row| row.point_id);
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
